"""Places of a joint polyline that are nearest to configurations, as the timing looks for them."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.robots import Robot

__all__ = ["Polyline", "tool_apart"]


_HALVINGS = 40


class Polyline:
    """A polyline through joint waypoints.

    Args:
        rows: The waypoints, shape (n, dof), n >= 2 [rad or m].
        weight: What one unit of distance is for each joint, shape (dof,).
    """

    def __init__(self, rows: Array, weight: Array) -> None:
        self._rows, self._weight = rows, weight

    def nearest(self, q: Array, row: Indices) -> Array:
        """Return the nearest of the places on a leg and its neighbours, shape (m, dof).

        Distance is that of the joint farthest off, in units of its weight.

        Args:
            q: Configurations, shape (m, dof).
            row: The waypoint passed last before each, shape (m,).
        """
        best = np.full(len(q), np.inf)
        found = np.empty_like(q)
        for shift in (0, -1, 1):
            leg = np.clip(row + shift, 0, len(self._rows) - 2)
            place, distance = self._on_leg(q, leg)
            better = distance < best
            best[better], found[better] = distance[better], place[better]
        return found

    def _on_leg(self, q: Array, leg: Indices) -> tuple[Array, Array]:
        """Nearest places of legs and their distances: a convex function of the share, halved."""
        a = self._rows[leg]
        d = (self._rows[leg + 1] - a) / self._weight
        off = (q - a) / self._weight
        low, high = np.zeros(len(q)), np.ones(len(q))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            apart = off - middle[:, None] * d
            most = np.argmax(np.abs(apart), axis=1)[:, None]
            # Where the joint farthest off gets nearer ahead, the least is ahead.
            sign = np.take_along_axis(apart, most, 1) * np.take_along_axis(d, most, 1)
            ahead = sign[:, 0] > 0.0
            low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
        share = 0.5 * (low + high)[:, None]
        distance = np.abs(off - share * d).max(axis=1)
        return a + share * d * self._weight, distance


def tool_apart(robot: Robot, q: Array, other: Array) -> tuple[Array, Array]:
    """Return distances [m] and angles [rad] between the tool's poses, shape (m,) each."""
    R, p = robot.poses(q)
    R_other, p_other = robot.poses(other)
    chord = np.linalg.norm(R - R_other, axis=(1, 2)) / np.sqrt(8.0)
    return np.linalg.norm(p - p_other, axis=1), 2.0 * np.arcsin(np.minimum(chord, 1.0))
