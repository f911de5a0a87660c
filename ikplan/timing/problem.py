"""One span of a path, on a grid, under limits: what an engine is given and how it is judged."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.timing.constraints import (
    BEND,
    SPEED_BEND,
    ConstraintRows,
    PathConstraint,
    PathPoints,
)
from ikplan.timing.engine import Engine
from ikplan.timing.excess import usage, utilisation
from ikplan.timing.grid import Grid
from ikplan.timing.joint_path import JointPath
from ikplan.timing.profile import LimitProfile
from ikplan.timing.rows import StageRows, acceleration_rows, natural_units, velocity_bounds

__all__ = ["SpanProblem"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_TIGHTENINGS = 4
_ENOUGH = 2e-4
_NEAR = 0.98


@dataclass(frozen=True, eq=False)
class SpanProblem:
    """The derivatives of a path and the limits on it, interval by interval.

    Attributes:
        path: The path.
        grid: The nodes.
        profile: Joint limits on every piece of the path.
        constraints: Limits other than those of single joints.
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts of the intervals, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        bounds: Upper and lower velocity limits, upper and lower acceleration limits, each of
            shape (n, dof).
    """

    path: JointPath
    grid: Grid
    profile: LimitProfile
    constraints: tuple[PathConstraint, ...]
    h: Array
    qs0: Array
    qss0: Array
    qss1: Array
    bounds: tuple[Array, Array, Array, Array]

    @classmethod
    def build(
        cls,
        path: JointPath,
        grid: Grid,
        profile: LimitProfile,
        constraints: Sequence[PathConstraint] = (),
    ) -> SpanProblem:
        """Evaluate a path on a grid.

        Args:
            path: The path.
            grid: Nodes of one span of it.
            profile: Joint limits on every piece of the path.
            constraints: Limits other than those of single joints.

        Returns:
            The problem.
        """
        n = len(grid.pieces)
        both = np.concatenate([grid.s[:-1], grid.s[1:]])
        _, qs, qss = path.derivatives(both, np.concatenate([grid.pieces, grid.pieces]))
        return cls(
            path=path,
            grid=grid,
            profile=profile,
            constraints=tuple(constraints),
            h=np.diff(grid.s),
            qs0=qs[:n],
            qss0=qss[:n],
            qss1=qss[n:],
            bounds=(
                profile.velocity[grid.pieces],
                profile.velocity_lower[grid.pieces],
                profile.acceleration[grid.pieces],
                profile.acceleration_lower[grid.pieces],
            ),
        )

    def rows(self, tightening: Array | None = None) -> StageRows:
        """Return the limits as rows for an engine.

        Args:
            tightening: By how much to divide the constraints (not the joint limits) in each
                interval, shape (n,), >= 1; None: not at all.
        """
        a, b = acceleration_rows(
            self.h, self.qs0, self.qss0, self.qss1, self.bounds[2], self.bounds[3]
        )
        x_max = velocity_bounds(self.h, self.qs0, self.qss0, self.qss1, *self.bounds[:2])
        if self.constraints:
            more_a, more_b, more_x = self._constraint_rows
            if tightening is not None:
                more_a, more_b = more_a * tightening[:, None], more_b * tightening[:, None]
                more_x = more_x / tightening[:, None]
            a, b = np.hstack([a, more_a]), np.hstack([b, more_b])
            x_max[:-1] = np.minimum(x_max[:-1], more_x[:, 0])
            x_max[1:] = np.minimum(x_max[1:], more_x[:, 1])
        return StageRows(self.grid.s, a, b, x_max)

    @functools.cached_property
    def _prepared(self) -> list[tuple[PathConstraint, Indices, Indices, ConstraintRows]]:
        """Every constraint with its intervals, and its points at their starts, middles and ends.

        Evaluated once a grid: robot models are slow. The end of an interval is the start of the
        next one of the same piece.
        """
        s, pieces = self.grid.s, self.grid.pieces
        middle = 0.5 * (s[:-1] + s[1:])
        prepared = []
        for constraint in self.constraints:
            inside = np.flatnonzero((middle > constraint.start) & (middle < constraint.end))
            if not len(inside):
                continue
            joined = np.append(pieces[1:] == pieces[:-1], False)[inside]
            alone = inside[~joined]
            r = len(inside)
            where = np.zeros((3, r), dtype=np.int64)
            where[0], where[1] = np.arange(r), r + np.arange(r)
            where[2, joined] = where[0, joined] + 1
            where[2, ~joined] = 2 * r + np.arange(len(alone))
            at = np.concatenate([s[inside], middle[inside], s[alone + 1]])
            of = np.concatenate([pieces[inside], pieces[inside], pieces[alone]])
            q, qs, qss = self.path.derivatives(at, of)
            rows = constraint.at(PathPoints(at, q, qs, qss, self.path.length))
            prepared.append((constraint, inside, where, rows))
        return prepared

    @functools.cached_property
    def _constraint_rows(self) -> tuple[Array, Array, Array]:
        """Rows of the constraints at both ends of each interval, and bounds of x at both.

        A row that is zero bounds nothing. Constraints whose ranges do not meet share columns.
        """
        n = len(self.h)
        used = np.zeros(n, dtype=np.int64)
        places = []
        for _, inside, _, rows in self._prepared:
            first = int(used[inside].max())
            used[inside] = first + 2 * rows.a.shape[1]
            places.append(first)
        a, b = np.zeros((2, n, int(used.max(initial=0))))
        x_max = np.full((n, 2), np.inf)
        for first, (_, inside, (start, _, end), rows) in zip(places, self._prepared, strict=True):
            middle, last = first + rows.a.shape[1], first + 2 * rows.a.shape[1]
            a[inside, first:middle], b[inside, first:middle] = rows.a[start], rows.b[start]
            a[inside, middle:last] = rows.a[end] + 2.0 * self.h[inside, None] * rows.b[end]
            b[inside, middle:last] = rows.b[end]
            x_max[inside, 0] = np.minimum(x_max[inside, 0], rows.x_max[start])
            x_max[inside, 1] = np.minimum(x_max[inside, 1], rows.x_max[end])
        return a, b, x_max

    def asked(self, u: Array, x: Array) -> Array:
        """Return by how much a motion would have to be slowed to keep the constraints.

        Args:
            u: Path accelerations at the starts, middles and ends of intervals, shape (3, n).
            x: Squared path velocities there, shape (3, n).

        Returns:
            The greatest factor of time in each interval, 1 where a limit is just kept, shape (n,).
        """
        top = np.zeros(len(self.h))
        for _, inside, where, rows in self._prepared:
            for index, pull, square in zip(where, u[:, inside], x[:, inside], strict=True):
                demand = rows.demand(index, pull, square).max(axis=1)
                top[inside] = np.maximum(top[inside], demand)
        return np.asarray(np.sqrt(top))

    def demands(self, x: Array) -> list[tuple[PathConstraint, Indices, Array]]:
        """Return how far the constraints are used at the start, middle and end of intervals.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).

        Returns:
            For each constraint: the intervals in its range, shape (r,), and the demands, shape
            (3, r, labels); see ConstraintRows.demand.
        """
        u = np.diff(x) / (2.0 * self.h)
        found = []
        for constraint, inside, where, rows in self._prepared:
            first, last = x[inside], x[inside + 1]
            here = (first, 0.5 * (first + last), last)
            parts = [
                rows.demand(index, u[inside], at) for index, at in zip(where, here, strict=True)
            ]
            found.append((constraint, inside, np.array(parts)))
        return found

    def parts(self, x: Array, steady: bool) -> Array:
        """Return into how many each interval should be divided to see constraints between points.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
            steady: Whether speeds that bind shall hardly vary between points.

        Returns:
            Numbers, >= 1, shape (n,).
        """
        wanted = np.ones(len(self.h))
        for constraint, inside, demand in self.demands(x):
            bend = np.abs(demand[0] - 2.0 * demand[1] + demand[2])
            near = demand.max(axis=0) + bend > _NEAR
            most = [
                SPEED_BEND if steady and kind.endswith("speed") else BEND
                for kind, _ in constraint.labels
            ]
            number = np.where(near, np.sqrt(bend / most), 1.0).max(axis=1)
            wanted[inside] = np.maximum(wanted[inside], number)
        return wanted

    def usage(self, x: Array) -> tuple[Array, Array]:
        """Return the exact greatest shares of velocity and acceleration limits, (n, dof) each.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        return usage(self.h, x, self.qs0, self.qss0, self.qss1, *self.bounds)

    def solve(self, engine: Engine) -> Array:
        """Return the squared path velocities that an engine finds, shape (n + 1,).

        Constraints are put to the engine at the ends of intervals. Where they are exceeded in the
        middle of one, they are tightened there and the problem solved again.

        Args:
            engine: The engine.

        Returns:
            Velocities that may still exceed limits by a little; see slowdown.

        Raises:
            EngineFailed: The engine found none.
        """
        rows, unit = natural_units(self.rows())
        x = engine.solve(rows) * unit
        tightening = np.ones(len(self.h))
        for _ in range(_TIGHTENINGS if self.constraints else 0):
            top = np.zeros(len(self.h))
            for _, inside, demand in self.demands(x):
                top[inside] = np.maximum(top[inside], demand.max(axis=(0, 2)))
            if top.max() <= 1.0 + _ENOUGH:
                break
            tightening *= np.maximum(top, 1.0)
            rows, unit = natural_units(self.rows(tightening))
            x = engine.solve(rows) * unit
        return x

    def slowdown(self, x: Array) -> float:
        """Return by what x has to be divided so that every limit is kept.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        v_share, a_share = self.usage(x)
        demands = [float(demand.max()) for _, _, demand in self.demands(x)]
        return max(float(v_share.max()) ** 2, float(a_share.max()), *demands, 0.0)

    def loss(self, x: Array) -> Array:
        """Return about how much time each interval takes more than it would on a fine grid.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).

        Returns:
            Times [s], shape (n,), never negative.
        """
        share = utilisation(self.h, x, self.qs0, self.qss0, self.qss1, *self.bounds)
        for _, inside, demand in self.demands(x):
            top = np.sqrt(demand.max(axis=2))
            mean = (top[0] + 4.0 * top[1] + top[2]) / 6.0
            share[inside] = np.maximum(share[inside], mean)
        return self.times(x) * np.maximum(1.0 - share, 0.0)

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
