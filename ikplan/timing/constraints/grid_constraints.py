"""Limits other than those of single joints on all intervals of a grid."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, steps_of
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.constraints.interval_points import IntervalPoints, parts_of
from ikplan.timing.engines.rows import place_rows
from ikplan.timing.grid import Grid

__all__ = ["GridConstraints"]


@dataclass(frozen=True, eq=False)
class GridConstraints:
    """Constraints at points of the intervals of a grid, evaluated once: robot models are slow.

    Attributes:
        path: The path.
        grid: The nodes.
        constraints: The constraints.
        shares: Where in each interval they are looked at.
    """

    path: JointPath
    grid: Grid
    constraints: tuple[PathConstraint, ...]
    shares: tuple[float, ...]

    @functools.cached_property
    def points(self) -> list[IntervalPoints]:
        """Those that are on the grid at all."""
        known: dict[PathConstraint, IntervalPoints] = self.__dict__.pop("_known", {})
        found = [
            IntervalPoints.of(self.path, self.grid, c, self.shares, known.get(c))
            for c in self.constraints
        ]
        return [points for points in found if points is not None]

    def know(self, others: Iterable[GridConstraints]) -> None:
        """Take over what others, of the same path, have evaluated at points of their grids.

        A range of the path whose grid is the same there is not evaluated again.
        """
        points = (points for other in others for points in other.__dict__.get("points", ()))
        mine = frozenset(self.constraints)
        self.__dict__["_known"] = {x.constraint: x for x in points if x.constraint in mine}

    @functools.cached_property
    def rows(self) -> tuple[Array, Array, Array]:
        """Rows a u + b x <= 1 at both ends of each interval, and bounds of x at both.

        A row that is zero bounds nothing. Constraints whose ranges do not meet share columns.
        Shapes (n, m), (n, m) and (n, 2).
        """
        h = steps_of(self.grid.s)
        n = len(h)
        occupied = np.zeros(n, dtype=np.int64)
        places = []
        for points in self.points:
            first = int(occupied[points.inside].max())
            occupied[points.inside] = first + 2 * points.rows.columns
            places.append(first)
        a, b = np.zeros((2, n, int(occupied.max(initial=0))))
        x_max = np.full((n, 2), np.inf)
        for first, points in zip(places, self.points, strict=True):
            inside, rows, start, end = points.inside, points.rows, points.where[0], points.where[-1]
            if rows.columns:
                nodes, at = np.unique(np.concatenate([start, end]), return_inverse=True)
                of_u, of_x = rows.coefficients(nodes)
                place_rows(a, b, of_u, of_x, inside, at.reshape(2, -1), h, first)
            x_max[inside, 0] = np.minimum(x_max[inside, 0], rows.x_max[start])
            x_max[inside, 1] = np.minimum(x_max[inside, 1], rows.x_max[end])
        return a, b, x_max

    @property
    def only_bound_speeds(self) -> bool:
        """Whether no constraint has rows: all that there are bound the path speed alone."""
        return not any(points.rows.columns for points in self.points)

    def ratios(self, x: Array) -> list[tuple[IntervalPoints, Array]]:
        """Return the limit ratios of the constraints at the points of intervals.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).

        Returns:
            For each constraint its points and the ratios there, shape (p, r, labels); see
            ConstraintRows.ratios.
        """
        if not self.constraints:
            return []
        share = np.array(self.shares)[:, None]
        here = x[:-1] + share * (x[1:] - x[:-1])
        here[-1] = x[1:]
        u = np.broadcast_to(steps_of(x) / (2.0 * steps_of(self.grid.s)), here.shape)
        return [(points, points.ratios(u, here)) for points in self.points]

    def slowdown_factors(self, u: Array, x: Array) -> Array:
        """Return by how much a motion would have to be slowed to keep the constraints.

        Args:
            u: Path accelerations at the starts, middles and ends of intervals, shape (3, n).
            x: Squared path velocities there, shape (3, n).

        Returns:
            The greatest factor of time in each interval, 1 where a limit is just kept, shape (n,).
        """
        largest = np.zeros(len(self.grid.pieces))
        for points in self.points:
            ratio = points.thrice.ratios(u, x).max(axis=(0, 2))
            largest[points.inside] = np.maximum(largest[points.inside], ratio)
        return np.asarray(np.sqrt(largest))

    def parts(self, x: Array, steady: bool) -> Array:
        """Return into how many each interval should be divided to see constraints between points.

        Args:
            x: Squared path velocities at the nodes, shape (n + 1,).
            steady: Whether speeds that bind shall hardly vary between points.

        Returns:
            Numbers, >= 1, shape (n,).
        """
        parts = np.ones(len(self.grid.pieces))
        for points, ratios in self.ratios(x):
            number = parts_of(points, ratios, steady)
            parts[points.inside] = np.maximum(parts[points.inside], number)
        return parts
