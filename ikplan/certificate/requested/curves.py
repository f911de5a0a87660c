"""Curves of a request by their own formulas, over a parameter t of their own.

Each has ``breaks``, the parameters between which it is smooth, increasing; and ``derivatives(t)``:
position, first and second derivative at t, shape (m,), each of shape (m, 3) [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from ikplan.arrays import Array, lengths_of, steps_of

__all__ = ["CubicCurve", "Curve", "QuinticCurve", "RoseCurve", "SinusoidCurve", "natural_cubic"]

Derivatives = tuple[Array, Array, Array]


class Curve(Protocol):
    """A curve in the robot's base."""

    @property
    def breaks(self) -> Array:
        """Parameters between which the curve is smooth, shape (k + 1,)."""
        ...

    def derivatives(self, t: Array) -> Derivatives:
        """Return position, first and second derivative at t, shape (m,), each (m, 3) [m]."""
        ...


@dataclass(frozen=True, eq=False)
class _InFrame:
    """A plane curve in a frame that is given in the base.

    Attributes:
        R: Rotation of the frame, shape (3, 3).
        origin: Origin of the frame, shape (3,) [m].
    """

    R: Array
    origin: Array

    def _in_base(self, x: Derivatives, y: Derivatives) -> Derivatives:
        p, first, second = (
            a[:, None] * self.R[:, 0] + b[:, None] * self.R[:, 1] for a, b in zip(x, y, strict=True)
        )
        return self.origin + p, first, second


@dataclass(frozen=True, eq=False)
class SinusoidCurve(_InFrame):
    """``(x, amplitude sin(2 pi x / wavelength + phase), 0)``, x from 0 to length."""

    length: float
    amplitude: float
    wavelength: float
    phase: float

    @cached_property
    def breaks(self) -> Array:
        """See :class:`Curve`: eighths of a period."""
        return np.linspace(0.0, self.length, math.ceil(8.0 * self.length / self.wavelength) + 1)

    def derivatives(self, t: Array) -> Derivatives:
        """See :class:`Curve`."""
        rate = 2.0 * math.pi / self.wavelength
        sine = self.amplitude * np.sin(rate * t + self.phase)
        cosine = self.amplitude * np.cos(rate * t + self.phase)
        x = (t, np.ones_like(t), np.zeros_like(t))
        return self._in_base(x, (sine, rate * cosine, -rate * rate * sine))


@dataclass(frozen=True, eq=False)
class RoseCurve(_InFrame):
    """``radius cos(petals b) (cos b, sin b, 0)``, b = phase + angle t, t from 0 to 1.

    By the product formulas this is the sum of two circular motions,
    ``radius / 2 (cos((petals + 1) b) + cos((petals - 1) b), sin(...) - sin(...))``.
    """

    radius: float
    petals: int
    phase: float
    angle: float

    @cached_property
    def breaks(self) -> Array:
        """See :class:`Curve`: an eighth of the faster circular motion at most."""
        turns = (self.petals + 1) * abs(self.angle) / (2.0 * math.pi)
        return np.linspace(0.0, 1.0, math.ceil(8.0 * turns) + 1)

    def derivatives(self, t: Array) -> Derivatives:
        """See :class:`Curve`."""
        b = self.phase + self.angle * t
        x, y = np.zeros((3, len(t))), np.zeros((3, len(t)))
        for rate, sign in ((self.petals + 1.0, 1.0), (self.petals - 1.0, -1.0)):
            c, s = 0.5 * self.radius * np.cos(rate * b), 0.5 * self.radius * np.sin(rate * b)
            w = rate * self.angle
            x += np.stack([c, -w * s, -w * w * c])
            y += sign * np.stack([s, w * c, -w * w * s])
        return self._in_base((x[0], x[1], x[2]), (y[0], y[1], y[2]))


