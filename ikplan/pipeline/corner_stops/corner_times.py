"""What each waypoint takes of a timed motion, and the least that a stop there would take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.planning import JointRoute
from ikplan.robots import Robot
from ikplan.timing import TimedPath

__all__ = ["CornerTimes", "gaining_stops", "least_stops", "stops_may_gain"]

_LEAST_GAIN = 1e-3
"""A stop that gains less than this share of the time about its corner is not made."""
_WORTH = 0.01
"""A path that stops at some corners is planned where that gains this share of its duration."""


class CornerTimes(NamedTuple):
    """What the waypoints of a route take of its motion.

    Attributes:
        rows: Rows of the waypoints, in the order passed, shape (n,).
        spent: Times from the middle of the way before each to the middle of the way after [s].
        stopped: Whether the motion stops there.
    """

    rows: Indices
    spent: Array
    stopped: Flags

    @classmethod
    def of(cls, route: JointRoute, timed: TimedPath) -> CornerTimes:
        """Return the times of a route that is timed."""
        index = np.array([w.index for w in route.waypoints], dtype=np.int64)
        t = timed.times_anywhere(_borders(timed, index))
        rows = np.array([w.row for w in route.waypoints], dtype=np.int64)
        return cls(rows, np.diff(t), np.isin(index, route.rest))


def _borders(timed: TimedPath, index: Indices) -> Array:
    """Path positions of both ends and of the middles between waypoints, shape (n + 1,)."""
    s = timed.path.s_waypoints[index]
    return np.concatenate([[0.0], 0.5 * (s[1:] + s[:-1]), [timed.path.length]])


def least_stops(
    route: JointRoute,
    timed: TimedPath,
    robot: Robot,
    limits: MotionLimits,
    segments: Sequence[LimitedSegment] = (),
) -> Array:
    """Return what a stop at each waypoint takes at least, between the same middles, (n,) [s].

    From each middle the joints and the tool come to rest over the way that is left, and get on
    likewise, each under its own limits of speed and acceleration alone.

    Args:
        route: The route.
        timed: Its motion.
        robot: The robot, with its tool.
        limits: What the motion has to keep.
        segments: Segments of the route with limits of their own.
    """
    index = np.array([w.index for w in route.waypoints], dtype=np.int64)
    path, borders = timed.path, _borders(timed, index)
    q = path(np.append(borders, path.s_waypoints[index]))
    _, p = robot.poses(np.clip(q, robot.lower, robot.upper))
    n = len(index)
    speed, acceleration = _most(route, index, limits, segments)
    least = np.zeros(n)
    for k in (0, 1):  # from the middle before, to the middle after
        ends, ways = np.arange(k, n + k), np.arange(k, n + k)
        away = np.abs(q[n + 1 :] - q[ends])
        tool = np.linalg.norm(p[n + 1 :] - p[ends], axis=1)
        distance = np.column_stack([away, tool])
        least += _time_to_rest(distance, speed[ways], acceleration[ways]).max(axis=1)
    return least


def _most(
    route: JointRoute, index: Indices, limits: MotionLimits, segments: Sequence[LimitedSegment]
) -> tuple[Array, Array]:
    """Highest speeds and accelerations of joints and tool on each way, shapes (n + 1, dof + 1)."""
    before = np.append(0, index)
    after = np.append(index, len(route.q) - 1)
    speed = np.tile(_speeds(limits), (len(before), 1))
    acceleration = np.tile(_accelerations(limits), (len(before), 1))
    for segment in segments:
        inside = (before >= segment.first) & (after <= segment.last)
        speed[inside] = np.minimum(speed[inside], _speeds(segment.limits))
        acceleration[inside] = np.minimum(acceleration[inside], _accelerations(segment.limits))
    return speed, acceleration


def _speeds(limits: MotionLimits) -> Array:
    return np.append(np.maximum(limits.velocity, -limits.velocity_lower), limits.tool_speed[0])


def _accelerations(limits: MotionLimits) -> Array:
    tool = min(limits.tool_acceleration[0], limits.tool_tangential)
    return np.append(limits.largest_acceleration, tool)


def _time_to_rest(distance: Array, speed: Array, acceleration: Array) -> Array:
    """Least times in which what moves at most so fast comes to rest over a distance [s].

    It moves at its highest speed v until it slows down at its highest rate a:
    ``d / v + v / (2 a)``, and ``sqrt(2 d / a)`` where d is less than ``v^2 / (2 a)``.
    """
    way = np.where(distance > 0.0, distance, 1.0)
    v = np.minimum(speed, np.sqrt(2.0 * way * acceleration))
    slow = np.isfinite(acceleration)
    slowing = np.where(slow, 0.5 * v, 0.0) / np.where(slow, acceleration, 1.0)
    return np.asarray(np.where(distance > 0.0, way / v + slowing, 0.0))


def stops_may_gain(passed: Array, least: Array, duration: float) -> bool:
    """Return whether stops at corners may gain enough to be tried: at all of them, or at some.

    Args:
        passed: What each corner takes rounded, shape (m,) [s].
        least: What a stop there takes at least, shape (m,) [s].
        duration: What the motion takes [s].
    """
    gain = passed - least
    return bool(gain.sum() > 0.0 or gain[gain > 0.0].sum() >= _WORTH * duration)


def gaining_stops(rounded: CornerTimes, others: Sequence[CornerTimes]) -> frozenset[int]:
    """Return the rows at which another motion stops, and takes less time for it than a first one.

    There are none where all of them together gain too little.

    Args:
        rounded: Times of the motion whose corners are rounded.
        others: Times of motions that stop at more of them.
    """
    rows, passed, resting = rounded
    best = dict(zip(rows[~resting].tolist(), passed[~resting].tolist(), strict=True))
    known, stops = dict(best), set[int]()
    for other in others:
        at = other.stopped & np.isin(other.rows, list(known))
        for row, spent in zip(other.rows[at].tolist(), other.spent[at].tolist(), strict=True):
            if spent < (1.0 - _LEAST_GAIN) * known[row]:
                best[row] = min(best[row], spent)
                stops.add(row)
    gain = sum(known[row] - best[row] for row in sorted(stops))
    return frozenset(stops) if gain >= _WORTH * float(passed.sum()) else frozenset()
