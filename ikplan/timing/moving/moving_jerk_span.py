"""The timing of a span that begins or ends moving, under jerk limits."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import TimingFailed
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, EngineFailed
from ikplan.timing.jerk.cubic_kernels import times_of
from ikplan.timing.jerk.cubic_motion import CubicMotion
from ikplan.timing.jerk.jerk import smooth_span
from ikplan.timing.jerk.smoothing import JointSlowdown
from ikplan.timing.jerk.within_limits import constraint_factors
from ikplan.timing.moving.speed_changes import brake, reversed_motion, steady, sum_of
from ikplan.timing.profile import LimitProfile, SegmentJointLimits
from ikplan.timing.span import time_span

__all__ = ["EndRates", "MovingJerkSpan", "joined"]

_SHARES = ((0.5, 0.45), (0.3, 0.6), (0.7, 0.25), (0.97, 0.02))
"""Shares of the accelerations and jerks for the change of the speed at an end, and for the rest
of the motion while it lasts."""
_LOOKED_AT = 24
"""In so many steps of an interval limits are looked at."""
_KEPT = 1.0 + 1e-10
_SLOWER, _SLOWEST = (1.05, 1.6), 20.0
"""By how much the rest of the motion is slowed at once, at least and at most, and in all."""
_LEAST_WAY = 1e-6
"""A rest of the way shorter than this share of it is covered by braking alone."""


class EndRates(NamedTuple):
    """Path speeds at both ends of a span, and the path acceleration at the first.

    Attributes:
        start: Path speed at the start.
        pull: Path acceleration there.
        end: Path speed at the end; the acceleration there is zero.
    """

    start: float
    pull: float
    end: float


@dataclass(frozen=True, eq=False)
class _Parts:
    """The parts of a motion, which are added up.

    Attributes:
        first: Braking from the speed at the start.
        middle: From rest to rest; None: the rest of the way is too short.
        last: Setting out to the speed at the end.
        cruise: Speed that is kept all the way, below both ends'; then there is no middle.
        way: Length of the span.
    """

    first: CubicMotion
    middle: CubicMotion | None
    last: CubicMotion
    cruise: float
    way: float

    def slowed(self, factor: float) -> _Parts:
        return replace(self, middle=None if self.middle is None else self.middle.slowed(factor))

    @property
    def duration(self) -> float:
        before, after = float(self.first.time[-1]), float(self.last.time[-1])
        if self.middle is not None:
            return max(float(self.middle.time[-1]), before, after)
        if self.cruise > 0.0:
            return (self.way - float(self.first.s[-1] + self.last.s[-1])) / self.cruise
        return max(before, after)

    def motion(self, start: float, end: float) -> CubicMotion:
        """The sum, from one path position to another."""
        whole, after = self.duration, float(self.last.time[-1])
        parts = [(0.0, self.first), (whole - after, self.last)]
        if self.middle is not None:
            left, before = whole - float(self.middle.time[-1]), float(self.first.time[-1])
            parts.append((left * before / max(before + after, 1e-300), self.middle))
        elif self.cruise > 0.0:
            parts.append((0.0, steady(self.cruise, whole)))
        return sum_of([p for p in parts if len(p[1].time) > 1], start, end)


class MovingJerkSpan:
    """A span between two knots that begins or ends moving, under jerk limits.

    The motion is a sum: braking from the speed at the start, a motion from rest to rest over the
    rest of the way, and setting out to the speed at the end, each within its share of the limits.

    Attributes:
        motion: The motion, as fast as was found.
    """

    def __init__(
        self,
        path: JointPath,
        knots: tuple[int, int],
        limits: JointLimits,
        segments: Sequence[SegmentJointLimits],
        constraints: Sequence[PathConstraint],
        rates: EndRates,
        check: Check,
    ) -> None:
        """Find a fast motion.

        Args:
            path: The path.
            knots: First and last knot of the span.
            limits: Joint limits of the whole path.
            segments: Joint limits of ranges of it.
            constraints: Limits other than those of single joints.
            rates: Path speeds at the ends.
            check: Is called now and then, and may end the search by an error of its own.

        Raises:
            EngineFailed: None was found.
        """
        self._path, self._limits, self._segments = path, limits, tuple(segments)
        self._constraints, self._rates, self._check = tuple(constraints), rates, check
        self._start, self._end = (float(path.s_knots[k]) for k in knots)
        profile = LimitProfile.merged(path, limits, self._segments)
        self._slowdown = JointSlowdown(path, profile, path.third_derivatives)
        for shares in _SHARES:
            check()
            found = self._within_limits(self._parts(*shares))
            if found is not None:
                self._best, self.motion = found
                return
        raise EngineFailed(0)

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.motion.time[-1])

    @property
    def fixed(self) -> bool:
        """Whether no slower motion is known."""
        return self._best.middle is None and self._best.cruise == 0.0

    def lasting(self, duration: float) -> CubicMotion:
        """Return the motion, slower, so that it takes a given time.

        Args:
            duration: The time [s], no less than that of the motion.

        Raises:
            EngineFailed: None is as slow.
        """
        if duration <= self.duration or self.fixed:
            return self.motion
        if self._best.middle is not None:
            parts = self._best.slowed(duration / float(self._best.middle.time[-1]))
            return self._divided(parts.motion(self._start, self._end))
        low, high = 1e-9 * self._best.cruise, self._best.cruise
        while True:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            tried = self._cruising(middle)
            if tried is None or tried.duration >= duration:
                low = middle
            else:
                high = middle
        slower = self._cruising(high)
        motion = None if slower is None else self._divided(slower.motion(self._start, self._end))
        if motion is None or self._factor(motion) > _KEPT:
            raise EngineFailed(0)
        return motion

    def _parts(self, at_ends: float, between: float) -> _Parts | None:
        """The parts under shares of the limits; None: they do not fit in the span."""
        way = self._end - self._start
        rates = self._rates
        first = self._brake(self._start, rates.start, rates.pull, at_ends)
        last = self._brake(self._end, rates.end, 0.0, at_ends)
        if first is None or last is None:
            return None
        last = reversed_motion(last)
        before, after = float(first.s[-1]), float(last.s[-1])
        left = way - before - after
        if left < -_LEAST_WAY * way:
            lower = min(rates.start, rates.end)
            return self._cruising(lower, at_ends) if lower > 0.0 and rates.pull == 0.0 else None
        if left <= _LEAST_WAY * way:
            return _Parts(first, None, last, 0.0, way)
        reach = 1.2 * between / at_ends
        places = [
            self._start + before,
            min(self._start + (1.0 + reach) * before, self._end - after),
            max(self._end - (1.0 + reach) * after, self._start + before),
            self._end - after,
        ]
        middle = self._middle(places, between)
        if middle is None:
            return None
        return _Parts(first, middle, last, 0.0, way)

    def _cruising(self, speed: float, share: float = 0.9) -> _Parts | None:
        """The parts of a motion that changes to a speed, keeps it, and changes from it."""
        rates = self._rates
        first = self._brake(self._start, rates.start - speed, 0.0, share)
        last = self._brake(self._end, rates.end - speed, 0.0, share)
        if first is None or last is None:
            return None
        parts = _Parts(first, None, reversed_motion(last), speed, self._end - self._start)
        enough = parts.duration >= float(first.time[-1] + last.time[-1])
        return parts if enough else None

    def _brake(self, place: float, speed: float, pull: float, share: float) -> CubicMotion | None:
        profile, path = self._slowdown.profile, self._path
        inside = min(max(place, self._start), self._end)
        k = int(np.clip(np.searchsorted(path.s_knots, inside, "right") - 1, 0, None))
        k = min(k, len(path.s_knots) - 2)
        if place >= self._end:
            k = int(np.searchsorted(path.s_knots, place)) - 1
        slope = np.abs(path.derivatives(np.array([place]), np.array([k]))[1][0])
        slope = np.maximum(slope, 1e-12 * slope.max())
        least = np.minimum(profile.acceleration[k], -profile.acceleration_lower[k])
        jerk = float((profile.jerk[k] / slope).min())
        acceleration = float((least / slope).min())
        if not np.isfinite(jerk):
            jerk = 100.0 * acceleration**2 / max(speed, 1e-9)
        return brake(speed, pull, share * acceleration, share * jerk)

    def _middle(self, places: list[float], share: float) -> CubicMotion | None:
        """The motion between the outer places, with a share of limits outside the inner ones."""
        path = self._path.with_knots(places)
        profile = LimitProfile.merged(path, self._limits, self._segments)
        rates = {name: getattr(profile, name).copy() for name in _SHARED}
        centre = 0.5 * (path.s_knots[:-1] + path.s_knots[1:])
        for begin, end in (places[:2], places[2:]):
            inside = (centre > begin) & (centre < end)
            for values in rates.values():
                values[inside] *= share
        profile = replace(profile, **rates)
        first, last = (int(np.abs(path.s_knots - p).argmin()) for p in (places[0], places[3]))
        if first >= last:
            return None
        try:
            span = time_span(
                path,
                first,
                last,
                profile,
                self._constraints,
                CompiledEngine(),
                steady=False,
                check=self._check,
            )
            motion = smooth_span(span.problem, self._check).motion
        except (EngineFailed, TimingFailed):
            return None
        return CubicMotion(motion.time, motion.s - motion.s[0], motion.v, motion.a)

    def _within_limits(self, parts: _Parts | None) -> tuple[_Parts, CubicMotion] | None:
        """Slow the middle until the sum keeps every limit; None: it does not."""
        if parts is None:
            return None
        slowest = _SLOWEST * parts.duration
        while parts.duration <= slowest:
            motion = self._divided(parts.motion(self._start, self._end))
            factor = self._factor(motion)
            if factor <= _KEPT:
                return parts, motion
            if parts.middle is None:
                return None
            step = min(max(factor, _SLOWER[0]), _SLOWER[1])
            parts = parts.slowed(step**1.5)
        return None

    def _factor(self, motion: CubicMotion) -> float:
        """By what factor of time the motion would keep its limits."""
        whole = motion.s[[0, -1]]
        factor = float(self._slowdown(motion, _LOOKED_AT, whole).max())
        if self._constraints:
            others = constraint_factors(self._path, motion, self._constraints)
            factor = max(factor, float(others.max()))
        return factor

    def _divided(self, motion: CubicMotion) -> CubicMotion:
        """The motion with nodes at the knots of the path."""
        knots = self._path.s_knots
        inner = knots[(knots > motion.s[0]) & (knots < motion.s[-1])]
        return motion.divided(times_of(motion.time, motion.s, motion.v, motion.a, inner))


_SHARED = ("acceleration", "acceleration_lower", "jerk")


def joined(motions: Sequence[CubicMotion]) -> tuple[Array, Array, Array, Array]:
    """Return times, path positions, speeds and accelerations of motions one after the other.

    Args:
        motions: The motions, in order, each from the path position where the one before ends.
    """
    ends = list(itertools.accumulate(float(m.time[-1]) for m in motions))
    time = [motions[0].time] + [
        m.time[1:] + begin for m, begin in zip(motions[1:], ends[:-1], strict=True)
    ]
    rest = [
        np.concatenate([getattr(motions[0], n), *(getattr(m, n)[1:] for m in motions[1:])])
        for n in ("s", "v", "a")
    ]
    return np.concatenate(time), rest[0], rest[1], rest[2]
