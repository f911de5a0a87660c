"""What every piece of a tool path can do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array

__all__ = ["TURN_LENGTH", "PathDerivatives", "Piece", "Pose", "dot", "unit"]


TURN_LENGTH = 0.3
"""Path length that one radian of a turn on the spot counts for [m/rad]."""


class Pose(NamedTuple):
    """A tool pose in the robot's base.

    Attributes:
        R: Rotation of the tool, shape (3, 3); None: the orientation is free.
        p: Position of the tool, shape (3,) [m].
    """

    R: Array | None
    p: Array


class PathDerivatives(NamedTuple):
    """Poses of a path and their derivatives by the path length s, all in the robot's base.

    Attributes:
        R: Rotations, shape (m, 3, 3); the identity where the orientation is free.
        p: Positions, shape (m, 3) [m].
        v: dp/ds, shape (m, 3); of length 1 but for turns on the spot.
        w: Angular rate, d(rotation)/ds, shape (m, 3) [rad/m].
        bend: d2p/ds2, shape (m, 3) [1/m].
    """

    R: Array
    p: Array
    v: Array
    w: Array
    bend: Array


class Piece(ABC):
    """A smooth piece of a tool path, parametrised by its own length.

    Attributes:
        length: Arc length [m]; of a turn on the spot, its angle times TURN_LENGTH.
        oriented: Whether an orientation is asked for along the piece.
        turns: Whether it is a turn on the spot.
        folds: Lengths at which the curve turns back within a point, so that the motion must stop.
    """

    length: float
    oriented: bool
    turns: bool
    folds: tuple[float, ...]

    @abstractmethod
    def evaluate(self, s: Array) -> PathDerivatives:
        """Return poses and derivatives at the lengths s from the piece's begin, shape (m,) [m]."""

    @abstractmethod
    def trimmed(self, begin: float, end: float) -> Piece:
        """Return the part between two lengths, 0 <= begin < end <= length [m]."""

    @abstractmethod
    def with_turning(self, R0: Array, rate: Array) -> Piece:
        """Return the piece with an orientation that begins at R0 and turns evenly.

        Args:
            R0: Rotation at the begin, shape (3, 3).
            rate: Angular rate in the tool frame, shape (3,) [rad/m].
        """

    @abstractmethod
    def following(self, R0: Array, axis: Array) -> Piece:
        """Return the piece with an orientation that turns about ``axis`` as its direction does.

        Args:
            R0: Rotation at the begin, shape (3, 3).
            axis: Unit axis about which the direction turns, shape (3,).
        """

    def pose(self, u: float) -> tuple[Array, Array]:
        """Return rotation (3, 3) and position (3,) [m] at the fraction u of the length."""
        motion = self.evaluate(np.array([u * self.length]))
        return motion.R[0], motion.p[0]


def dot(a: Array, b: Array) -> Array:
    """Return the inner products of two stacks of vectors, shape (m,)."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


def unit(v: Array) -> Array:
    """Return vectors, shape (..., 3), scaled to length 1."""
    return np.asarray(v / np.linalg.norm(v, axis=-1)[..., None])
