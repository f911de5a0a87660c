"""How the tool turns along a piece of a path, by the words of a request."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.curves import cubic_values, natural_cubic
from ikplan.certificate.requested.rotations import exp, quaternions_of, rotations_of, unit

__all__ = ["BlendTurn", "EvenTurn", "HeadingTurn", "QuaternionSpline", "Turning"]


_SWING = 0.4
"""Farther than this from unit length, a spline of quaternions swings to and fro."""


class Turning(Protocol):
    """The orientation along a curve."""

    def turned(self, s: Array, t: Array) -> tuple[Array, Array]:
        """Return the orientation at arc lengths s [m], at which the curve's parameters are t.

        Returns:
            Rotations in the base, shape (m, 3, 3), and angular rates in the base by arc length,
            shape (m, 3) [rad/m].
        """
        ...


class EvenTurn:
    """Turns at a constant rate, in the frame of the tool, by the arc length.

    Args:
        s0: Arc length at which the rotation is R0 [m].
        R0: Rotation, shape (3, 3).
        rate: Rate in the frame of the tool, shape (3,) [rad/m].
    """

    def __init__(self, s0: float, R0: Array, rate: Array) -> None:
        self._s0, self._R0, self._rate = s0, R0, rate

    def turned(self, s: Array, t: Array) -> tuple[Array, Array]:  # noqa: ARG002 needs no parameter
        """See :class:`Turning`."""
        R = self._R0 @ exp((s - self._s0)[:, None] * self._rate)
        return R, np.asarray(R @ self._rate)


class HeadingTurn:
    """Turns about an axis by the angle that the direction of a plane curve turns.

    Args:
        arc: The curve.
        t0: Parameter at which the rotation is R0.
        R0: Rotation, shape (3, 3).
        axis: Unit normal of the plane, shape (3,).
    """

    def __init__(self, arc: ArcLength, t0: float, R0: Array, axis: Array) -> None:
        self._arc, self._R0, self._axis = arc, R0, axis
        self._nodes = self._direction(arc.t)
        steps = self._angle(self._nodes[:-1], self._nodes[1:])
        self._headings = np.concatenate([[0.0], np.cumsum(steps)])
        self._zero = float(self._heading(np.array([t0]))[0])

    def _direction(self, t: Array) -> Array:
        return unit(self._arc.curve.derivatives(t)[1])

    def _angle(self, a: Array, b: Array) -> Array:
        return np.asarray(np.arctan2(np.cross(a, b) @ self._axis, (a * b).sum(axis=1)))

    def _heading(self, t: Array) -> Array:
        nodes = self._arc.t
        k = np.clip(np.searchsorted(nodes, t, "right") - 1, 0, len(nodes) - 2)
        return np.asarray(self._headings[k] + self._angle(self._nodes[k], self._direction(t)))

    def turned(self, s: Array, t: Array) -> tuple[Array, Array]:  # noqa: ARG002 needs no length
        """See :class:`Turning`; the rate is the signed curvature about the axis."""
        R = exp((self._heading(t) - self._zero)[:, None] * self._axis) @ self._R0
        _, first, second = self._arc.curve.derivatives(t)
        speed = np.sqrt((first * first).sum(axis=1))
        rate = np.cross(first, second) @ self._axis / speed**3
        return np.asarray(R), np.asarray(rate[:, None] * self._axis)


class QuaternionSpline:
    """Leads the orientation through rotations: a natural cubic spline of unit quaternions in R^4.

    The spline is scaled back to unit length (Gawlik and Leok, Interpolation on symmetric spaces
    via the generalized polar decomposition, 2018). Its knots are the arc lengths. Where the spline
    leaves the unit sphere by more than 0.4, its knots are the shares of the length and of the
    turning added, and a monotone quintic with continuous second derivative leads from arc length
    to them.

    Args:
        s: Arc lengths of the rotations, shape (k + 1,), increasing [m].
        quaternions: Unit quaternions, shape (k + 1, 4).
    """

    def __init__(self, s: Array, quaternions: Array) -> None:
        q = np.array(quaternions)
        for k in range(1, len(q)):
            if q[k] @ q[k - 1] < 0.0:
                q[k] = -q[k]
        self._s, self._q, self._knots = s, q, s
        self._bends = natural_cubic(s, q)
        if self._farthest() > _SWING:
            angles = 2.0 * np.arccos(np.minimum((q[1:] * q[:-1]).sum(axis=1), 1.0))
            steps = np.diff(s) / (s[-1] - s[0]) + angles / angles.sum()
            self._knots = np.concatenate([[0.0], np.cumsum(steps)])
            self._bends = natural_cubic(self._knots, q)

    def _farthest(self) -> float:
        """How far the spline gets from unit length, at eighths of each span."""
        between = np.linspace(self._knots[:-1], self._knots[1:], 9).ravel()
        values = cubic_values(self._knots, self._q, self._bends, between)[0]
        return float(np.abs(lengths_of(values) - 1.0).max())

    def _warped(self, s: Array) -> tuple[Array, Array]:
        """The parameter of the spline at arc lengths, and its derivative."""
        if self._knots is self._s:
            return s, np.ones_like(s)
        h = np.diff(self._s)
        chord = np.diff(self._knots) / h
        # Harmonic means inside, the chord at the ends; no second derivative at the knots.
        inner = 2.0 * chord[1:] * chord[:-1] / (chord[1:] + chord[:-1])
        slope = np.concatenate([chord[:1], inner, chord[-1:]])
        k = np.clip(np.searchsorted(self._s, s, "right") - 1, 0, len(h) - 1)
        x = (s - self._s[k]) / h[k]
        d0, d1, step = slope[k] * h[k], slope[k + 1] * h[k], self._knots[k + 1] - self._knots[k]
        # The quintic Hermite polynomial with zero second derivatives, in powers of x.
        c3 = 10.0 * step - 6.0 * d0 - 4.0 * d1
        c4 = -15.0 * step + 8.0 * d0 + 7.0 * d1
        c5 = 6.0 * step - 3.0 * d0 - 3.0 * d1
        value = self._knots[k] + x * (d0 + x * x * (c3 + x * (c4 + x * c5)))
        rise = d0 + x * x * (3.0 * c3 + x * (4.0 * c4 + 5.0 * x * c5))
        return value, rise / h[k]

    def turned(self, s: Array, t: Array) -> tuple[Array, Array]:  # noqa: ARG002 needs no parameter
        """See :class:`Turning`; the rate is twice the vector part of dq q*."""
        at, slope = self._warped(s)
        q, dq, _ = cubic_values(self._knots, self._q, self._bends, at)
        norm = np.sqrt((q * q).sum(axis=1, keepdims=True))
        q, dq = q / norm, dq * slope[:, None] / norm
        v, w, dv, dw = q[:, :3], q[:, 3:], dq[:, :3], dq[:, 3:]
        return rotations_of(q), np.asarray(2.0 * (w * dv - dw * v - np.cross(dv, v)))


class BlendTurn:
    """Goes from one even turn to another over a parameter t in [0, 1].

    ``R(t) = A(t) exp(b(t) log(A(t)^-1 B(t)))`` with ``b = 10 t^3 - 15 t^4 + 6 t^5``, A and B
    turning evenly; evaluated by :class:`~ikplan.certificate.requested.rounded.RoundedPieces`.

    Args:
        A0: Rotation A at t = 0, shape (3, 3).
        A_rate: Its rate by t in the frame of the tool, shape (3,) [rad].
        B1: Rotation B at t = 1, shape (3, 3).
        B_rate: Its rate by t in the frame of the tool, shape (3,) [rad].

    Attributes:
        quaternions: Of A at 0 and of B at 1, each before its rate.
    """

    def __init__(self, A0: Array, A_rate: Array, B1: Array, B_rate: Array) -> None:
        a, b = quaternions_of(np.array([A0, B1]))
        self.quaternions = (a, A_rate, b, B_rate)
