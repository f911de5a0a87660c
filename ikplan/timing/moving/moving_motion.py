"""A motion along a path that begins or ends moving, at any duration that it can have."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ikplan.errors import TimingFailed
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, EngineFailed, unlimited
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.jerk import smooth_span
from ikplan.timing.moving.moving_jerk_span import EndRates, MovingJerkSpan, joined
from ikplan.timing.moving.moving_span import MovingSpan, moving_span, span_timing
from ikplan.timing.profile import LimitProfile, SegmentJointLimits
from ikplan.timing.span import SpanTiming, time_span
from ikplan.timing.time_joint_path import check_inside
from ikplan.timing.timed_path import TimedPath

__all__ = ["MovingMotion", "time_moving_path"]

_SAME = 1e-13


class _SpanMotion(Protocol):
    """A span that can be timed to last as long as asked for, within what it can."""

    duration: float
    fixed: bool

    def timed(self, duration: float) -> SpanTiming: ...
    def smooth(self, duration: float) -> CubicMotion: ...


class _Resting:
    """A span from rest to rest: slowed evenly."""

    fixed = False

    def __init__(self, span: SpanTiming, motion: CubicMotion | None) -> None:
        self._span, self._motion = span, motion
        self.duration = float(span.dt.sum() if motion is None else motion.time[-1])

    def timed(self, duration: float) -> SpanTiming:
        factor = 1.0 if self._motion is not None else duration / self.duration
        span = self._span
        return SpanTiming(
            span.problem, span.x / factor**2, span.dt * factor, span.loss, span.engine
        )

    def smooth(self, duration: float) -> CubicMotion:
        assert self._motion is not None
        return self._motion.slowed(duration / self.duration)


class _Moving:
    """A span that begins or ends moving."""

    def __init__(self, span: MovingSpan, motion: MovingJerkSpan | None) -> None:
        self._span, self._motion = span, motion
        self.duration = span.duration if motion is None else motion.duration
        self.fixed = motion is not None and motion.fixed

    def timed(self, duration: float) -> SpanTiming:
        if self._motion is not None:
            return span_timing(self._span, self._span.x)
        return span_timing(self._span, self._span.lasting(duration))

    def smooth(self, duration: float) -> CubicMotion:
        assert self._motion is not None
        return self._motion.lasting(duration)


class MovingMotion:
    """A motion along a path that begins or ends moving.

    Attributes:
        path: The path.
        duration: Its least duration [s].
    """

    def __init__(self, path: JointPath, spans: Sequence[_SpanMotion], jerk_limited: bool) -> None:
        """Keep the spans between rests, in order."""
        self.path, self._spans, self._jerk_limited = path, list(spans), jerk_limited
        self.duration = sum(span.duration for span in self._spans)

    def lasting(self, duration: float) -> TimedPath:
        """Return the motion that takes a given time; slower by the same factor in every span.

        Args:
            duration: The time [s].

        Raises:
            TimingFailed: It is less than the least duration, or the motion cannot be as slow.
        """
        fixed = sum(span.duration for span in self._spans if span.fixed)
        free = self.duration - fixed
        if duration < self.duration * (1.0 - _SAME) or (free <= 0.0 and duration > self.duration):
            raise TimingFailed(
                f"a motion along this path takes {self.duration:.9g} s, not {duration:.9g} s"
            )
        factor = max((duration - fixed) / free, 1.0) if free > 0.0 else 1.0
        wanted = [x.duration if x.fixed else factor * x.duration for x in self._spans]
        try:
            timed = self._timed(wanted)
        except EngineFailed as error:
            raise TimingFailed(
                f"the motion moves at its ends and cannot be slowed to {duration:.9g} s"
            ) from error
        node_times = timed.node_times * (duration / timed.duration)
        node_times[-1] = duration
        return TimedPath(
            timed.path,
            timed.s,
            timed.pieces,
            timed.sdot,
            node_times,
            timed.spans,
            timed.sddot,
        )

    def _timed(self, wanted: list[float]) -> TimedPath:
        pairs = list(zip(self._spans, wanted, strict=True))
        spans = tuple(span.timed(time) for span, time in pairs)
        if self._jerk_limited:
            time, s, v, a = joined([span.smooth(t) for span, t in pairs])
            return TimedPath(self.path, s, np.zeros(0, dtype=np.int64), v, time, spans, a)
        grids = [span.problem.grid for span in spans]
        x = np.concatenate([spans[0].x, *(span.x[1:] for span in spans[1:])])
        return TimedPath(
            path=self.path,
            s=np.concatenate([[0.0], *(grid.s[1:] for grid in grids)]),
            pieces=np.concatenate([grid.pieces for grid in grids]),
            sdot=np.sqrt(x),
            node_times=np.concatenate([[0.0], np.cumsum(np.concatenate([x.dt for x in spans]))]),
            spans=spans,
        )


def time_moving_path(
    path: JointPath,
    limits: JointLimits,
    rates: EndRates,
    *,
    segments: Sequence[SegmentJointLimits] = (),
    constraints: Sequence[PathConstraint] = (),
    check: Check = unlimited,
    rough: bool = False,
) -> MovingMotion:
    """Move along a path as fast as the limits allow, with given path speeds at its ends.

    Args:
        path: The path; under jerk limits with continuous curvature.
        limits: Joint limits of the whole path.
        rates: Path speeds at both ends.
        segments: Joint limits of ranges of the path; the strictest holds.
        constraints: Limits other than those of single joints.
        check: Is called now and then, and may end the timing by an error of its own.
        rough: Whether to leave out jerk limits and be content with a coarse grid.

    Returns:
        The motion.

    Raises:
        TimingFailed: The path leaves the position limits, or no path speed was found.
        EngineFailed: No motion has these path speeds at its ends.
    """
    check_inside(path, limits)
    ranges = [(r.start, r.end) for r in segments] + [(r.start, r.end) for r in constraints]
    path = path.with_knots([place for both in ranges for place in both])
    jerk = any(x.jerk is not None for x in (limits, *(x.limits for x in segments))) and not rough
    if path.length == 0.0:
        raise EngineFailed(0)
    profile = LimitProfile.merged(path, limits, segments)
    if jerk:
        limited = np.asarray(np.isfinite(profile.jerk).any(axis=1))
        jumps = path.curvature_jumps()
        path = path.stopping_at(jumps[limited[jumps - 1] | limited[jumps]])
    spans: list[_SpanMotion] = []
    last_knot = len(path.s_knots) - 1
    for first, last in itertools.pairwise(path.rest_knots):
        begin, end = path.s_knots[first], path.s_knots[last]
        mine = tuple(c for c in constraints if c.start < end and c.end > begin)
        start = rates.start if first == 0 else 0.0
        stop = rates.end if last == last_knot else 0.0
        if start == 0.0 and stop == 0.0:
            engine = CompiledEngine() if jerk or rough else None
            rest = time_span(path, first, last, profile, mine, engine, steady=not jerk, check=check)
            motion = smooth_span(rest.problem, check).motion if jerk else None
            spans.append(_Resting(rest, motion))
            continue
        ends = (start * start, stop * stop)
        moving = moving_span(path, first, last, profile, mine, ends, check, rough=rough or jerk)
        smooth = None
        if jerk:
            pull = rates.pull if first == 0 else 0.0
            own = EndRates(start, pull, stop)
            smooth = MovingJerkSpan(path, (first, last), limits, segments, mine, own, check)
        spans.append(_Moving(moving, smooth))
    return MovingMotion(path, spans, jerk)
