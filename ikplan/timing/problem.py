"""One span of a path, on a grid, under limits: what an engine is given and how it is judged."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags, steps_of
from ikplan.timing.constraints.interval_points import highest
from ikplan.timing.engines.compiled_engine import HIGHEST, CompiledEngine
from ikplan.timing.engines.engine import Engine, EngineFailed, checked
from ikplan.timing.engines.rest_to_rest import spans_at_limit, time_rest_to_rest
from ikplan.timing.engines.rows import (
    StageRows,
    acceleration_rows,
    interval_unit,
    natural_units,
)
from ikplan.timing.engines.toppra_engine import ToppraEngine
from ikplan.timing.limit_ratios import limit_ratios
from ikplan.timing.profile import LimitProfile
from ikplan.timing.span_intervals import SpanIntervals
from ikplan.timing.span_ratios import largest_ratios, run_durations, speed_ratios

__all__ = ["SpanProblem"]


_TIGHTENINGS = 4
_ENOUGH = 2e-4


@dataclass(frozen=True, eq=False)
class SpanProblem(SpanIntervals):
    """The intervals of a span, solved by an engine, and what a solution makes of their limits."""

    def rows(self, tightening: Array | None = None) -> StageRows:
        """Return the limits as rows for an engine.

        Args:
            tightening: By how much to divide the constraints (not the joint limits) in each
                interval, shape (n,), >= 1; None: not at all.
        """
        more_a, more_b, _ = self.others.rows
        n, own = len(self.h), 6 * self.path.dof
        a, b = np.empty((2, n, own + more_a.shape[1]))
        acceleration_rows(*self.slopes, *self.piece_limits[2:], a, b)
        if self.constraints:
            a[:, own:], b[:, own:] = more_a, more_b
            if tightening is not None:
                a[:, own:] *= tightening[:, None]
                b[:, own:] *= tightening[:, None]
        return StageRows(self.grid.s, a, b, self.highest_speeds(tightening))

    def limit_ratios(self, x: Array) -> tuple[Array, Array]:
        """Return the exact greatest ratios to velocity and acceleration limits, (n, dof) each.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        return limit_ratios(self.h, x, self.qs0, self.qss0, self.qss1, *self.bounds)

    def solve(self, engine: Engine) -> Array:
        """Return the squared path velocities that an engine finds, shape (n + 1,).

        Constraints are put to the engine at the ends of intervals. Where they are exceeded inside
        one, they are tightened there and the problem solved again.

        Args:
            engine: The engine.

        Returns:
            Velocities that may still exceed limits by a little; see largest_ratio.

        Raises:
            EngineFailed: The engine found none.
        """
        x = self._solved(engine)
        tightening = np.ones(len(self.h))
        for _ in range(_TIGHTENINGS if self.constraints else 0):
            largest = np.zeros(len(self.h))
            for points, ratios in self.others.ratios(x):
                most = highest(ratios).max(axis=1)
                largest[points.inside] = np.maximum(largest[points.inside], most)
            if largest.max() <= 1.0 + _ENOUGH:
                break
            tightening *= np.maximum(largest, 1.0)
            x = self._solved(engine, tightening, (x, largest > 1.0))
        return x

    def _solved(
        self,
        engine: Engine,
        tightening: Array | None = None,
        before: tuple[Array, Flags] | None = None,
    ) -> Array:
        """Solve the problem once, the constraints tightened in each interval.

        Before is the solution that it had, and in which intervals it is tightened since: spans
        without any keep it.
        """
        if isinstance(engine, CompiledEngine) and self.others.only_bound_speeds:
            highest = self.highest_speeds(tightening)
            if before is None or len(self.rests) == 0:
                return self._solved_span_by_span(highest, np.ones(len(self.ends) - 1, np.bool_))
            known, tighter = before
            wanted = np.logical_or.reduceat(tighter, self.ends[:-1])
            return self._solved_span_by_span(highest, wanted, known)
        rows, unit = self._in_units_of(engine, tightening)
        return engine.solve(rows) * unit

    def _solved_span_by_span(
        self, highest_x: Array, wanted: Flags, known: Array | None = None
    ) -> Array:
        """Solve the wanted spans under the acceleration limits of the joints and bounds of x.

        The other spans keep their known solutions.
        """
        s, unit, length = self.grid.s, 1.0, 1.0
        if len(self.rests) == 0:
            s, unit, length = self._natural_units(highest_x)
        x = np.zeros(len(self.h) + 1) if known is None else known.copy()
        x_max = np.minimum(highest_x / unit, HIGHEST)
        time_rest_to_rest(
            *self.slopes,
            *self.piece_limits[2:],
            s,
            unit,
            length,
            x_max,
            self.ends,
            wanted,
            x,
        )
        return checked(x) * unit

    def _natural_units(self, highest_x: Array) -> tuple[Array, float, float]:
        """The nodes in units of the length, the unit of x and the length, as of natural_units."""
        s = self.grid.s
        length = float(s[-1] - s[0])
        limits = self.piece_limits[2:]
        unit = interval_unit(length, highest_x, *self.slopes, *limits)
        return (s - s[0]) / length, unit, length

    def duration_under(self, profile: LimitProfile, joint: int) -> float:
        """Return the compiled duration of the same problem with wider limits of one joint [s].

        Of spans that are timed together only those are solved again that those limits hold.

        Args:
            profile: The joint limits, one of them wider.
            joint: The joint whose limit is wider.

        Raises:
            EngineFailed: As for compiled_solution.
        """
        wider = self.within(profile)
        if len(self.rests) == 0 or self.constraints:
            return wider.compiled_duration
        x = self.compiled_solution
        faster = profile.acceleration is not self.profile.acceleration
        held = spans_at_limit(
            *self.slopes,
            *self.piece_limits[2:],
            joint if faster else -1,
            x,
            self.velocity_bounds,
            wider.velocity_bounds,
            self.ends,
        )
        x = wider._solved_span_by_span(wider.velocity_bounds, held, x)
        factor = wider._joint_ratios(x, 1e-300, held)
        durations = run_durations(self.h, x, self.ends, factor)
        return float(np.where(held, durations, self._compiled_durations).sum())

    def _in_units_of(
        self, engine: Engine, tightening: Array | None = None
    ) -> tuple[StageRows, float]:
        """Return the rows in units that suit an engine, and the unit of x."""
        rows = self.rows(tightening)
        # The compiled engine has no absolute tolerances, and to scale the rows of many spans would
        # cost as much as half of solving them.
        if len(self.rests) and isinstance(engine, CompiledEngine):
            return rows, 1.0
        return natural_units(rows)

    @functools.cached_property
    def compiled_solution(self) -> Array:
        """The squared path velocities that the compiled engine finds, or else toppra.

        Raises:
            EngineFailed: Neither found any.
        """
        try:
            return self.solve(CompiledEngine())
        except EngineFailed:
            return self.solve(ToppraEngine())

    @functools.cached_property
    def compiled_duration(self) -> float:
        """The duration of that solution, slowed or quickened until a limit binds [s].

        Raises:
            EngineFailed: As for compiled_solution.
        """
        if len(self.rests):
            return float(self._compiled_durations.sum())
        return float(self.times(self.kept(self.compiled_solution, 1e-300)).sum())

    @functools.cached_property
    def _compiled_durations(self) -> Array:
        """The same of each span from rest to rest [s], shape (k + 1,)."""
        x = self.compiled_solution
        return run_durations(self.h, x, self.ends, self._largest_ratios(x, 1e-300))

    def largest_ratio(self, x: Array) -> float:
        """Return the largest limit ratio: x divided by it keeps every limit.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        return float(self._largest_ratios(x, 0.0).max())

    def _largest_ratios(self, x: Array, least: float) -> Array:
        """Largest limit ratio of each span from rest to rest, or the least, shape (k + 1,)."""
        largest = self._joint_ratios(x, least, np.ones(len(self.rests) + 1, dtype=np.bool_))
        for points, ratios in self.others.ratios(x):
            of_interval = np.zeros(len(self.h))
            of_interval[points.inside] = highest(ratios).max(axis=1)
            largest = np.maximum(largest, np.maximum.reduceat(of_interval, self.ends[:-1]))
        return largest

    def _joint_ratios(self, x: Array, least: float, wanted: Flags) -> Array:
        """Largest ratio to a limit of a joint of each wanted span, or the least, shape (k + 1,)."""
        slopes, limits = self.slopes, self.piece_limits
        return largest_ratios(slopes[0], x, *slopes[1:], *limits, self.ends, least, wanted)

    def interval_ratios(self, x: Array) -> Array:
        """Return the largest limit ratio on each interval, as a ratio of x, shape (n,).

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        v_ratio, a_ratio = self.limit_ratios(x)
        largest = np.maximum(v_ratio.max(axis=1) ** 2, a_ratio.max(axis=1))
        for points, ratios in self.others.ratios(x):
            most = highest(ratios).max(axis=1)
            largest[points.inside] = np.maximum(largest[points.inside], most)
        return np.asarray(largest)

    def kept(self, x: Array, least: float, margin: float = 0.0) -> Array:
        """Return velocities slowed span by span until they keep every limit.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
            least: Spans are divided by no less than this: by 1 none is made faster.
            margin: Share by which more than needed.
        """
        factor = self._largest_ratios(x, least) * (1.0 + margin)
        if len(factor) == 1:
            return np.asarray(x / factor[0])
        per_interval = np.repeat(factor, steps_of(self.ends))
        # The nodes at both ends of a span rest.
        return np.asarray(x / np.append(per_interval, factor[-1]))

    def loss(self, x: Array) -> Array:
        """Return about how much time each interval takes more than it would on a fine grid.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).

        Returns:
            Times [s], shape (n,), never negative.
        """
        ratio = speed_ratios(
            self.h, x, self.qs0, self.qss0, self.qss1, self.grid.pieces, *self.piece_limits
        )
        for points, ratios in self.others.ratios(x):
            speed = np.sqrt(ratios.max(axis=2))
            mean = (speed[0] + 4.0 * speed[len(speed) // 2] + speed[-1]) / 6.0
            ratio[points.inside] = np.maximum(ratio[points.inside], mean)
        return self.times(x) * np.maximum(1.0 - ratio, 0.0)

    def times(self, x: Array) -> Array:
        """Return the durations of the intervals [s], shape (n,); inf where nothing moves.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        sdot = np.sqrt(x)
        total = sdot[1:] + sdot[:-1]
        dt = np.full(len(self.h), np.inf)
        np.divide(2.0 * self.h, total, out=dt, where=total > 0.0)
        return dt
