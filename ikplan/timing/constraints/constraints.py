"""Limits on the motion other than those of single joints: the seam they are given through."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from ikplan.arrays import Array, Indices

__all__ = [
    "BEND",
    "MARGIN",
    "SPEED_BEND",
    "SPEED_MARGIN",
    "ConstraintRows",
    "Label",
    "PathConstraint",
    "PathPoints",
]

Label = tuple[str, str | None]

# These limits are looked at in points of every interval and allowed for between them; they are
# kept by this share. BEND is how far they may be from straight over an interval where they nearly
# bind: intervals are divided until they are. Speeds are held to less, so that a tool led along a
# line at its limit has one speed.
MARGIN, SPEED_MARGIN = 5e-4, 1e-6
BEND, SPEED_BEND = 2e-3, 4e-6


@dataclass(frozen=True, eq=False)
class PathPoints:
    """Points of a path.

    Attributes:
        s: Path positions, shape (m,).
        q: Joint positions, shape (m, dof).
        qs: dq/ds, shape (m, dof).
        qss: d2q/ds2, shape (m, dof).
        length: Length of the whole path.
    """

    s: Array
    q: Array
    qs: Array
    qss: Array
    length: float


@dataclass(frozen=True, eq=False)
class ConstraintRows:
    """A limit at points of a path: rows a u + b x <= 1 that rest keeps, and bounds x <= x_max.

    Attributes:
        columns: Number of rows a point.
        coefficients: For indices of points, shape (p,): coefficients of the path acceleration u
            and of the squared path velocity x, each of shape (p, columns).
        x_max: Upper bounds of x, shape (m,).
        ratios: For indices of points, u and x, each of shape (p,): the ratio to each limit, by
            which u and x would have to be divided to keep it, shape (p, labels).
    """

    columns: int
    coefficients: Callable[[Indices], tuple[Array, Array]]
    x_max: Array
    ratios: Callable[[Indices, Array, Array], Array]


class PathConstraint(Protocol):
    """A limit on a range of a path."""

    @property
    def start(self) -> float:
        """Where the range begins, as a path position s."""
        ...

    @property
    def end(self) -> float:
        """Where the range ends."""
        ...

    @property
    def labels(self) -> tuple[Label, ...]:
        """Kind and joint of each limit, in the order of the columns of ratios."""
        ...

    def at(self, points: PathPoints) -> ConstraintRows:
        """Write the limit at points of a path.

        Args:
            points: Points inside the range.

        Raises:
            TimingFailed: Not even rest keeps the limit somewhere.
        """
        ...

    def ratio(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return the limit ratio of joint motions.

        Args:
            q: Joint positions, shape (m, dof) [rad or m].
            dq: Joint velocities, shape (m, dof).
            ddq: Joint accelerations, shape (m, dof).

        Returns:
            Up to 1 where the limit is kept; else the square of the factor of time by which the
            motion would have to be slowed, shape (m,).

        Raises:
            TimingFailed: Not even rest keeps the limit at one of them.
        """
        ...

    def scaled(self, label: Label, factor: float) -> PathConstraint:
        """Return the constraint with one of its limits multiplied.

        Args:
            label: Which limit.
            factor: The factor.
        """
        ...
