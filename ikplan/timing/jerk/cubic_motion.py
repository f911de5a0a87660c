"""A motion along a path with constant path jerk between nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array

__all__ = ["CubicMotion"]


@dataclass(frozen=True, eq=False)
class CubicMotion:
    """A motion along a path with constant path jerk between nodes, from rest to rest.

    Attributes:
        time: Times of the nodes [s], shape (n + 1,), from 0.
        s: Path positions, shape (n + 1,).
        v: Path velocities, shape (n + 1,).
        a: Path accelerations, shape (n + 1,), zero at both ends.
    """

    time: Array
    s: Array
    v: Array
    a: Array

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Return path positions, velocities and accelerations at times, (m,) each."""
        i = np.clip(np.searchsorted(self.time, times, side="right") - 1, 0, len(self.time) - 2)
        dt = np.diff(self.time)[i]
        j = np.divide(np.diff(self.a)[i], dt, out=np.zeros(len(i)), where=dt > 0.0)
        r = times - self.time[i]
        a = self.a[i] + r * j
        v = np.maximum(self.v[i] + r * (self.a[i] + 0.5 * r * j), 0.0)
        s = self.s[i] + r * (self.v[i] + r * (0.5 * self.a[i] + r * j / 6.0))
        return s, v, a

    def divided(self, times: Array) -> CubicMotion:
        """Return the same motion with more nodes, at given times."""
        more = np.setdiff1d(times[(times > 0.0) & (times < self.time[-1])], self.time)
        s, v, a = self.at(more)
        at = np.searchsorted(self.time, more, side="right")
        return CubicMotion(
            np.insert(self.time, at, more),
            np.maximum.accumulate(np.insert(self.s, at, s)),
            np.insert(self.v, at, v),
            np.insert(self.a, at, a),
        )

    def slowed(self, k: float) -> CubicMotion:
        """Return the motion k times slower."""
        return CubicMotion(self.time * k, self.s, self.v / k, self.a / (k * k))
