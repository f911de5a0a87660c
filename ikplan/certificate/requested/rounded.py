"""Rounded corners: the quintics, and all those of a path evaluated together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.curves import QuinticCurve
from ikplan.certificate.requested.rounded_kernels import (
    TURN,
    RoundedStack,
    nearest_parameter,
    quintic_nodes,
    rounded_rows,
)
from ikplan.certificate.requested.turning import BlendTurn

__all__ = ["QuinticArc", "RoundedPiece", "RoundedPieces"]


class QuinticArc(ArcLength):
    """The arc length of a quintic, with nodes found by a kernel.

    Args:
        curve: The quintic.
    """

    def __init__(self, curve: QuinticCurve) -> None:
        self.curve, self.powers = curve, curve.powers
        self.t, self.s = quintic_nodes(self.powers, len(curve.breaks) - 1)
        self.length = float(self.s[-1])

    def nearest(self, point: Array) -> float:
        """Return the length at which the curve is nearest to a point, shape (3,) [m]."""
        t = nearest_parameter(self.powers, np.ascontiguousarray(point))
        return float(self.at(np.array([t]))[0])


@dataclass(frozen=True, eq=False)
class RoundedPiece:
    """A rounded corner as a piece of a path.

    Attributes:
        arc: The curve.
        turn: How the tool turns; None: free.
        spot: Whether it is a turn on the spot; it is none.
    """

    arc: QuinticArc
    turn: BlendTurn | None
    spot: bool = False

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.arc.length

    @property
    def oriented(self) -> bool:
        """Whether an orientation is asked for."""
        return self.turn is not None

    @property
    def nodes(self) -> Array:
        """Lengths between which the curve is smooth and alike, shape (k,) [m]."""
        return self.arc.s[1:-1]


class RoundedPieces:
    """Rounded corners, evaluated together.

    Args:
        corners: The corners.
    """

    def __init__(self, corners: Sequence[RoundedPiece]) -> None:
        arcs = [corner.arc for corner in corners]
        turns = np.zeros((len(corners), TURN))
        for k, corner in enumerate(corners):
            if corner.turn is not None:
                turns[k] = np.concatenate([[1.0], *corner.turn.quaternions])
        self._stack = RoundedStack(
            np.array([arc.powers for arc in arcs]).reshape(-1, 6, 3),
            turns,
            np.cumsum([0, *(len(arc.t) for arc in arcs)]),
            np.concatenate([np.zeros(0), *(arc.t for arc in arcs)]),
            np.concatenate([np.zeros(0), *(arc.s for arc in arcs)]),
        )

    def derivatives(self, corner: Indices, s: Array) -> tuple[Array, Array, Array, Array]:
        """Return corners at lengths s from their begins.

        Args:
            corner: Indices of corners, shape (m,).
            s: Lengths, shape (m,) [m].

        Returns:
            As :meth:`~ikplan.certificate.requested.pieces.CurvePiece.derivatives`.
        """
        m = len(s)
        R, p, v, w = np.empty((m, 3, 3)), np.empty((m, 3)), np.empty((m, 3)), np.empty((m, 3))
        rounded_rows(self._stack, corner, np.ascontiguousarray(s), R, p, v, w)
        return R, p, v, w
