"""Curves in a parameter of their own, to be run through by arc length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.natural_spline import natural_spline

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = ["CubicShape", "FittedShape", "QuinticShape", "RoseShape", "Shape", "SinusoidShape"]


class Shape(Protocol):
    """A curve in the base, twice continuously differentiable between and at its breaks."""

    @property
    def breaks(self) -> Array:
        """Increasing parameters, shape (k,), k >= 2: the ends, and between them places such that
        the parts are smooth and none is more than about a quarter of a period.
        """  # noqa: D205
        ...

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """Return position [m] and its first two derivatives by t, each of shape (m, 3)."""
        ...


class CubicShape:
    """The natural cubic spline through points, over their chord lengths.

    Chord lengths as knots give the interpolant of fourth order and no loops where the distances
    differ (Floater, Chordal cubic spline interpolation is fourth-order accurate, 2006).

    Args:
        points: Points passed, shape (k, 3), k >= 2, neighbours distinct [m].
    """

    def __init__(self, points: Array) -> None:
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        self.breaks: Array = np.concatenate([[0.0], np.cumsum(chords)])
        spline = natural_spline(self.breaks, points)
        self._coefficients: Array = np.asarray(spline.c)
        self._last = points[-1]

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """See :class:`Shape`."""
        span = np.clip(np.searchsorted(self.breaks, t, "right") - 1, 0, len(self.breaks) - 2)
        x = (t - self.breaks[span])[:, None]
        c3, c2, c1, c0 = self._coefficients[:, span]
        p = ((c3 * x + c2) * x + c1) * x + c0
        p[t == self.breaks[-1]] = self._last
        return p, (3.0 * c3 * x + 2.0 * c2) * x + c1, 6.0 * c3 * x + 2.0 * c2


class FittedShape:
    """A cubic spline that is given.

    Args:
        spline: The spline; its first three columns are positions [m].
    """

    def __init__(self, spline: BSpline) -> None:
        self.breaks: Array = np.unique(spline.t)
        self._orders = (spline, spline.derivative(), spline.derivative(2))

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """See :class:`Shape`."""
        p, first, second = (np.asarray(order(t))[:, :3] for order in self._orders)
        return p, first, second


class QuinticShape:
    """The quintic over [0, 1] with given positions and derivatives at both ends.

    Args:
        begin: Position, first and second derivative at 0, shape (3, 3) [m].
        end: The same at 1.
    """

    breaks: Array = np.linspace(0.0, 1.0, 5)

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

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """See :class:`Shape`."""
        b = self.control_points
        first, second = 5.0 * np.diff(b, axis=0), 20.0 * np.diff(b, n=2, axis=0)
        return _bernstein(b, t), _bernstein(first, t), _bernstein(second, t)


def _bernstein(control_points: Array, t: Array) -> Array:
    n = len(control_points) - 1
    weights = np.array([math.comb(n, i) * t**i * (1.0 - t) ** (n - i) for i in range(n + 1)])
    return np.asarray(weights.T @ control_points)


@dataclass(frozen=True)
class _InPlane:
    """A curve (x(t), y(t), 0) of a frame whose origin and rotation in the base are given."""

    origin: Array
    R: Array

    def _in_base(self, xy: list[tuple[Array, Array]]) -> tuple[Array, Array, Array]:
        axes = self.R[:, :2].T
        p, dp, ddp = (np.stack(pair, axis=1) @ axes for pair in xy)
        return p + self.origin, dp, ddp


@dataclass(frozen=True)
class SinusoidShape(_InPlane):
    """``(x, amplitude sin(2 pi x / wavelength + phase), 0)``, x from 0 to ``length``."""

    length: float
    amplitude: float
    wavelength: float
    phase: float

    @property
    def breaks(self) -> Array:
        """See :class:`Shape`."""
        return np.linspace(0.0, self.length, math.ceil(4.0 * self.length / self.wavelength) + 1)

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """See :class:`Shape`."""
        k = 2.0 * math.pi / self.wavelength
        y, dy = np.sin(k * t + self.phase), np.cos(k * t + self.phase)
        A, one, nil = self.amplitude, np.ones_like(t), np.zeros_like(t)
        return self._in_base([(t, A * y), (one, A * k * dy), (nil, -A * k * k * y)])


@dataclass(frozen=True)
class RoseShape(_InPlane):
    """``(rho cos b, rho sin b, 0)``, ``rho = radius cos(petals b)``, b from phase on by angle."""

    radius: float
    petals: int
    phase: float
    angle: float

    @property
    def breaks(self) -> Array:
        """See :class:`Shape`."""
        quarters = 4.0 * (self.petals + 1) * abs(self.angle) / (2.0 * math.pi)
        return np.linspace(0.0, 1.0, math.ceil(quarters) + 1)

    def derivatives(self, t: Array) -> tuple[Array, Array, Array]:
        """See :class:`Shape`."""
        b, g, k = self.phase + self.angle * t, self.angle, self.petals
        rho = self.radius * np.cos(k * b)
        drho = -self.radius * k * np.sin(k * b)
        ddrho = -k * k * rho
        c, s = np.cos(b), np.sin(b)
        first = (g * (drho * c - rho * s), g * (drho * s + rho * c))
        second = (
            g * g * ((ddrho - rho) * c - 2.0 * drho * s),
            g * g * ((ddrho - rho) * s + 2.0 * drho * c),
        )
        return self._in_base([(rho * c, rho * s), first, second])
