"""Curves run through by their arc length."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.path.curves.shapes import Shape
from ikplan.path.pieces.piece import dot

__all__ = ["ArcLength", "CurvePoints"]


_X, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_TO_POWERS = np.linalg.inv(np.vander(_X, increasing=True))
"""From values at the Gauss points of [-1, 1] to the coefficients of the polynomial through them."""
_CHECKS = np.array([-1.0, -0.52, 0.07, 0.61, 1.0])
"""Where that polynomial is held to the speed: between Gauss points and at the ends."""
_FIT = 1e-10
"""Error of the speed allowed, as a share of it."""
_POINT = 1e-10
"""An interval shorter than this share of the length counts as a point."""
_LEVELS = 60


class CurvePoints(NamedTuple):
    """Points of a curve.

    Attributes:
        s: Arc lengths, shape (m,) [m].
        t: The curve's own parameter, shape (m,).
        node: Index of the last node before the point, shape (m,).
        p: Positions, shape (m, 3) [m].
        v: Unit tangents, shape (m, 3).
        bend: Curvature vectors, shape (m, 3) [1/m].
        speed: |dp/dt|, shape (m,).
    """

    s: Array
    t: Array
    node: Indices
    p: Array
    v: Array
    bend: Array
    speed: Array


class ArcLength:
    """A shape with its arc length as the parameter.

    On each interval between two nodes the speed |dp/dt| is the polynomial through its values at
    eight Gauss points, the arc length its integral, and t(s) the inverse of that, by Newton's
    method. Intervals are halved until the polynomial is exact to 1e-10.

    Attributes:
        shape: The curve.
        length: Its arc length [m].
        s: Arc lengths of the nodes, shape (k,) [m].
        t: Parameters of the nodes, shape (k,); each break of the shape is one.
        folds: Arc lengths at which the direction jumps within a point [m].
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        breaks = shape.breaks
        chords = np.linalg.norm(np.diff(shape.derivatives(breaks)[0], axis=0), axis=1)
        self._speed_floor = 1e-9 * float(chords.sum()) / float(breaks[-1] - breaks[0])
        self.t, self._speeds, fitted = self._subdivide()
        self._half = 0.5 * np.diff(self.t)
        powers = np.arange(1, len(_X) + 1)
        arcs = self._speeds / powers[:, None]
        begin = -(arcs * ((-1.0) ** powers)[:, None]).sum(axis=0)
        # The integral of the speed from -1 on, lowest power first.
        self._arcs = np.concatenate([begin[None], arcs]) * self._half
        self._lengths = self._half * 2.0 * (arcs[::2].sum(axis=0))
        self.s: Array = np.concatenate([[0.0], np.cumsum(self._lengths)])
        self.length = float(self.s[-1])
        self.folds = self._find_folds(fitted)

    def at_break(self, index: int) -> float:
        """Return the arc length of a break of the shape [m]."""
        return float(self.s[np.searchsorted(self.t, self.shape.breaks[index])])

    def length_at(self, t: float) -> float:
        """Return the arc length at a parameter of the shape [m]."""
        node = int(np.clip(np.searchsorted(self.t, t, "right") - 1, 0, len(self._half) - 1))
        x = np.array([(t - self.t[node]) / self._half[node] - 1.0])
        return float(self.s[node] + _horner(self._arcs[:, [node]], x)[0])

    def points(self, s: Array) -> CurvePoints:
        """Return the points at arc lengths s, shape (m,) [m]."""
        node = np.clip(np.searchsorted(self.s, s, "right") - 1, 0, len(self._half) - 1)
        t = self._parameters(node, s - self.s[node])
        t = np.where(s >= self.length, self.t[-1], t)
        p, first, second = self.shape.derivatives(t)
        speed, v = self._directions(first, second)
        bend = (second - dot(v, second)[:, None] * v) / (speed**2)[:, None]
        return CurvePoints(s, t, node, p, v, bend, speed)

    def _parameters(self, node: Indices, since: Array) -> Array:
        """Invert the arc length on the intervals after the nodes, shape (m,)."""
        half, arcs, speeds = self._half[node], self._arcs[:, node], self._speeds[:, node]
        x = np.clip(2.0 * since / self._lengths[node] - 1.0, -1.0, 1.0)
        for _ in range(8):
            step = (_horner(arcs, x) - since) / (half * _horner(speeds, x))
            x = np.clip(x - step, -1.0, 1.0)
            if np.abs(step).max(initial=0.0) < 1e-15:
                break
        return np.asarray(np.where(since == 0.0, self.t[node], self.t[node] + half * (x + 1.0)))

    def _directions(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Speeds and unit tangents; where the point stands, the direction in which it leaves."""
        speed = np.linalg.norm(first, axis=1)
        floor = self._speed_floor
        still = speed < floor
        first = np.where(still[:, None], second, first)
        norm = np.linalg.norm(first, axis=1)
        return np.maximum(speed, floor), first / np.where(norm > 0.0, norm, 1.0)[:, None]

    def _subdivide(self) -> tuple[Array, Array, Flags]:
        """Return nodes, the polynomials of the speed between them, and where they fit."""
        breaks = self.shape.breaks
        a, b = breaks[:-1], breaks[1:]
        done: list[tuple[Array, Array, Flags]] = []
        checks = np.vander(_CHECKS, len(_X), increasing=True)
        scale = 0.0
        for level in range(_LEVELS):
            half, middle = 0.5 * (b - a), 0.5 * (a + b)
            t = middle + half * np.concatenate([_X, _CHECKS])[:, None]
            first = self.shape.derivatives(t.ravel())[1]
            speed = np.maximum(np.linalg.norm(first, axis=1), self._speed_floor).reshape(t.shape)
            found, true = speed[: len(_X)], speed[len(_X) :]
            polynomials = _TO_POWERS @ found
            length = half * (_WEIGHTS @ found)
            scale = scale or float(length.sum())
            fits = (np.abs(checks @ polynomials - true) <= _FIT * true).all(axis=0)
            stop = fits | (length <= _POINT * scale) | (level == _LEVELS - 1)
            # A point stands for an interval too short to fit: run through evenly.
            polynomials[0, ~fits] = 0.5 * length[~fits] / half[~fits]
            polynomials[1:, ~fits] = 0.0
            done.append((a[stop], polynomials[:, stop], fits[stop]))
            a, middle, b = a[~stop], middle[~stop], b[~stop]
            if len(a) == 0:
                break
            a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
        begins = np.concatenate([d[0] for d in done])
        order = np.argsort(begins)
        nodes = np.append(begins[order], breaks[-1])
        polynomials = np.concatenate([d[1] for d in done], axis=1)[:, order]
        return nodes, polynomials, np.concatenate([d[2] for d in done])[order]

    def _find_folds(self, fitted: Flags) -> tuple[float, ...]:
        """Where the curve turns within intervals too short to be more than a point."""
        folds = []
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~fitted, [False]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            _, v = self._directions(*self.shape.derivatives(self.t[[first, last]])[1:])
            if v[0] @ v[1] < 0.999:
                folds.append(float(0.5 * (self.s[first] + self.s[last])))
        return tuple(folds)


def _horner(coefficients: Array, x: Array) -> Array:
    """Values of polynomials, lowest power first, shape (n, m), at x, shape (m,)."""
    value = np.array(coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value
