"""A motion along a path with constant path jerk between nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array

__all__ = ["CubicMotion"]

# Nodes nearer than this share of the duration have a jerk between them that is made of rounding.
_APART = 1e-9


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
        """Return the same motion with more nodes, at given times; none all but at another."""
        more = np.unique(times)
        after = np.clip(np.searchsorted(self.time, more), 1, len(self.time) - 1)
        room = np.minimum(more - self.time[after - 1], self.time[after] - more)
        more = more[room > _APART * self.time[-1]]
        s, v, a = self.at(more)
        new = np.searchsorted(self.time, more, side="right") + np.arange(len(more))
        old = np.ones(len(self.time) + len(more), dtype=np.bool_)
        old[new] = False
        merged = np.empty((4, len(old)))
        merged[:, old] = self.time, self.s, self.v, self.a
        merged[:, new] = more, s, v, a
        merged[1] = np.maximum.accumulate(merged[1])
        return CubicMotion(*merged)

    def slowed(self, k: float) -> CubicMotion:
        """Return the motion k times slower."""
        return CubicMotion(self.time * k, self.s, self.v / k, self.a / (k * k))
