"""One span of a path, on a grid, under limits: what an engine is given and how it is judged."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.constraints.grid_constraints import GridConstraints
from ikplan.timing.constraints.interval_points import COARSE, FINE, highest
from ikplan.timing.engines.compiled_engine import HIGHEST, CompiledEngine
from ikplan.timing.engines.engine import Engine, EngineFailed, checked
from ikplan.timing.engines.rest_to_rest import spans_at_limit, time_rest_to_rest
from ikplan.timing.engines.rows import StageRows, acceleration_rows, natural_units, velocity_bounds
from ikplan.timing.engines.toppra_engine import ToppraEngine
from ikplan.timing.grid import Grid
from ikplan.timing.limit_ratios import limit_ratios
from ikplan.timing.profile import LimitProfile
from ikplan.timing.span_ratios import largest_ratios, speed_ratios

__all__ = ["SpanProblem"]


_TIGHTENINGS = 4
_ENOUGH = 2e-4


@dataclass(frozen=True, eq=False)
class SpanProblem:
    """The derivatives of a path and the limits on it, interval by interval.

    Attributes:
        path: The path.
        grid: The nodes.
        profile: Joint limits on every piece of the path.
        others: Limits other than those of single joints.
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts of the intervals, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        rests: Nodes between the ends at which the motion rests, shape (k,): of spans that are
            timed together.
    """

    path: JointPath
    grid: Grid
    profile: LimitProfile
    others: GridConstraints
    h: Array
    qs0: Array
    qss0: Array
    qss1: Array
    rests: Indices

    @classmethod
    def build(
        cls,
        path: JointPath,
        grid: Grid,
        profile: LimitProfile,
        constraints: Sequence[PathConstraint] = (),
        fine: bool = True,
        rests: Array | None = None,
    ) -> SpanProblem:
        """Evaluate a path on a grid.

        Args:
            path: The path.
            grid: Nodes of one span of it.
            profile: Joint limits on every piece of the path.
            constraints: Limits other than those of single joints.
            fine: Whether they are looked at in five places of an interval, or in three.
            rests: Path positions between the ends, nodes of the grid, at which the motion rests;
                None: nowhere.

        Returns:
            The problem.
        """
        qs0, qss0, qss1 = path.slopes_on(grid.s, grid.pieces)
        return cls(
            path=path,
            grid=grid,
            profile=profile,
            others=GridConstraints(path, grid, tuple(constraints), FINE if fine else COARSE),
            h=np.diff(grid.s),
            qs0=qs0,
            qss0=qss0,
            qss1=qss1,
            rests=np.searchsorted(grid.s, np.zeros(0) if rests is None else rests),
        )

    def on(self, grid: Grid, fine: bool = True) -> SpanProblem:
        """Return the same problem on another grid."""
        rests = self.grid.s[self.rests]
        return SpanProblem.build(self.path, grid, self.profile, self.constraints, fine, rests)

    def within(self, profile: LimitProfile) -> SpanProblem:
        """Return the same problem with other limits of the joints."""
        return replace(self, profile=profile)

    def under(self, constraints: tuple[PathConstraint, ...]) -> SpanProblem:
        """Return the same problem with other constraints."""
        return replace(self, others=replace(self.others, constraints=constraints))

    @property
    def constraints(self) -> tuple[PathConstraint, ...]:
        """Limits other than those of single joints."""
        return self.others.constraints

    def rows(self, tightening: Array | None = None) -> StageRows:
        """Return the limits as rows for an engine.

        Args:
            tightening: By how much to divide the constraints (not the joint limits) in each
                interval, shape (n,), >= 1; None: not at all.
        """
        x_max = self._velocity_bounds.copy()
        more_a, more_b, more_x = self.others.rows
        n, own = len(self.h), 6 * self.path.dof
        a, b = np.empty((2, n, own + more_a.shape[1]))
        acceleration_rows(*self._slopes, *self._limits[2:], a, b)
        if self.constraints:
            a[:, own:], b[:, own:] = more_a, more_b
            if tightening is not None:
                a[:, own:] *= tightening[:, None]
                b[:, own:] *= tightening[:, None]
                more_x = more_x / tightening[:, None]
            x_max[:-1] = np.minimum(x_max[:-1], more_x[:, 0])
            x_max[1:] = np.minimum(x_max[1:], more_x[:, 1])
        return StageRows(self.grid.s, a, b, x_max)

    @property
    def bounds(self) -> tuple[Array, Array, Array, Array]:
        """Upper and lower velocity limits, upper and lower acceleration limits, (n, dof) each."""
        up, down, a_up, a_down = self._limits
        k = self.grid.pieces
        return up[k], down[k], a_up[k], a_down[k]

    @property
    def _slopes(self) -> tuple[Array, Array, Array, Array, Indices]:
        """Lengths of the intervals, the derivatives at their ends, and their pieces."""
        return self.h, self.qs0, self.qss0, self.qss1, self.grid.pieces

    @property
    def _limits(self) -> tuple[Array, Array, Array, Array]:
        """The same as bounds, of the pieces of the path, shape (k, dof) each."""
        profile = self.profile
        rates = profile.velocity, profile.velocity_lower
        return *rates, profile.acceleration, profile.acceleration_lower

    @functools.cached_property
    def _ends(self) -> Indices:
        """First interval of each span from rest to rest, and n, shape (k + 2,)."""
        return np.concatenate([[0], self.rests, [len(self.h)]])

    @functools.cached_property
    def _velocity_bounds(self) -> Array:
        """Upper bounds of x at the nodes by the joint velocities, 0 where the motion rests."""
        x_max = velocity_bounds(*self._slopes, *self._limits[:2])
        x_max[self.rests] = 0.0
        return x_max

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
        if self._spans_alone and isinstance(engine, CompiledEngine):
            return self._solved_span_by_span(np.ones(len(self.rests) + 1, dtype=np.bool_))
        rows, unit = self._in_units_of(engine)
        x = engine.solve(rows) * unit
        tightening = np.ones(len(self.h))
        for _ in range(_TIGHTENINGS if self.constraints else 0):
            largest = np.zeros(len(self.h))
            for points, ratios in self.others.ratios(x):
                most = highest(ratios).max(axis=1)
                largest[points.inside] = np.maximum(largest[points.inside], most)
            if largest.max() <= 1.0 + _ENOUGH:
                break
            tightening *= np.maximum(largest, 1.0)
            rows, unit = self._in_units_of(engine, tightening)
            x = engine.solve(rows) * unit
        return x

    @property
    def _spans_alone(self) -> bool:
        """Whether spans are timed together under limits of the joints alone."""
        return len(self.rests) > 0 and not self.constraints

    def _solved_span_by_span(self, wanted: Flags, known: Array | None = None) -> Array:
        """Solve the spans that are wanted; the others are as they are known."""
        x = np.zeros(len(self.h) + 1) if known is None else known.copy()
        x_max = np.minimum(self._velocity_bounds, HIGHEST)
        time_rest_to_rest(*self._slopes, *self._limits[2:], x_max, self._ends, wanted, x)
        return checked(x)

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
        if not self._spans_alone:
            return wider.compiled_duration
        x = self.compiled_solution
        faster = profile.acceleration is not self.profile.acceleration
        held = spans_at_limit(
            *self._slopes,
            *self._limits[2:],
            joint if faster else -1,
            x,
            self._velocity_bounds,
            wider._velocity_bounds,
            self._ends,
        )
        x = wider._solved_span_by_span(held, x)
        return float(wider.times(wider.kept(x, 1e-300)).sum())

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
        return float(self.times(self.kept(self.compiled_solution, 1e-300)).sum())

    def largest_ratio(self, x: Array) -> float:
        """Return the largest limit ratio: x divided by it keeps every limit.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        return float(self._largest_ratios(x, 0.0).max())

    def _largest_ratios(self, x: Array, least: float) -> Array:
        """Largest limit ratio of each span from rest to rest, or the least, shape (k + 1,)."""
        largest = largest_ratios(
            self.h,
            x,
            self.qs0,
            self.qss0,
            self.qss1,
            self.grid.pieces,
            *self._limits,
            self._ends,
            least,
        )
        for points, ratios in self.others.ratios(x):
            of_interval = np.zeros(len(self.h))
            of_interval[points.inside] = highest(ratios).max(axis=1)
            largest = np.maximum(largest, np.maximum.reduceat(of_interval, self._ends[:-1]))
        return largest

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
        per_interval = np.repeat(factor, np.diff(self._ends))
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
            self.h, x, self.qs0, self.qss0, self.qss1, self.grid.pieces, *self._limits
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
