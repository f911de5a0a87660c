"""Limits other than those of single joints, at points of every interval of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import (
    BEND,
    SPEED_BEND,
    ConstraintRows,
    PathConstraint,
    PathPoints,
)
from ikplan.timing.constraints.interval_kernels import highest_between
from ikplan.timing.grid import Grid

__all__ = ["COARSE", "FINE", "IntervalPoints", "bend", "highest", "parts_of"]


# Where in an interval limits are looked at, as shares of its length. From three points a limit
# is taken to be a parabola; a curve like an S looks like a line to them, to five it does not.
COARSE = (0.0, 0.5, 1.0)
FINE = (0.0, 0.25, 0.5, 0.75, 1.0)
# A limit whose ratio is less than this, the bend included, does not bind anywhere in the interval.
_NEAR = 0.98


@dataclass(frozen=True, eq=False)
class IntervalPoints:
    """One constraint at points of the intervals in its range.

    Attributes:
        constraint: The constraint.
        inside: The intervals, shape (r,).
        where: Row of each point of each interval, shape (p, r).
        at: Path positions of the points, shape (m,).
        pieces: The piece of the path on which each is, shape (m,).
        rows: The constraint at the points.
    """

    constraint: PathConstraint
    inside: Indices
    where: Indices
    at: Array
    pieces: Indices
    rows: ConstraintRows

    @classmethod
    def of(
        cls,
        path: JointPath,
        grid: Grid,
        constraint: PathConstraint,
        shares: Sequence[float],
        known: IntervalPoints | None = None,
    ) -> IntervalPoints | None:
        """Evaluate a constraint; None: no interval is in its range.

        The end of an interval is the start of the next one of the same piece, and evaluated once.

        Args:
            path: The path.
            grid: The intervals.
            constraint: The constraint.
            shares: Where in each interval, from 0 to 1.
            known: The same constraint on another grid: at the same points it is not evaluated
                again.
        """
        s, pieces = grid.s, grid.pieces
        middle = 0.5 * (s[:-1] + s[1:])
        inside = np.flatnonzero((middle > constraint.start) & (middle < constraint.end))
        if not len(inside):
            return None
        joined = np.append(pieces[1:] == pieces[:-1], False)[inside]
        alone = inside[~joined]
        r, p = len(inside), len(shares)
        where = np.arange(p * r).reshape(p, r)
        where[-1, joined] = where[0, joined] + 1
        where[-1, ~joined] = (p - 1) * r + np.arange(len(alone))
        length = np.diff(s)[inside]
        at = np.concatenate([*(s[inside] + share * length for share in shares[:-1]), s[alone + 1]])
        of = np.concatenate([*(pieces[inside] for _ in shares[:-1]), pieces[alone]])
        if known is not None and np.array_equal(known.at, at) and np.array_equal(known.pieces, of):
            return cls(constraint, inside, where, at, of, known.rows)
        rows = constraint.at(PathPoints(at, *path.derivatives(at, of), path.length))
        return cls(constraint, inside, where, at, of, rows)

    @property
    def thrice(self) -> IntervalPoints:
        """The same at the starts, middles and ends of the intervals only."""
        return replace(self, where=self.where[:: (len(self.where) - 1) // 2])

    def ratios(self, u: Array, x: Array) -> Array:
        """Return the limit ratios at the points.

        Args:
            u: Path accelerations at the points of all intervals, shape (p, n).
            x: Squared path velocities there, shape (p, n).

        Returns:
            See ConstraintRows.ratios; shape (p, r, labels).
        """
        u, x = (values[:, self.inside].ravel() for values in (u, x))
        return self.rows.ratios(self.where.ravel(), u, x).reshape(*self.where.shape, -1)


def bend(ratios: Array) -> Array:
    """Return how far a limit's use is from straight over intervals.

    Args:
        ratios: At equally spaced points, three or five, shape (p, ...).

    Returns:
        The second difference over the interval, or four times that over either half of it,
        whichever is greatest: the same number for a parabola. Shape (...).
    """
    p = len(ratios)
    first, middle, last = ratios[0], ratios[p // 2], ratios[-1]
    whole = np.abs(first - 2.0 * middle + last)
    if p == len(COARSE):
        return np.asarray(whole)
    halves = (np.abs(first - 2.0 * ratios[1] + middle), np.abs(middle - 2.0 * ratios[3] + last))
    return np.asarray(np.maximum(whole, 4.0 * np.maximum(*halves)))


def highest(ratios: Array) -> Array:
    """Return the greatest use of a limit over intervals, between points too.

    Args:
        ratios: At equally spaced points, shape (p, ...).

    Returns:
        The greatest value at the points and of the parabolas through three neighbours each,
        shape (...).
    """
    flat = np.ascontiguousarray(ratios).reshape(len(ratios), -1)
    return highest_between(flat).reshape(ratios.shape[1:])


def parts_of(points: IntervalPoints, ratios: Array, steady: bool) -> Array:
    """Return into how many each interval should be divided to see its limits between points.

    Args:
        points: A constraint at points of intervals.
        ratios: Its ratios there, shape (p, r, labels).
        steady: Whether speeds that bind shall hardly vary between points.

    Returns:
        Numbers, >= 1, shape (r,).
    """
    bent = bend(ratios)
    near = ratios.max(axis=0) + bent > _NEAR
    most = [
        SPEED_BEND if steady and kind.endswith("speed") else BEND
        for kind, _ in points.constraint.labels
    ]
    return np.asarray(np.where(near, np.sqrt(bent / most), 1.0).max(axis=1).clip(1.0))