class CubicCurve:
    """The natural cubic spline through points over their chord length.

    Args:
        points: Points, shape (k + 1, 3), neighbours distinct [m].
    """

    def __init__(self, points: Array) -> None:
        self.breaks: Array = np.concatenate([[0.0], np.cumsum(lengths_of(steps_of(points)))])
        self._points, self._bends = points, natural_cubic(self.breaks, points)

    def derivatives(self, t: Array) -> Derivatives:
        """See :class:`Curve`."""
        return cubic_values(self.breaks, self._points, self._bends, t)


class QuinticCurve:
    """The quintic over [0, 1] with given position and derivatives at both ends (Hermite).

    Args:
        begin: Position, first and second derivative at 0, shape (3, 3) [m].
        end: The same at 1.

    Attributes:
        powers: Coefficients, lowest power first, shape (6, 3) [m].
    """

    breaks: Array = np.linspace(0.0, 1.0, 9)

    def __init__(self, begin: Array, end: Array) -> None:
        p, v, a = begin
        step, dv, da = end[0] - p - v - 0.5 * a, end[1] - v - a, end[2] - a
        self.powers: Array = np.array(
            [
                p,
                v,
                0.5 * a,
                10.0 * step - 4.0 * dv + 0.5 * da,
                -15.0 * step + 7.0 * dv - da,
                6.0 * step - 3.0 * dv + 0.5 * da,
            ]
        )

    @property
    def control_points(self) -> Array:
        """Points whose convex hull holds the curve: its Bernstein coefficients, shape (6, 3)."""
        weights = np.array(
            [
                [math.comb(i, j) / math.comb(5, j) if j <= i else 0.0 for j in range(6)]
                for i in range(6)
            ]
        )
        return np.asarray(weights @ self.powers)

    def derivatives(self, t: Array) -> Derivatives:
        """See :class:`Curve`."""
        powers = t[:, None] ** np.arange(6)
        n = np.arange(6.0)[:, None]
        first, second = (n * self.powers)[1:], (n * (n - 1.0) * self.powers)[2:]
        return powers @ self.powers, powers[:, :5] @ first, powers[:, :4] @ second


def natural_cubic(knots: Array, values: Array) -> Array:
    """Return the second derivatives at the knots of the natural cubic spline, as ``values``.

    The three-moment equations, by elimination from the first row to the last (de Boor, A
    Practical Guide to Splines, chapter IV).

    Args:
        knots: Knots, shape (k + 1,), increasing, k >= 2.
        values: Values at them, shape (k + 1, n).
    """
    h = np.diff(knots)
    bends = np.zeros_like(values)
    slopes = np.diff(values, axis=0) / h[:, None]
    right = 6.0 * np.diff(slopes, axis=0)
    diagonal = 2.0 * (h[1:] + h[:-1])
    for i in range(1, len(diagonal)):
        factor = h[i] / diagonal[i - 1]
        diagonal[i] -= factor * h[i]
        right[i] -= factor * right[i - 1]
    bends[-2] = right[-1] / diagonal[-1]
    for i in range(len(diagonal) - 2, -1, -1):
        bends[i + 1] = (right[i] - h[i + 1] * bends[i + 2]) / diagonal[i]
    return bends


def cubic_values(knots: Array, values: Array, bends: Array, t: Array) -> Derivatives:
    """Return a cubic spline and two derivatives at t, given second derivatives at its knots."""
    k = np.clip(np.searchsorted(knots, t, "right") - 1, 0, len(knots) - 2)
    h = (knots[k + 1] - knots[k])[:, None]
    a = (knots[k + 1] - t)[:, None] / h
    b = 1.0 - a
    y0, y1, m0, m1 = values[k], values[k + 1], bends[k], bends[k + 1]
    p = a * y0 + b * y1 + ((a**3 - a) * m0 + (b**3 - b) * m1) * (h * h / 6.0)
    first = (y1 - y0) / h + ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0) * (h / 6.0)
    return p, first, a * m0 + b * m1
