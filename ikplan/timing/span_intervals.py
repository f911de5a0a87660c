"""The intervals of a span of a path: derivatives at their ends, and the limits on them."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from ikplan.arrays import Array, Indices, steps_of
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.constraints.grid_constraints import GridConstraints
from ikplan.timing.constraints.interval_points import COARSE, FINE
from ikplan.timing.engines.rows import velocity_bounds
from ikplan.timing.grid import Grid
from ikplan.timing.profile import LimitProfile

__all__ = ["SpanIntervals"]


@dataclass(frozen=True, eq=False)
class SpanIntervals:
    """The derivatives of a path and the limits on it, interval by interval.

    Attributes:
        path: The path.
        grid: The nodes.
        profile: Joint limits on every piece of the path.
        others: Limits other than those of single joints.
        h: Lengths of the intervals, shape (n,).
        rests: Nodes between the ends at which the motion rests, shape (k,): of spans that are
            timed together.
        sparse: Whether the grid is one of spans that were timed together, which have fewer nodes
            than a span that is timed by itself.
    """

    path: JointPath
    grid: Grid
    profile: LimitProfile
    others: GridConstraints
    h: Array
    rests: Indices
    sparse: bool = False

    @classmethod
    def build(
        cls,
        path: JointPath,
        grid: Grid,
        profile: LimitProfile,
        constraints: Sequence[PathConstraint] = (),
        fine: bool = True,
        rests: Array | None = None,
    ) -> Self:
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
        return cls(
            path=path,
            grid=grid,
            profile=profile,
            others=GridConstraints(path, grid, tuple(constraints), FINE if fine else COARSE),
            h=steps_of(grid.s),
            rests=np.searchsorted(grid.s, np.zeros(0) if rests is None else rests),
        )

    def on(self, grid: Grid, fine: bool = True) -> Self:
        """Return the same problem on another grid."""
        rests = self.grid.s[self.rests]
        other = type(self).build(self.path, grid, self.profile, self.constraints, fine, rests)
        other.others.know([self.others])
        return other

    def within(self, profile: LimitProfile) -> Self:
        """Return the same problem with other limits of the joints."""
        other = replace(self, profile=profile)
        other.__dict__["_derivatives"] = self._derivatives
        if profile.velocity is self.profile.velocity:
            other.__dict__["velocity_bounds"] = self.velocity_bounds
        return other

    def under(self, constraints: tuple[PathConstraint, ...]) -> Self:
        """Return the same problem with other constraints."""
        return replace(self, others=replace(self.others, constraints=constraints))

    @property
    def constraints(self) -> tuple[PathConstraint, ...]:
        """Limits other than those of single joints."""
        return self.others.constraints

    @functools.cached_property
    def _derivatives(self) -> tuple[Array, Array, Array]:
        return self.path.slopes_on(self.grid.s, self.grid.pieces)

    @property
    def qs0(self) -> Array:
        """dq/ds at the starts of the intervals, shape (n, dof)."""
        return self._derivatives[0]

    @property
    def qss0(self) -> Array:
        """d2q/ds2 at the starts, shape (n, dof)."""
        return self._derivatives[1]

    @property
    def qss1(self) -> Array:
        """d2q/ds2 at the ends, shape (n, dof)."""
        return self._derivatives[2]

    def forget(self) -> None:
        """Let go of what can be computed again: of many spans it is most of what they take."""
        for name in ("_derivatives", "velocity_bounds"):
            self.__dict__.pop(name, None)

    @property
    def bounds(self) -> tuple[Array, Array, Array, Array]:
        """Upper and lower velocity limits, upper and lower acceleration limits, (n, dof) each."""
        up, down, a_up, a_down = self.piece_limits
        k = self.grid.pieces
        return up[k], down[k], a_up[k], a_down[k]

    @property
    def slopes(self) -> tuple[Array, Array, Array, Array, Indices]:
        """Lengths of the intervals, the derivatives at their ends, and their pieces."""
        return self.h, self.qs0, self.qss0, self.qss1, self.grid.pieces

    @property
    def piece_limits(self) -> tuple[Array, Array, Array, Array]:
        """The same as bounds, of the pieces of the path, shape (k, dof) each."""
        profile = self.profile
        rates = profile.velocity, profile.velocity_lower
        return *rates, profile.acceleration, profile.acceleration_lower

    @functools.cached_property
    def ends(self) -> Indices:
        """First interval of each span from rest to rest, and n, shape (k + 2,)."""
        return np.concatenate([[0], self.rests, [len(self.h)]])

    @functools.cached_property
    def velocity_bounds(self) -> Array:
        """Upper bounds of x at the nodes by the joint velocities, 0 where the motion rests."""
        x_max = velocity_bounds(*self.slopes, *self.piece_limits[:2])
        x_max[self.rests] = 0.0
        return x_max

    def highest_speeds(self, tightening: Array | None = None) -> Array:
        """Upper bounds of x at the nodes by the speeds of the joints and by the constraints.

        Args:
            tightening: By how much to divide the constraints in each interval, shape (n,), >= 1;
                None: not at all.
        """
        if not self.constraints:
            return self.velocity_bounds
        x_max, more_x = self.velocity_bounds.copy(), self.others.rows[2]
        if tightening is not None:
            more_x = more_x / tightening[:, None]
        x_max[:-1] = np.minimum(x_max[:-1], more_x[:, 0])
        x_max[1:] = np.minimum(x_max[1:], more_x[:, 1])
        return x_max
