"""Timings whose waypoints are passed at given times."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.limits import SamplingOptions
from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.pipeline.asked.asked_motion import AskedMotion
from ikplan.pipeline.asked.asked_timing import timed_as_asked
from ikplan.pipeline.timing_stage import Timing, joint_limits, prepared
from ikplan.robots import Robot
from ikplan.timing import PathConstraint, TimedPath, time_joint_path
from ikplan.timing.engines.engine import Check
from ikplan.timing.moving.spline_in_time import (
    motion_in_time,
    slowdown_in_time,
    spline_in_time,
)
from ikplan.timing.time_joint_path import check_inside

__all__ = ["filled_times", "time_at"]

_ABOVE = 1.0 + 1e-9
_KEPT = 1.0 + 1e-10


def filled_times(times: Sequence[float | None], q: Array) -> Array:
    """Return times of all waypoints; those not given by how far the joints are on their way.

    Args:
        times: Times of the waypoints, None where any will do [s].
        q: The waypoints, shape (n, dof) [rad or m].

    Raises:
        InvalidRequest: There are not as many times as waypoints, the first is not 0, the last is
            not given, or they do not increase.
    """
    if len(times) != len(q) or len(q) < 2:
        raise InvalidRequest(
            f"times: {len(q)} waypoints have {len(times)} times",
            field="times",
            allowed=f"{max(len(q), 2)} numbers or null, one for each of two waypoints or more",
        )
    if times[0] not in (None, 0.0) or times[-1] is None:
        raise InvalidRequest(
            "times: the motion begins at 0 with the first waypoint, and the last has a time",
            field="times",
            allowed="times[0] 0 or null, the last a number",
        )
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1)))
    given = [0, *(k for k, t in enumerate(times) if t is not None and k > 0)]
    filled = np.zeros(len(q))
    for a, b in itertools.pairwise(given):
        begin, end = filled[a], times[b]
        assert end is not None
        share = way[a : b + 1] - way[a]
        if share[-1] > 0.0 and (np.diff(share) > 0.0).all():
            share = share / share[-1]
        else:
            share = np.linspace(0.0, 1.0, b - a + 1)
        filled[a : b + 1] = begin + (end - begin) * share
        filled[b] = end
    if not (np.diff(filled) > 0.0).all():
        k = int(np.argmin(np.diff(filled) > 0.0)) + 1
        raise InvalidRequest(
            f"times[{k}]: {filled[k]:g} s is not after {filled[k - 1]:g} s",
            field=f"times[{k}]",
            allowed="times that increase",
        )
    return filled


def time_at(
    q: Array,
    times: Sequence[float | None],
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    segments: Sequence[LimitedSegment],
    rest_at: Sequence[int],
    asked: AskedMotion,
    check: Check,
) -> Timing:
    """Pass waypoints at given times.

    First by a spline over time, without stops; where that exceeds a limit, from rest to rest
    between the waypoints with times of their own.

    Args:
        q: The waypoints, shape (n, dof) [rad or m].
        times: Their times, None where any will do [s].
        robot: The robot, with its tool.
        limits: What the motion has to keep.
        sampling: Samples wanted.
        segments: Segments between waypoints with limits of their own.
        rest_at: Waypoints where the motion rests.
        asked: What else is asked for.
        check: Is called now and then, and may end the stage by an error of its own.

    Raises:
        InvalidRequest: The times make no sense.
        TimingFailed: They are too short; carries the earliest feasible ones found.
    """
    wanted = filled_times(times, q)
    own = joint_limits(robot, limits)
    own.check_positions(q, "waypoints")
    offered: list[Array] = []
    path = spline_in_time(wanted, q, own, rest_at, asked.ends)
    if path is not None:
        found = _moved(path, robot, limits, segments)
        if found is not None:
            timed, constraints = found
            factor = slowdown_in_time(timed)
            if factor <= _KEPT:
                return _sampled(timed, constraints, robot, limits, sampling, asked, check)
            if asked.ends is None:
                offered.append(wanted * (factor * _ABOVE))
    if asked.ends is None:
        given = [k for k, t in enumerate(times) if t is not None]
        resting, constraints, nearest = _stopping(
            q, wanted, given, robot, limits, segments, rest_at, check
        )
        if resting is not None:
            return _sampled(resting, constraints, robot, limits, sampling, asked, check)
        offered.append(nearest)
    if not offered:
        raise TimingFailed(
            "with these velocities at its ends no motion was found that passes the waypoints at "
            "the times asked for"
        )
    best = min(offered, key=lambda row: float(row[-1]))
    raise TimingFailed(
        "the waypoints cannot be passed at the times asked for; the earliest found to be feasible "
        f"end at {best[-1]:.9g} s instead of {wanted[-1]:.9g} s",
        nearest={"times": best.tolist()},
    )


def _moved(
    path: JointPath, robot: Robot, limits: MotionLimits, segments: Sequence[LimitedSegment]
) -> tuple[TimedPath, Sequence[PathConstraint]] | None:
    """The motion in time; None: it leaves the position limits."""
    path, joint_segments, constraints = prepared(path, robot, limits, segments)
    own = joint_limits(robot, limits)
    try:
        check_inside(path, own)
    except TimingFailed:
        return None
    return motion_in_time(path, own, joint_segments, constraints), constraints


def _stopping(
    q: Array,
    wanted: Array,
    given: Sequence[int],
    robot: Robot,
    limits: MotionLimits,
    segments: Sequence[LimitedSegment],
    rest_at: Sequence[int],
    check: Check,
) -> tuple[TimedPath | None, Sequence[PathConstraint], Array]:
    """The motion that rests at every waypoint with a time, or None, and the earliest times."""
    own = joint_limits(robot, limits)
    rests = sorted({0, len(q) - 1, *given, *rest_at})
    path = JointPath.through(q, own, rest_at=rests)
    path, joint_segments, constraints = prepared(path, robot, limits, segments)
    free = time_joint_path(path, own, segments=joint_segments, constraints=constraints, check=check)
    marks = sorted({0, len(q) - 1, *given})
    arrives = free.times[marks]
    need, have = np.diff(arrives), np.diff(wanted[marks])
    steps = np.maximum(need * _ABOVE, have)
    earliest = np.interp(np.arange(len(q)), marks, np.append(0.0, np.cumsum(steps)))
    if (need > have * _KEPT).any():
        return None, constraints, earliest
    # A leg that leads nowhere is stood out at its begin.
    factor = np.divide(have, need, out=np.ones(len(need)), where=need > 0.0)
    timed = _scaled(free, arrives, factor)
    stands = [
        (float(timed.path.s_waypoints[marks[k]]), float(have[k]))
        for k in range(len(need))
        if need[k] <= 0.0
    ]
    return timed.standing(stands), constraints, earliest


def _scaled(timed: TimedPath, arrives: Array, factor: Array) -> TimedPath:
    """The motion with each part between rests slowed by a factor of its own."""
    dt = np.diff(timed.node_times)
    middle = timed.node_times[:-1] + 0.5 * dt
    part = np.clip(np.searchsorted(arrives, middle, "right") - 1, 0, len(factor) - 1)
    slower = factor[part]
    # At the nodes between parts the motion rests.
    at_nodes = np.append(slower, slower[-1])
    return replace(
        timed,
        sdot=timed.sdot / at_nodes,
        sddot=None if timed.sddot is None else timed.sddot / at_nodes**2,
        node_times=np.append(0.0, np.cumsum(dt * slower)),
    )


def _sampled(
    timed: TimedPath,
    constraints: Sequence[PathConstraint],
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    asked: AskedMotion,
    check: Check,
) -> Timing:
    whole = replace(asked, duration=timed.duration)
    return timed_as_asked(
        lambda _: timed, timed.duration, constraints, robot, limits, sampling, whole, check
    )
