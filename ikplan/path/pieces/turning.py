"""How the tool's orientation goes along a curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.shapes import powers_of
from ikplan.path.pieces.piece import dot
from ikplan.path.pieces.piece_kernels import CurvedStack, curved_rows, empty_rows, scratch
from ikplan.path.pieces.turning_kernels import (
    BLEND,
    BY_PARAMETER,
    EVEN,
    HEADING,
    NUMBERS,
    ROW,
    TurnStack,
)
from ikplan.path.rotation.so3 import rotation_of

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = [
    "BlendTurning",
    "FittedTurning",
    "HeadingTurning",
    "SteadyTurning",
    "Turning",
    "quaternion_rows",
    "stack_turnings",
]


class Turning:
    """The orientation at the points of a curve, by a law that a kernel evaluates.

    Attributes:
        stack: The law as a stack of one.
    """

    def __init__(
        self,
        kind: int,
        numbers: Array,
        knots: Array | None = None,
        rows: Array | None = None,
        warp_knots: Array | None = None,
        warp: Array | None = None,
    ) -> None:
        count = 0 if knots is None else len(knots)
        filled = np.zeros(NUMBERS)
        filled[: len(numbers)] = numbers
        self.stack = TurnStack(
            np.array([kind]),
            filled[None],
            np.array([0, count]),
            np.zeros(0) if knots is None else knots,
            np.zeros((0, ROW)) if rows is None else rows,
            np.zeros(count) if warp_knots is None else warp_knots,
            np.zeros((count, 6)) if warp is None else warp,
        )


def stack_turnings(turnings: Sequence[Turning]) -> TurnStack:
    """Return laws as flat arrays."""
    if len(turnings) == 1:
        return turnings[0].stack
    stacks = [turning.stack for turning in turnings]
    if not stacks:
        return _NO_LAW
    rows = np.cumsum([0, *(len(a.knots) for a in stacks)])
    joined = {
        name: np.concatenate([getattr(a, name) for a in stacks])
        for name in TurnStack._fields
        if name != "first"
    }
    return TurnStack(first=rows, **joined)


_NO_LAW = Turning(EVEN, np.zeros(0)).stack
"""What stands for the laws of pieces that leave the orientation free."""


class SteadyTurning(Turning):
    """Turns at a constant rate in the tool frame: the shortest arc, evenly.

    Args:
        s0: Arc length at which the orientation is R0 [m].
        R0: Rotation, shape (3, 3).
        rate: Angular rate in the tool frame, shape (3,) [rad/m].
    """

    def __init__(self, s0: float, R0: Array, rate: Array) -> None:
        super().__init__(EVEN, np.concatenate([[s0], R0.ravel(), rate]))


class HeadingTurning(Turning):
    """Turns about an axis as the direction of a plane curve does.

    Args:
        curve: The curve.
        s0: Arc length at which the orientation is R0 [m].
        R0: Rotation, shape (3, 3).
        axis: Unit normal of the curve's plane, shape (3,).
    """

    def __init__(self, curve: ArcLength, s0: float, R0: Array, axis: Array) -> None:
        tangents = _tangents(curve, np.append(curve.s, s0))
        at_nodes, at_begin = tangents[:-1], tangents[-1:]
        # Between nodes the direction turns by far less than pi, so that full turns add up.
        turns = _angle(at_nodes[:-1], at_nodes[1:], axis)
        headings = np.concatenate([[0.0], np.cumsum(turns)])
        node = int(np.clip(np.searchsorted(curve.s, s0, "right") - 1, 0, len(curve.s) - 2))
        zero = headings[node] + _angle(at_nodes[[node]], at_begin, axis)
        rows = np.zeros((len(curve.s), ROW))
        rows[:, 0], rows[:, 1:4] = headings, at_nodes
        super().__init__(HEADING, np.concatenate([R0.ravel(), axis, zero]), curve.s, rows)


def _tangents(curve: ArcLength, s: Array) -> Array:
    out, row = empty_rows(len(s)), np.zeros(len(s), dtype=np.int64)
    free = CurvedStack(np.zeros(1, dtype=np.int64), np.zeros(1), np.array([-1]))
    curved_rows(curve.stack, stack_turnings([]), free, row, s, out, scratch())
    return out.v


def _angle(a: Array, b: Array, axis: Array) -> Array:
    """Angles about an axis from directions a to b, shape (m, 3) -> (m,) [rad]."""
    return np.asarray(np.arctan2(np.cross(a, b) @ axis, dot(a, b)))


class BlendTurning(Turning):
    """Goes over from one steady turning to another, over the curve's own parameter t in [0, 1].

    ``R(t) = A(t) exp(b(t) log(A(t)^T B(t)))`` with the smoothstep ``b = t^3 (10 - 15 t + 6 t^2)``:
    rotation, rate and acceleration are those of A at 0 and of B at 1.

    Args:
        A0: Rotation at t = 0, shape (3, 3).
        A_rate: Its rate by t, in the tool frame, shape (3,) [rad].
        B1: Rotation at t = 1, shape (3, 3).
        B_rate: Its rate by t, in the tool frame, shape (3,) [rad].
    """

    def __init__(self, A0: Array, A_rate: Array, B1: Array, B_rate: Array) -> None:
        super().__init__(BLEND, np.concatenate([A0.ravel(), A_rate, B1.ravel(), B_rate]))


class FittedTurning(Turning):
    """Turns along a spline of quaternions over the curve's own parameter.

    Args:
        spline: A spline with seven columns, the last four of which are quaternions (x, y, z, w) of
            about unit length; or, without turning, with three.
        quaternion: Unit quaternion at the begin, shape (4,).
        turns: Whether the tool turns.
    """

    def __init__(self, spline: BSpline, quaternion: Array, *, turns: bool) -> None:
        if turns:
            knots, coefficients = powers_of(spline)
            super().__init__(
                BY_PARAMETER, np.zeros(1), knots, quaternion_rows(coefficients[:, :, 3:])
            )
        else:
            numbers = np.concatenate([[0.0], rotation_of(quaternion).ravel()])
            super().__init__(EVEN, numbers)


def quaternion_rows(coefficients: Array) -> Array:
    """Rows of a spline of quaternions with coefficients (4, b, 4), and an empty one at its end."""
    rows = np.swapaxes(coefficients, 0, 1).reshape(-1, ROW)
    return np.vstack([rows, np.zeros((1, ROW))])
