"""The timing of a span that begins or ends moving, without jerk limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, Engine, EngineFailed
from ikplan.timing.engines.rows import StageRows, natural_units
from ikplan.timing.engines.toppra_engine import ToppraEngine
from ikplan.timing.grid import curvature_grid, regridded
from ikplan.timing.moving.speed_bounds import lowest_speeds
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile
from ikplan.timing.span import SpanTiming

__all__ = ["MovingSpan", "moving_span", "span_timing"]

_COARSE, _DOUBLINGS, _GAIN = 150, 4, 2e-3
"""Intervals to begin with, how often they are halved, and what a halving has to gain."""
_MET = 1e-9
"""How far, as a share, the squared speed at an end may be from the one asked for, by rounding."""
_BESIDE = 2e-6
"""What a limit may be exceeded by within the interval at a moving end."""
_ROUNDING = 1e-10
_TIGHTENINGS = 8
_MOST_TOPPRA = 4_000
_GENTLER = 1.0 + 1e-4
"""Braking to a cap leaves this much of the limits."""
_SLOWEST = 1e-6
"""Least cap of the squared speed, as a share of its greatest value."""
_HALVINGS = 200


class MovingSpan:
    """A span between two knots whose path speed at both ends is given.

    Attributes:
        problem: Path derivatives and limits on the grid.
        x: Squared path velocities at the nodes, as fast as the limits allow, shape (n + 1,).
        engine: What chose them.
    """

    def __init__(
        self, problem: SpanProblem, ends: tuple[float, float], check: Check, engine: Engine
    ) -> None:
        """Find the fastest motion.

        Args:
            problem: The span and its limits.
            ends: Squared path velocity at the first and at the last node.
            check: Is called now and then, and may end the search by an error of its own.
            engine: What chooses the path speed.

        Raises:
            EngineFailed: No path speed is as fast as asked for at both ends.
        """
        self.problem, self._ends, self.engine = problem, ends, engine
        self._tight = np.ones(len(problem.h))
        for _ in range(_TIGHTENINGS):
            check()
            self.x = self._solved(np.full(len(problem.h) + 1, np.inf), engine)
            ratio = problem.interval_ratios(self.x)
            # The speed at an end is given; what is exceeded beside it, samples will tell.
            for end, fixed in zip((0, -1), ends, strict=True):
                if fixed > 0.0 and ratio[end] <= 1.0 + _BESIDE:
                    ratio[end] = min(ratio[end], 1.0)
            if ratio.max() <= 1.0 + _ROUNDING:
                return
            self._tight *= np.maximum(ratio, 1.0) * (1.0 + _ROUNDING)
        raise EngineFailed(int(np.argmax(ratio)))

    @property
    def duration(self) -> float:
        """Duration of the fastest motion [s]."""
        return float(self.problem.times(self.x).sum())

    def lasting(self, duration: float) -> Array:
        """Return the squared path velocities of a motion that takes a given time.

        The path speed is capped, by a cap that is the same all over the span; near an end that
        moves faster than the cap the motion brakes, or sets out, as hard as it can.

        Args:
            duration: The time [s], no less than that of the fastest motion.

        Returns:
            Shape (n + 1,).

        Raises:
            EngineFailed: No motion is as slow.
        """
        if duration <= self.duration:
            return self.x
        rows = self._rows()
        a, b = rows.a * _GENTLER, rows.b * _GENTLER
        low = lowest_speeds(rows.s, a, b, *self._ends)
        highest = float(self.x.max())

        def capped(level: float) -> Array:
            cap = np.maximum(highest * math.exp(level), low)
            return self._solved(cap, CompiledEngine())

        slow, fast = math.log(_SLOWEST), 0.0
        if self.problem.times(capped(slow)).sum() < duration:
            raise EngineFailed(0)
        for _ in range(_HALVINGS):
            middle = 0.5 * (slow + fast)
            if not slow < middle < fast:
                break
            if self.problem.times(capped(middle)).sum() >= duration:
                slow = middle
            else:
                fast = middle
        return capped(slow)

    def _rows(self) -> StageRows:
        rows = self.problem.rows()
        tight = self._tight
        at_nodes = np.maximum(np.append(tight, tight[-1]), np.append(tight[0], tight))
        return StageRows(
            rows.s,
            rows.a * tight[:, None],
            rows.b * tight[:, None],
            rows.x_max / at_nodes,
            self._ends,
        )

    def _solved(self, cap: Array, engine: Engine) -> Array:
        rows = self._rows()
        rows, unit = natural_units(replace(rows, x_max=np.minimum(rows.x_max, cap)))
        # What is asked for at an end may be at a limit, and above it by rounding.
        first, last = rows.ends
        rows.x_max[0] = max(rows.x_max[0], min(first, rows.x_max[0] * (1.0 + _BESIDE)))
        rows.x_max[-1] = max(rows.x_max[-1], min(last, rows.x_max[-1] * (1.0 + _BESIDE)))
        if last > rows.x_max[-1]:
            raise EngineFailed(len(self.problem.h) - 1)
        x = engine.solve(rows) * unit
        for end, wanted in zip((0, -1), self._ends, strict=True):
            if x[end] < wanted * (1.0 - _MET):
                raise EngineFailed(end % len(self.problem.h))
            x[end] = wanted
        return x


def moving_span(
    path: JointPath,
    first: int,
    last: int,
    profile: LimitProfile,
    constraints: Sequence[PathConstraint],
    ends: tuple[float, float],
    check: Check,
    *,
    rough: bool = False,
) -> MovingSpan:
    """Time a span that begins or ends moving as fast as the limits allow.

    Args:
        path: The path.
        first: First knot of the span.
        last: Last knot of the span.
        profile: Joint limits on every piece of the path.
        constraints: Limits other than those of single joints.
        ends: Squared path velocity at the first and at the last knot.
        check: Is called now and then, and may end the search by an error of its own.
        rough: Whether a coarse grid will do.

    Returns:
        The span.

    Raises:
        EngineFailed: No path speed is as fast as asked for at both ends.
    """
    least = np.minimum(
        profile.acceleration[first:last].min(axis=0),
        -profile.acceleration_lower[first:last].max(axis=0),
    )
    grid = curvature_grid(path, (first, last), 1.0 / least, _COARSE)
    problem = SpanProblem.build(path, grid, profile, constraints)
    found = _tried(problem, ends, check)
    if rough and found is not None:
        return found
    for _ in range(_DOUBLINGS):
        check()
        problem = problem.on(regridded(problem.grid, np.full(len(problem.h), 2.0)))
        finer = _tried(problem, ends, check)
        if finer is None:
            continue
        if found is not None and found.duration <= (1.0 + _GAIN) * finer.duration:
            found = finer
            break
        found = finer
    if found is None:
        raise EngineFailed(0)
    if len(found.problem.h) <= _MOST_TOPPRA:
        try:
            by_toppra = MovingSpan(found.problem, ends, check, ToppraEngine())
        except EngineFailed:
            return found
        if by_toppra.duration <= (1.0 + 1e-3) * found.duration:
            return by_toppra
    return found


def _tried(problem: SpanProblem, ends: tuple[float, float], check: Check) -> MovingSpan | None:
    try:
        return MovingSpan(problem, ends, check, CompiledEngine())
    except EngineFailed:
        return None


def span_timing(span: MovingSpan, x: Array) -> SpanTiming:
    """Return a motion of a span as the timing of it.

    Args:
        span: The span.
        x: Squared path velocities at its nodes, shape (n + 1,).
    """
    return SpanTiming(span.problem, x, span.problem.times(x), 0.0, type(span.engine).__name__)
