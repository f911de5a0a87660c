"""How the tool's orientation goes along a curve."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.interpolate import BSpline

from ikplan.arrays import Array
from ikplan.path.curves.arc_length import ArcLength, CurvePoints
from ikplan.path.pieces.piece import dot
from ikplan.path.rotation.so3 import (
    exp,
    log,
    right_jacobian,
    right_jacobian_inverse,
    rotation_of,
)

__all__ = ["BlendTurning", "FittedTurning", "HeadingTurning", "SteadyTurning", "Turning"]


class Turning(Protocol):
    """The orientation at the points of a curve."""

    def evaluate(self, points: CurvePoints) -> tuple[Array, Array]:
        """Return rotations (m, 3, 3) and angular rates in the base (m, 3) [rad/m]."""
        ...


class SteadyTurning:
    """Turns at a constant rate in the tool frame: the shortest arc, evenly.

    Args:
        s0: Arc length at which the orientation is R0 [m].
        R0: Rotation, shape (3, 3).
        rate: Angular rate in the tool frame, shape (3,) [rad/m].
    """

    def __init__(self, s0: float, R0: Array, rate: Array) -> None:
        self._s0, self._R0, self._rate = s0, R0, rate

    def evaluate(self, points: CurvePoints) -> tuple[Array, Array]:
        """See :class:`Turning`."""
        R = self._R0 @ exp((points.s - self._s0)[:, None] * self._rate)
        return R, np.asarray(R @ self._rate)


class HeadingTurning:
    """Turns about an axis as the direction of a plane curve does.

    Args:
        curve: The curve.
        s0: Arc length at which the orientation is R0 [m].
        R0: Rotation, shape (3, 3).
        axis: Unit normal of the curve's plane, shape (3,).
    """

    def __init__(self, curve: ArcLength, s0: float, R0: Array, axis: Array) -> None:
        self._R0, self._axis = R0, axis
        self._tangents = curve.points(curve.s).v
        turns = self._angle(self._tangents[:-1], self._tangents[1:])
        # Between nodes the direction turns by far less than pi, so that full turns add up.
        self._headings = np.concatenate([[0.0], np.cumsum(turns)])
        self._zero = 0.0
        self._zero = float(self._heading(curve.points(np.array([s0])))[0])

    def _angle(self, a: Array, b: Array) -> Array:
        return np.arctan2(np.cross(a, b) @ self._axis, dot(a, b))

    def _heading(self, points: CurvePoints) -> Array:
        since = self._angle(self._tangents[points.node], points.v)
        return np.asarray(self._headings[points.node] + since - self._zero)

    def evaluate(self, points: CurvePoints) -> tuple[Array, Array]:
        """See :class:`Turning`."""
        rate = np.cross(points.v, points.bend) @ self._axis
        R = exp(self._heading(points)[:, None] * self._axis) @ self._R0
        return R, rate[:, None] * self._axis


class BlendTurning:
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
        self._A0, self._A_rate, self._B1, self._B_rate = A0, A_rate, B1, B_rate

    def evaluate(self, points: CurvePoints) -> tuple[Array, Array]:
        """See :class:`Turning`."""
        t = points.t[:, None]
        b, db = t**3 * (10.0 - 15.0 * t + 6.0 * t * t), 30.0 * (t * (1.0 - t)) ** 2
        A = self._A0 @ exp(t * self._A_rate)
        B = self._B1 @ exp((t - 1.0) * self._B_rate)
        D = np.swapaxes(A, 1, 2) @ B
        gap = log(D)
        # The tool-frame rate of D = A^T B, and from it that of its logarithm.
        rate_D = self._B_rate - np.einsum("mji,j->mi", D, self._A_rate)
        rate_gap = np.einsum("mij,mj->mi", right_jacobian_inverse(gap), rate_D)
        E = exp(b * gap)
        rate_E = np.einsum("mij,mj->mi", right_jacobian(b * gap), db * gap + b * rate_gap)
        rate = np.einsum("mji,j->mi", E, self._A_rate) + rate_E
        R = A @ E
        return R, np.einsum("mij,mj->mi", R, rate) / points.speed[:, None]


class FittedTurning:
    """Turns along a spline of quaternions over the curve's own parameter.

    Args:
        spline: A spline with seven columns, the last four of which are quaternions (x, y, z, w) of
            about unit length; or, without turning, with three.
        quaternion: Unit quaternion at the begin, shape (4,).
        turns: Whether the tool turns.
    """

    def __init__(self, spline: BSpline, quaternion: Array, *, turns: bool) -> None:
        self._spline, self._turns = spline, turns
        self._first = spline.derivative()
        self._R0 = rotation_of(quaternion)

    def evaluate(self, points: CurvePoints) -> tuple[Array, Array]:
        """See :class:`Turning`."""
        if not self._turns:
            return np.tile(self._R0, (len(points.t), 1, 1)), np.zeros((len(points.t), 3))
        q = self._spline(points.t)[:, 3:]
        dq = self._first(points.t)[:, 3:] / points.speed[:, None]
        norm = np.linalg.norm(q, axis=1)[:, None]
        q, dq = q / norm, dq / norm
        # Angular rate 2 dq q*, of which the part of dq along q adds only to the real part.
        v, w = q[:, :3], q[:, 3:]
        rate = 2.0 * (w * dq[:, :3] - dq[:, 3:] * v - np.cross(dq[:, :3], v))
        return rotation_of(q), rate
