"""A tool path as the tracker sees it: poses at path positions, and where points have to be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ikplan.arrays import Array, Flags, Indices, clamped, lengths_of, steps_of
from ikplan.path.rotation.so3 import angle_between
from ikplan.path.tool_path import SegmentRange

__all__ = [
    "ReferencePath",
    "initial_points",
    "nearest_points",
    "nearest_positions",
    "points_around",
    "positions_missing",
    "rest_points",
    "turn_between",
]


_MANY = 64
"""Between more required points than this two steps each are enough to begin with, else four:
densifying adds what the joint spline through many short parts needs, and that is little."""
_ROUNDING = 1e-12
"""Path positions this near to one another [m], or this share of the path, differ by rounding."""


class ReferencePath(Protocol):
    """A tool path in the base frame, as the tracker needs it."""

    @property
    def length(self) -> float:
        """Length [m; rotations count for about their lever]."""

    @property
    def corners(self) -> Array:
        """Path positions where the direction jumps and the motion stops, shape (c,)."""

    @property
    def waypoint_s(self) -> Array:
        """Path positions of the waypoints, shape (n,)."""

    @property
    def orientation_changes(self) -> Array:
        """Path positions where an orientation begins or ends to be asked for, shape (k,)."""

    @property
    def segments(self) -> Sequence[SegmentRange]:
        """What of the request each part comes from, in order."""

    @property
    def taken(self) -> float:
        """Share of the tolerance that the path takes itself; 0: it is the one asked for."""

    def poses(self, s: Array) -> tuple[Array, Array]:
        """Rotations, shape (m, 3, 3), and positions, shape (m, 3) [m], at path positions."""

    def positions(self, s: Array) -> Array:
        """Positions, shape (m, 3) [m], at path positions."""

    def orientation_mask(self, s: Array) -> Flags:
        """Where an orientation is asked for, shape (m,)."""


def initial_points(
    reference: ReferencePath, step: float, begin: float = 0.0, *, apart: float = 0.0
) -> Array:
    """Path positions with every corner and waypoint, an even number of steps between them.

    Where an orientation begins or ends to be asked for there is one as well: it is kept there, and
    the free part goes on from it.

    Args:
        reference: The path.
        step: About their spacing [m].
        begin: The first of them.
        apart: Of many, those nearer than this to the one before are left out [m].
    """
    slack, kept = _slack(reference), [begin]
    required = _required(reference)
    gap = max(slack, apart) if len(required) > _MANY else slack
    for s_required in required.tolist():
        if s_required > kept[-1] + gap and s_required < reference.length - slack:
            kept.append(s_required)
    if reference.length > 0.0:
        kept.append(reference.length)
    ends = np.array(kept)
    gaps = steps_of(ends)
    least = 2 if len(gaps) <= _MANY else 1
    steps = 2 * np.maximum(least, np.ceil(gaps / (2.0 * step)).astype(np.int64))
    # Even steps between each two; the points required are exact.
    part = np.repeat(np.arange(len(gaps)), steps)
    count = np.arange(len(part)) - np.repeat(np.cumsum(steps) - steps, steps) + 1
    points = count * (gaps / steps)[part] + ends[:-1][part]
    points[np.cumsum(steps) - 1] = ends[1:]
    return np.append(begin, points)


def positions_missing(reference: ReferencePath, s: Array) -> Array:
    """Return path positions that have no point yet where there has to be one, increasing.

    Args:
        reference: The path.
        s: Path positions of the points, shape (m,), increasing.
    """
    positions = _required(reference)
    off = np.abs(s[nearest_points(s, positions)] - positions)
    return np.asarray(positions[off > _slack(reference)])


def rest_points(reference: ReferencePath, s: Array) -> list[int]:
    """Indices of the points at the corners."""
    return [int(k) for k in nearest_points(s, reference.corners)]


def nearest_points(s: Array, positions: Array) -> Indices:
    """Indices of the points nearest to path positions; of two as near, the first.

    Args:
        s: Path positions of the points, shape (m,), increasing.
        positions: Path positions on the path, shape (n,).
    """
    after = np.minimum(np.searchsorted(s, positions), len(s) - 1)
    before = np.maximum(after - 1, 0)
    return np.where(positions - s[before] <= s[after] - positions, before, after)


def points_around(
    reference: ReferencePath, s: Array, begins: Array, ends: Array
) -> tuple[Indices, Indices]:
    """Return the last points not after begins, and the first not before ends, shape (n,) each.

    Args:
        reference: The path.
        s: Path positions of the points, from 0 to the path's length, shape (m,).
        begins: Path positions, shape (n,).
        ends: As many not before them.
    """
    slack = _slack(reference)
    first, last = nearest_points(s, begins), nearest_points(s, ends)
    return first - (s[first] > begins + slack), last + (s[last] < ends - slack)


def _required(reference: ReferencePath) -> Array:
    places = reference.corners, reference.waypoint_s, reference.orientation_changes
    return np.unique(np.concatenate(places))


def _slack(reference: ReferencePath) -> float:
    return _ROUNDING * max(reference.length, 1.0)


def nearest_positions(
    reference: ReferencePath, near: Array, p: Array, low: Array, high: Array
) -> Array:
    """Path positions nearest to tool positions, to second order: one step along the tangent.

    Args:
        reference: The path.
        near: Path positions to begin from, shape (m,).
        p: Tool positions, shape (m, 3) [m].
        low: Smallest path position of each, shape (m,).
        high: Largest path position of each, shape (m,).
    """
    h = np.minimum(1e-4 * reference.length, 0.05 * (high - low))
    ahead, behind = np.minimum(near + h, reference.length), np.maximum(near - h, 0.0)
    m, found = len(near), reference.positions(np.concatenate([ahead, behind, near]))
    p_ahead, p_behind, p_near = found[:m], found[m : 2 * m], found[2 * m :]
    tangent = (p_ahead - p_behind) / (ahead - behind)[:, None]
    speed = lengths_of(tangent)
    along = np.einsum("ij,ij->i", p - p_near, tangent)
    step = np.where(speed > 1e-6, along / np.maximum(speed**2, 1e-12), 0.0)
    return clamped(near + step, low, high)


def turn_between(reference: ReferencePath, a: float, b: float) -> float:
    """Return the angle between the orientations asked for at two path positions [rad]."""
    ends = np.array([a, b])
    R, _ = reference.poses(ends)
    return float(angle_between(R[:1], R[1:])[0]) if reference.orientation_mask(ends).all() else 0.0
