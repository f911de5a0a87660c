"""A tool path as the follower sees it: poses at path positions, and where stations have to be."""

from __future__ import annotations

import itertools
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ikplan.path.rotation.so3 import angle_between

__all__ = [
    "ReferencePath",
    "first_stations",
    "nearest_places",
    "nearest_stations",
    "rest_stations",
    "stations_around",
    "turn_between",
]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_ROUNDING = 1e-12
"""Path positions this near to one another [m], or this share of the path, differ by rounding."""


class ReferencePath(Protocol):
    """A tool path in the base frame, as the follower needs it."""

    @property
    def length(self) -> float:
        """Length [m; rotations count for about their lever]."""

    @property
    def corners(self) -> Array:
        """Path positions where the direction jumps and the motion stops, shape (c,)."""

    @property
    def waypoint_s(self) -> Array:
        """Path positions of the waypoints asked for, shape (n,)."""

    def poses(self, s: Array) -> tuple[Array, Array]:
        """Rotations, shape (m, 3, 3), and positions, shape (m, 3) [m], at path positions."""

    def orientation_mask(self, s: Array) -> NDArray[np.bool_]:
        """Where an orientation is asked for, shape (m,)."""


def first_stations(guide: ReferencePath, step: float) -> Array:
    """Stations that include every corner and waypoint, an even number of steps between them.

    Args:
        guide: The path.
        step: About their spacing [m].
    """
    marks = np.unique(np.concatenate([guide.corners, guide.waypoint_s]))
    slack, kept = _slack(guide), [0.0]
    for mark in marks.tolist():
        if mark > kept[-1] + slack and mark < guide.length - slack:
            kept.append(mark)
    if guide.length > 0.0:
        kept.append(guide.length)
    parts = [np.zeros(1)]
    for a, b in itertools.pairwise(kept):
        steps = 2 * max(2, int(np.ceil((b - a) / (2.0 * step))))
        parts.append(np.linspace(a, b, steps + 1)[1:])
    return np.concatenate(parts)


def rest_stations(guide: ReferencePath, s: Array) -> list[int]:
    """Indices of the stations at the corners."""
    return [int(k) for k in nearest_stations(s, guide.corners)]


def nearest_stations(s: Array, places: Array) -> Index:
    """Indices of the stations nearest to path positions; of two as near, the first.

    Args:
        s: Path positions of the stations, shape (m,), increasing.
        places: Path positions on the path, shape (n,).
    """
    after = np.minimum(np.searchsorted(s, places), len(s) - 1)
    before = np.maximum(after - 1, 0)
    return np.where(places - s[before] <= s[after] - places, before, after)


def stations_around(guide: ReferencePath, s: Array, begin: float, end: float) -> tuple[int, int]:
    """Return the last station not after a begin, and the first not before an end.

    Args:
        guide: The path.
        s: Path positions of the stations, from 0 to the path's length, shape (m,).
        begin: A path position.
        end: One not before it.
    """
    slack = _slack(guide)
    first, last = (int(k) for k in nearest_stations(s, np.array([begin, end])))
    return first - int(s[first] > begin + slack), last + int(s[last] < end - slack)


def _slack(guide: ReferencePath) -> float:
    return _ROUNDING * max(guide.length, 1.0)


def nearest_places(guide: ReferencePath, near: Array, p: Array, low: Array, high: Array) -> Array:
    """Places on the path nearest to tool positions, to second order: one step along the tangent.

    Args:
        guide: The path.
        near: Path positions to begin from, shape (m,).
        p: Tool positions, shape (m, 3) [m].
        low: Smallest path position of each, shape (m,).
        high: Largest path position of each, shape (m,).
    """
    h = np.minimum(1e-4 * guide.length, 0.05 * (high - low))
    ahead, behind = np.minimum(near + h, guide.length), np.maximum(near - h, 0.0)
    tangent = (guide.poses(ahead)[1] - guide.poses(behind)[1]) / (ahead - behind)[:, None]
    speed = np.linalg.norm(tangent, axis=1)
    along = np.einsum("ij,ij->i", p - guide.poses(near)[1], tangent)
    step = np.where(speed > 1e-6, along / np.maximum(speed**2, 1e-12), 0.0)
    return np.clip(near + step, low, high)


def turn_between(guide: ReferencePath, a: float, b: float) -> float:
    """Return the angle between the orientations asked for at two path positions [rad]."""
    ends = np.array([a, b])
    R, _ = guide.poses(ends)
    return float(angle_between(R[:1], R[1:])[0]) if guide.orientation_mask(ends).all() else 0.0
