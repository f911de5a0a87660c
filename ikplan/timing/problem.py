"""One span of a path, on a grid, under limits: what an engine is given and how it is judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.timing.excess import usage, utilisation
from ikplan.timing.grid import Grid
from ikplan.timing.joint_path import JointPath
from ikplan.timing.limits import JointLimits
from ikplan.timing.rows import StageRows, acceleration_rows, velocity_bounds

__all__ = ["SpanProblem"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SpanProblem:
    """The derivatives of a path and the limits of its joints, interval by interval.

    Attributes:
        grid: The nodes.
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts of the intervals, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        bounds: Upper and lower velocity limits, upper and lower acceleration limits, each of
            shape (n, dof).
    """

    grid: Grid
    h: Array
    qs0: Array
    qss0: Array
    qss1: Array
    bounds: tuple[Array, Array, Array, Array]

    @classmethod
    def build(cls, path: JointPath, grid: Grid, limits: JointLimits) -> SpanProblem:
        """Evaluate a path on a grid.

        Args:
            path: The path.
            grid: Nodes of one span of it.
            limits: Joint limits.

        Returns:
            The problem.
        """
        n = len(grid.pieces)
        both = np.concatenate([grid.s[:-1], grid.s[1:]])
        _, qs, qss = path.derivatives(both, np.concatenate([grid.pieces, grid.pieces]))
        velocity, velocity_lower, acceleration, acceleration_lower = (
            np.tile(bound, (n, 1))
            for bound in (
                limits.velocity,
                limits.velocity_lower,
                limits.acceleration,
                limits.acceleration_lower,
            )
        )
        return cls(
            grid=grid,
            h=np.diff(grid.s),
            qs0=qs[:n],
            qss0=qss[:n],
            qss1=qss[n:],
            bounds=(velocity, velocity_lower, acceleration, acceleration_lower),
        )

    def rows(self) -> StageRows:
        """Return the limits as rows for an engine."""
        a, b = acceleration_rows(
            self.h, self.qs0, self.qss0, self.qss1, self.bounds[2], self.bounds[3]
        )
        x_max = velocity_bounds(self.h, self.qs0, self.qss0, self.qss1, *self.bounds[:2])
        return StageRows(self.grid.s, a, b, x_max)

    def usage(self, x: Array) -> tuple[Array, Array]:
        """Return the exact greatest shares of velocity and acceleration limits, (n, dof) each.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
        """
        return usage(self.h, x, self.qs0, self.qss0, self.qss1, *self.bounds)

    def loss(self, x: Array) -> Array:
        """Return about how much time each interval takes more than it would on a fine grid.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).

        Returns:
            Times [s], shape (n,), never negative.
        """
        share = utilisation(self.h, x, self.qs0, self.qss0, self.qss1, *self.bounds)
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
