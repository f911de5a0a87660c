"""Pieces of constant curvature, torsion and angular rate: lines, arcs, helices, turns.

One formula serves all. The direction turns in a plane at the constant rate k, and a constant
climb is added::

    p(s) = p0 + h (t sin(k s) + n (1 - cos(k s))) / k + c s
    R(s) = R0 exp(s w)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.path.pieces.piece import TURN_LENGTH, PathDerivatives, Piece
from ikplan.path.pieces.piece_kernels import empty_rows, scratch, steady_rows
from ikplan.path.pieces.steady_kernels import SteadyStack

__all__ = ["SteadyPiece", "line", "stack_steady"]


_ON_THE_SPOT = 1e-6
"""A derivatives shorter than this [m] that turns by more counts as a turn."""


@dataclass(frozen=True)
class SteadyPiece(Piece):
    """A line, an arc, a helix or a turn on the spot.

    Attributes:
        p0: First point in the base, shape (3,) [m].
        t: Unit direction of the first tangent's part in the plane of turning, shape (3,).
        n: Unit direction towards the centre, shape (3,).
        c: Climb per length, across the plane, shape (3,).
        h: Length of the tangent's part in the plane; h^2 + |c|^2 = 1 but for turns.
        k: Rate at which the direction turns from t to n [rad/m].
        length: Length [m].
        R0: Rotation at the begin, shape (3, 3).
        w: Angular rate in the tool frame, shape (3,) [rad/m].
        oriented: Whether the orientation counts.
        turns: Whether it is a turn on the spot.
    """

    p0: Array
    t: Array
    n: Array
    c: Array
    h: float
    k: float
    length: float
    R0: Array
    w: Array
    oriented: bool = False
    turns: bool = False
    folds: tuple[float, ...] = ()

    @cached_property
    def _stack(self) -> SteadyStack:
        return stack_steady([self])

    def evaluate(self, s: Array) -> PathDerivatives:
        """Return poses and derivatives; see :meth:`Piece.evaluate`."""
        out = empty_rows(len(s))
        row = np.zeros(len(s), dtype=np.int64)
        steady_rows(self._stack, row, np.ascontiguousarray(s, dtype=np.float64), out, scratch())
        return PathDerivatives(*out)

    def trimmed(self, begin: float, end: float) -> SteadyPiece:
        """Return a part; see :meth:`Piece.trimmed`."""
        if begin == 0.0:
            return replace(self, length=end)
        derivatives = self.evaluate(np.array([begin]))
        sine, cosine = math.sin(self.k * begin), math.cos(self.k * begin)
        return replace(
            self,
            p0=derivatives.p[0],
            t=cosine * self.t + sine * self.n,
            n=cosine * self.n - sine * self.t,
            length=end - begin,
            R0=derivatives.R[0],
        )

    def with_turning(self, R0: Array, rate: Array) -> SteadyPiece:
        """Return an oriented copy; see :meth:`Piece.with_turning`."""
        return replace(self, R0=R0, w=rate, oriented=True)

    def following(self, R0: Array, axis: Array) -> SteadyPiece:
        """Return an oriented copy; see :meth:`Piece.following`."""
        sense = 1.0 if float(axis @ np.cross(self.t, self.n)) > 0.0 else -1.0
        return self.with_turning(R0, sense * self.k * (R0.T @ axis))


def stack_steady(pieces: Sequence[SteadyPiece]) -> SteadyStack:
    """Return pieces as flat arrays."""
    n = len(pieces)
    return SteadyStack(
        np.array([a.p0 for a in pieces], dtype=np.float64).reshape(n, 3),
        np.array([a.t for a in pieces], dtype=np.float64).reshape(n, 3),
        np.array([a.n for a in pieces], dtype=np.float64).reshape(n, 3),
        np.array([a.c for a in pieces], dtype=np.float64).reshape(n, 3),
        np.array([a.h for a in pieces], dtype=np.float64),
        np.array([a.k for a in pieces], dtype=np.float64),
        np.array([a.R0 for a in pieces], dtype=np.float64).reshape(n, 3, 3),
        np.array([a.w for a in pieces], dtype=np.float64).reshape(n, 3),
    )


def line(p0: Array, p1: Array, R0: Array | None = None, rotvec: Array | None = None) -> SteadyPiece:
    """Return the line from p0 to p1, or the turn on the spot where they are one point.

    Args:
        p0: First point, shape (3,) [m].
        p1: Last point, shape (3,) [m].
        R0: Rotation at the begin, shape (3, 3); None: the orientation is free.
        rotvec: Turn over the whole piece in the tool frame, shape (3,) [rad]; None: none.

    Returns:
        The piece. Its length is the distance, or, where the tool moves by less than a micrometre
        and less than it turns, the angle times TURN_LENGTH.
    """
    step = p1 - p0
    distance = length_of(step)
    rotvec = np.zeros(3) if rotvec is None else rotvec
    turn = TURN_LENGTH * length_of(rotvec)
    turns = distance <= _ON_THE_SPOT and turn > distance
    length = turn if turns else distance
    scale = 1.0 / length if length > 0.0 else 0.0
    zero = np.zeros(3)
    return SteadyPiece(
        p0=p0,
        t=step * scale,
        n=zero,
        c=zero,
        h=1.0,
        k=0.0,
        length=length,
        R0=np.eye(3) if R0 is None else R0,
        w=zero if R0 is None else rotvec * scale,
        oriented=R0 is not None,
        turns=turns,
    )
