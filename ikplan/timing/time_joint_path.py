"""Timing of a joint path under joint limits."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, Engine, EngineFailed, unlimited
from ikplan.timing.limit_jerk import limit_jerk
from ikplan.timing.profile import LimitProfile, SegmentJointLimits
from ikplan.timing.span import SpanTiming, time_span, time_through
from ikplan.timing.timed_path import TimedPath
from ikplan.timing.together.separated import separated
from ikplan.timing.together.time_together import time_together

__all__ = ["MANY_RESTS", "check_inside", "passing_jumps", "time_before_jerk", "time_joint_path"]


MANY_RESTS = 24
"""With more rests than this the spans between them are timed together."""
_TOGETHER = 128
"""Most spans that are timed together: so many that the memory does not grow with the path."""
_SHARE_SMOOTHED = 0.02
"""What the grid may cost spans that are smoothed afterwards, as a share of what the first does."""


def time_joint_path(
    path: JointPath,
    limits: JointLimits,
    *,
    segments: Sequence[SegmentJointLimits] = (),
    constraints: Sequence[PathConstraint] = (),
    engine: Engine | None = None,
    check: Check = unlimited,
) -> TimedPath:
    """Move along a path as fast as the limits allow, at rest at both ends and at rest points.

    The geometry is not changed. Each span between rest points is timed by TOPP-RA (Pham and Pham,
    IEEE T-RO 2018) on a grid that is refined until its estimated cost is small. Joint limits are
    collocated so that they bound the whole of every interval; other limits are looked at in
    points of every interval and allowed for between them. The exact maxima are then computed,
    and the span is slowed by any ratio above 1, so that no limit is exceeded at any time.

    Args:
        path: The path.
        limits: Joint limits of the whole path.
        segments: Joint limits of ranges of the path; the strictest holds.
        constraints: Limits other than those of single joints: of the tool, of torques.
        engine: Chooses the path speed; None: toppra, with the compiled one to stand in, and for
            many short spans the compiled one in one call.
        check: Is called now and then, and may end the timing by an error of its own.

    Returns:
        The timed path; duration 0 for a path of length zero.

    Raises:
        InvalidRequest: The limits are for another number of joints.
        TimingFailed: A torque limit forbids to stand somewhere on the path, the path leaves the
            position limits, or no path speed was found; carries the place on the path, the joint
            and the limit.
    """
    timed = time_before_jerk(
        path, limits, segments=segments, constraints=constraints, engine=engine, check=check
    )
    return limit_jerk(timed, check) if _jerk_limited(limits, segments) else timed


def time_before_jerk(
    path: JointPath,
    limits: JointLimits,
    *,
    segments: Sequence[SegmentJointLimits] = (),
    constraints: Sequence[PathConstraint] = (),
    engine: Engine | None = None,
    check: Check = unlimited,
) -> TimedPath:
    """Return the motion that a jerk-limited one is found from; without jerk limits, the motion.

    It keeps all limits but those of the jerk, and rests where a jerk-limited one has to.
    Arguments and errors are those of :func:`time_joint_path`.
    """
    if path.dof != limits.dof:
        raise InvalidRequest(
            f"limits are for {limits.dof} joints, the path has {path.dof}",
            field="limits",
            allowed=f"{path.dof} values each",
        )
    check_inside(path, limits)
    ranges = [(r.start, r.end) for r in segments] + [(r.start, r.end) for r in constraints]
    path = path.with_knots([place for both in ranges for place in both])
    jerk_limited = _jerk_limited(limits, segments)
    if path.length == 0.0:
        zero = np.zeros(1)
        return TimedPath(path, zero, np.zeros(0, dtype=np.int64), zero, zero, ())
    profile = LimitProfile.merged(path, limits, segments)
    if jerk_limited:
        # A step of the curvature is a step of the acceleration, unless the motion stops there.
        limited = np.asarray(np.isfinite(profile.jerk).any(axis=1))
        jumps = path.curvature_jumps()
        path = path.stopping_at(jumps[limited[jumps - 1] | limited[jumps]])
    together = engine is None
    if jerk_limited:
        # The path speed is where the search begins; it is smoothed anyway.
        engine = engine or CompiledEngine()
    spans: list[SpanTiming] = []
    for knots in _timed_together(path.rest_knots, together=together):
        around = _within(constraints, *path.s_knots[[knots[0], knots[-1]]])
        if len(knots) > 2:
            try:
                spans += _timed_as_one(path, knots, profile, around, jerk_limited, check)
                continue
            except EngineFailed:
                pass  # one after the other, toppra and finer grids tell where and why
        for first, last in itertools.pairwise(knots):
            mine = _within(around, *path.s_knots[[first, last]])
            steady = not jerk_limited
            spans.append(
                time_span(path, first, last, profile, mine, engine, steady=steady, check=check)
            )
    return _timed(path, spans)


def passing_jumps(timed: TimedPath, rests: Array) -> TimedPath:
    """Return the motion that does not rest where only a jerk-limited one has to.

    Args:
        timed: What :func:`time_before_jerk` returns.
        rests: Path positions of the rest points of the path, both ends included.

    Raises:
        EngineFailed: No path speed was found.
    """
    knots = np.array(timed.path.rest_knots)
    ends = np.flatnonzero(np.isin(timed.path.s_knots[knots], rests))
    if len(ends) == len(knots):
        return timed
    groups = itertools.pairwise(ends.tolist())
    return _timed(timed.path, [time_through(timed.spans[a:b]) for a, b in groups])


def _timed(path: JointPath, spans: Sequence[SpanTiming]) -> TimedPath:
    """Join motions of spans end to end."""
    grids = [span.problem.grid for span in spans]
    dt = np.concatenate([span.dt for span in spans])
    return TimedPath(
        path=path,
        s=np.concatenate([[0.0], *(grid.s[1:] for grid in grids)]),
        pieces=np.concatenate([grid.pieces for grid in grids]),
        sdot=np.sqrt(np.concatenate([[0.0], *(span.x[1:] for span in spans)])),
        node_times=np.concatenate([[0.0], np.cumsum(dt)]),
        spans=tuple(spans),
    )


def _timed_as_one(
    path: JointPath,
    knots: Sequence[int],
    profile: LimitProfile,
    constraints: Sequence[PathConstraint],
    jerk_limited: bool,
    check: Check,
) -> list[SpanTiming]:
    """Time the spans between rests together; those that are to be smoothed come one by one."""
    if not jerk_limited:
        return [time_together(path, knots, profile, constraints, check=check)]
    timing = time_together(
        path, knots, profile, constraints, steady=False, check=check, share=_SHARE_SMOOTHED
    )
    return separated(timing)


def _jerk_limited(limits: JointLimits, segments: Sequence[SegmentJointLimits]) -> bool:
    return any(each.jerk is not None for each in (limits, *(x.limits for x in segments)))


def _timed_together(rests: Sequence[int], *, together: bool) -> list[Sequence[int]]:
    """Group the spans between rests: many of them a few together, else each for itself."""
    size = _TOGETHER if together and len(rests) > MANY_RESTS else 1
    return [rests[k : k + size + 1] for k in range(0, len(rests) - 1, size)]


def _within(
    constraints: Sequence[PathConstraint], start: float, end: float
) -> tuple[PathConstraint, ...]:
    """Return the constraints that hold anywhere between two places."""
    return tuple(c for c in constraints if c.start < end and c.end > start)


def check_inside(path: JointPath, limits: JointLimits) -> None:
    """Refuse a path that leaves the position limits between its waypoints.

    Args:
        path: The path.
        limits: Joint limits.

    Raises:
        TimingFailed: Names the joint.
    """
    low, high = path.extrema()
    # The extrema of a cubic carry rounding errors of their own.
    slack = 1e-12 * np.maximum(1.0, np.maximum(np.abs(low), np.abs(high)))
    bad = (low < limits.lower - slack) | (high > limits.upper + slack)
    if bad.any():
        j = int(np.argmax(bad))
        raise TimingFailed(
            f"joint {limits.joint_names[j]!r} leaves its position limits "
            f"[{limits.lower[j]:.9g}, {limits.upper[j]:.9g}]: the path reaches from {low[j]:.9g} "
            f"to {high[j]:.9g}",
            joint=limits.joint_names[j],
            limit="position",
        )
