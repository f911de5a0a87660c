"""The path position at any time, and the times of path positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest

__all__ = ["PathTime"]

Array = NDArray[np.float64]

_ROUNDING = 1e-12
"""How far a motion may leave the ends of its path, as a share of its length."""
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class PathTime:
    """The path position as cubics of time between nodes.

    Attributes:
        time: Times of the nodes, shape (n + 1,) [s].
        s: Path positions there, shape (n + 1,).
        speed: Path velocities there, shape (n + 1,) [1/s].
        acceleration: Path accelerations, shape (n + 1,) [1/s^2]; None: constant between nodes.
    """

    time: Array
    s: Array
    speed: Array
    acceleration: Array | None

    def check_within(self, low: float, high: float) -> None:
        """Refuse a motion that leaves its path.

        Args:
            low: Path position at which the path begins.
            high: Path position at which it ends.

        Raises:
            InvalidRequest: It does.
        """
        first, last = self.range(float(self.time[0]), float(self.time[-1]))
        slack = _ROUNDING * (high - low)
        if not (first >= low - slack and last <= high + slack):
            raise InvalidRequest(
                f"motion.node_s: the motion goes from {first:.9g} to {last:.9g}, and leaves its "
                f"path from {low:.9g} to {high:.9g}",
                field="motion.node_s",
                allowed=[low, high],
            )

    def range(self, begin: float, end: float) -> tuple[float, float]:
        """Return path positions between which the motion is from one time to another [s]."""
        begin, end = (float(np.clip(t, self.time[0], self.time[-1])) for t in (begin, end))
        last = len(self.time) - 2
        first = int(np.clip(np.searchsorted(self.time, begin, side="right") - 1, 0, last))
        final = int(np.clip(np.searchsorted(self.time, end, side="left") - 1, first, last))
        controls = self._controls(np.arange(first, final + 1), begin, end)
        return float(controls.min()), float(controls.max())

    def when(self, s: float) -> float:
        """Return the first time at which a path position is reached, to rounding [s]."""
        reached = np.flatnonzero(self.s >= s)
        if len(reached) == 0:
            return float(self.time[-1])
        k = int(reached[0])
        if k == 0:
            return float(self.time[0])
        s0, v = float(self.s[k - 1]), float(self.speed[k - 1])
        a, jerk = (float(x[0]) for x in self._slopes(np.array([k - 1])))
        low, high = 0.0, float(self.time[k] - self.time[k - 1])
        for _ in range(_HALVINGS):
            t = 0.5 * (low + high)
            if s0 + t * (v + t * (a / 2.0 + t * jerk / 6.0)) < s:
                low = t
            else:
                high = t
        return float(self.time[k - 1]) + high

    def _slopes(self, node: NDArray[np.int64]) -> tuple[Array, Array]:
        """Path accelerations after nodes and their slopes, shape (m,) each."""
        whole = self.time[node + 1] - self.time[node]
        if self.acceleration is None:
            return (self.speed[node + 1] - self.speed[node]) / whole, np.zeros(len(node))
        a = self.acceleration[node]
        return a, (self.acceleration[node + 1] - a) / whole

    def _controls(self, node: NDArray[np.int64], begin: float, end: float) -> Array:
        """Bezier control values of the cubics after nodes, cut to a window, shape (m, 4)."""
        v = self.speed[node]
        a, jerk = self._slopes(node)
        t0 = np.clip(begin, self.time[node], self.time[node + 1]) - self.time[node]
        t1 = np.clip(end, self.time[node], self.time[node + 1]) - self.time[node]
        s0 = self.s[node] + t0 * (v + t0 * (a / 2.0 + t0 * jerk / 6.0))
        s1 = self.s[node] + t1 * (v + t1 * (a / 2.0 + t1 * jerk / 6.0))
        third = (t1 - t0) / 3.0
        return np.stack(
            [
                s0,
                s0 + third * (v + t0 * (a + t0 * jerk / 2.0)),
                s1 - third * (v + t1 * (a + t1 * jerk / 2.0)),
                s1,
            ],
            axis=1,
        )
