"""Curves in a parameter of their own, to be run through by arc length."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.natural_spline import NaturalSpline
from ikplan.path.curves.shape_kernels import (
    COEFFICIENTS,
    CUBIC,
    NUMBERS,
    QUINTIC,
    ROSE,
    SINUSOID,
    shape_rows,
)

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = [
    "CubicShape",
    "FittedShape",
    "QuinticShape",
    "RoseShape",
    "Shape",
    "SinusoidShape",
    "powers_of",
]


class Shape:
    """A curve in the base, twice continuously differentiable between and at its breaks.

    Attributes:
        kind: What kind it is, for :func:`~ikplan.path.curves.shape_kernels.shape_into`.
        breaks: Increasing parameters, shape (k,), k >= 2: the ends, and between them places such
            that the parts are smooth and none is more than about a quarter of a period.
        numbers: What the formula needs, shape (NUMBERS,).
        begins: Parameter at which each span of the formula begins, shape (b,).
        rows: Coefficients of each span, shape (b, COEFFICIENTS, 3).
    """

    def __init__(
        self,
        kind: int,
        breaks: Array,
        numbers: Array | None = None,
        rows: Array | None = None,
    ) -> None:
        self.kind, self.breaks = kind, breaks
        self.numbers = np.zeros(NUMBERS) if numbers is None else numbers
        self.rows = np.zeros((1, COEFFICIENTS, 3)) if rows is None else rows
        self.begins = breaks[:-1] if len(self.rows) > 1 else breaks[:1]

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """Return position [m] and its first two derivatives by t, each of shape (m, 3)."""
        end = float(self.breaks[-1])
        p, first, second = shape_rows(self.kind, self.numbers, self.begins, self.rows, end, t)
        return p, first, second


def _cubic_rows(coefficients: Array, last: Array) -> Array:
    """Rows of a cubic spline with the coefficients (4, b, 3), highest power first, and its end."""
    rows = np.zeros((coefficients.shape[1], COEFFICIENTS, 3))
    rows[:, :4] = np.swapaxes(coefficients, 0, 1)
    rows[-1, 4] = last
    return rows


class CubicShape(Shape):
    """The natural cubic spline through points, over their chord lengths.

    Chord lengths as knots give the interpolant of fourth order and no loops where the distances
    differ (Floater, Chordal cubic spline interpolation is fourth-order accurate, 2006).

    Args:
        points: Points passed, shape (k, 3), k >= 2, neighbours distinct [m].
    """

    def __init__(self, points: Array) -> None:
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        breaks: Array = np.concatenate([[0.0], np.cumsum(chords)])
        rows = _cubic_rows(NaturalSpline(breaks, points).c, points[-1])
        super().__init__(CUBIC, breaks, rows=rows)


class FittedShape(Shape):
    """A cubic spline that is given.

    Args:
        spline: The spline; its first three columns are positions [m].
    """

    def __init__(self, spline: BSpline) -> None:
        breaks, coefficients = powers_of(spline)
        rows = _cubic_rows(coefficients[:, :, :3], np.asarray(spline(breaks[-1]))[:3])
        super().__init__(CUBIC, breaks, rows=rows)


def powers_of(spline: BSpline) -> tuple[Array, Array]:
    """Return the distinct knots (b + 1,) of a cubic spline, and its coefficients by powers.

    Returns:
        The knots, and coefficients since the knot before, highest power first, (4, b, columns).
    """
    knots = np.unique(spline.t)
    orders = [np.asarray(spline(knots[:-1], order)) for order in range(4)]
    return knots, np.array([orders[3] / 6.0, orders[2] / 2.0, orders[1], orders[0]])


class QuinticShape(Shape):
    """The quintic over [0, 1] with given positions and derivatives at both ends.

    Args:
        begin: Position, first and second derivative at 0, shape (3, 3) [m].
        end: The same at 1.

    Attributes:
        control_points: Points whose convex hull holds the curve, shape (6, 3) [m].
    """

    def __init__(self, begin: Array, end: Array) -> None:
        (p0, v0, a0), (p1, v1, a1) = begin, end
        self.control_points: Array = np.array(
            [
                p0,
                p0 + v0 / 5.0,
                p0 + 2.0 * v0 / 5.0 + a0 / 20.0,
                p1 - 2.0 * v1 / 5.0 + a1 / 20.0,
                p1 - v1 / 5.0,
                p1,
            ]
        )
        super().__init__(QUINTIC, np.linspace(0.0, 1.0, 5), rows=self.control_points[None])


def _plane_numbers(origin: Array, R: Array, *parameters: float) -> Array:
    """Numbers of a curve (x(t), y(t), 0) of a frame with an origin and a rotation in the base."""
    numbers = np.zeros(NUMBERS)
    numbers[:3], numbers[3:9] = origin, R[:, :2].ravel()
    numbers[9 : 9 + len(parameters)] = parameters
    return numbers


class SinusoidShape(Shape):
    """``(x, amplitude sin(2 pi x / wavelength + phase), 0)``, x from 0 to ``length``.

    Args:
        origin: Origin of its frame, shape (3,) [m].
        R: Rotation of its frame in the base, shape (3, 3).
        length: Length along x [m].
        amplitude: Amplitude along y [m].
        wavelength: Length of a period [m].
        phase: Phase at x = 0 [rad].
    """

    def __init__(
        self,
        origin: Array,
        R: Array,
        length: float,
        amplitude: float,
        wavelength: float,
        phase: float,
    ) -> None:
        breaks = np.linspace(0.0, length, math.ceil(4.0 * length / wavelength) + 1)
        rate = 2.0 * math.pi / wavelength
        super().__init__(SINUSOID, breaks, _plane_numbers(origin, R, amplitude, rate, phase))


class RoseShape(Shape):
    """``(rho cos b, rho sin b, 0)``, ``rho = radius cos(petals b)``, b from phase on by angle.

    Args:
        origin: Origin of its frame, shape (3,) [m].
        R: Rotation of its frame in the base, shape (3, 3).
        radius: Length of a petal [m].
        petals: How many times the radius comes and goes in a turn.
        phase: First angle [rad].
        angle: Angle swept, signed [rad].
    """

    def __init__(
        self, origin: Array, R: Array, radius: float, petals: int, phase: float, angle: float
    ) -> None:
        quarters = 4.0 * (petals + 1) * abs(angle) / (2.0 * math.pi)
        breaks = np.linspace(0.0, 1.0, math.ceil(quarters) + 1)
        numbers = _plane_numbers(origin, R, radius, petals, phase, angle)
        super().__init__(ROSE, breaks, numbers)
