"""Curves run through by their arc length."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.path.curves.arc_kernels import CurveStack, arc_intervals
from ikplan.path.curves.shape_kernels import COEFFICIENTS, NUMBERS
from ikplan.path.curves.shapes import Shape

__all__ = ["ArcLength", "stack_curves"]


_X, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_TO_POWERS: Array = np.asarray(np.linalg.inv(np.vander(_X, increasing=True)), dtype=np.float64)
"""From values at the Gauss points of [-1, 1] to the coefficients of the polynomial through them."""
_CHECKS = np.array([-1.0, -0.52, 0.07, 0.61, 1.0])
"""Where that polynomial is held to the speed: between Gauss points and at the ends."""
_POINTS = np.concatenate([_X, _CHECKS])
_POWERS = np.arange(1, len(_X) + 1)
_SIGNS = (-1.0) ** _POWERS
_FIT = 1e-10
"""Error of the speed allowed, as a share of it."""
_POINT = 1e-10
"""An interval shorter than this share of the length counts as a point."""
_LEVELS = 60


class ArcLength:
    """A shape with its arc length as the parameter.

    On each interval between two nodes the speed |dp/dt| is the polynomial through its values at
    eight Gauss points, the arc length its integral, and t(s) the inverse of that, by Newton's
    method. Intervals are halved until the polynomial is exact to 1e-10.

    Attributes:
        shape: The curve.
        stack: The curve as a stack of one.
        length: Its arc length [m].
        s: Arc lengths of the nodes, shape (k,) [m].
        t: Parameters of the nodes, shape (k,); each break of the shape is one.
        folds: Arc lengths at which the direction jumps within a point [m].
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        breaks = shape.breaks
        chords = np.linalg.norm(np.diff(shape.derivatives(breaks)[0], axis=0), axis=1)
        floor = 1e-9 * float(chords.sum()) / float(breaks[-1] - breaks[0])
        begins, speeds, fitted, span = arc_intervals(
            shape.kind,
            shape.numbers,
            shape.begins,
            shape.rows,
            breaks,
            floor,
            _POINTS,
            _TO_POWERS,
            _WEIGHTS,
            _FIT,
            _POINT,
            _LEVELS,
        )
        self.t: Array = np.append(begins, breaks[-1])
        half = 0.5 * np.diff(self.t)[:, None]
        arcs = speeds / _POWERS
        begin = -(arcs * _SIGNS).sum(axis=1)
        # The integral of the speed from -1 on, lowest power first.
        self._arcs = np.column_stack([begin, arcs]) * half
        lengths = half[:, 0] * 2.0 * arcs[:, ::2].sum(axis=1)
        self.s: Array = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(self.s[-1])
        self.stack = CurveStack(
            np.array([shape.kind]),
            shape.numbers[None],
            np.array([floor]),
            np.array([0, len(self.t)]),
            self.s,
            self.t,
            np.vstack([self._arcs, np.zeros_like(self._arcs[:1])]),
            np.vstack([speeds, np.zeros_like(speeds[:1])]),
            np.append(span, span[-1]),
            shape.begins,
            shape.rows,
        )
        self.folds = () if fitted.all() else self._find_folds(fitted, floor)

    def at_break(self, index: int) -> float:
        """Return the arc length of a break of the shape [m]."""
        return float(self.s[np.searchsorted(self.t, self.shape.breaks[index])])

    def length_at(self, t: float) -> float:
        """Return the arc length at a parameter of the shape [m]."""
        node = int(np.clip(np.searchsorted(self.t, t, "right") - 1, 0, len(self.t) - 2))
        half = 0.5 * (self.t[node + 1] - self.t[node])
        x = (t - self.t[node]) / half - 1.0
        value = 0.0
        for coefficient in self._arcs[node, ::-1].tolist():
            value = value * x + coefficient
        return float(self.s[node] + value)

    def _find_folds(self, fitted: Flags, floor: float) -> tuple[float, ...]:
        """Where the curve turns within intervals too short to be more than a point."""
        folds = []
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~fitted, [False]]).astype(int)))
        for first, last in edges.reshape(-1, 2):
            _, velocity, second = self.shape.derivatives(self.t[[first, last]])
            still = np.linalg.norm(velocity, axis=1) < floor
            v = np.where(still[:, None], second, velocity)
            norm = np.linalg.norm(v, axis=1)
            v = v / np.where(norm > 0.0, norm, 1.0)[:, None]
            if v[0] @ v[1] < 0.999:
                folds.append(float(0.5 * (self.s[first] + self.s[last])))
        return tuple(folds)


def stack_curves(curves: Sequence[ArcLength]) -> CurveStack:
    """Return curves as flat arrays."""
    if not curves:
        return _NO_CURVE
    if len(curves) == 1:
        return curves[0].stack
    stacks = [curve.stack for curve in curves]
    nodes = np.cumsum([0, *(len(a.s) for a in stacks)])
    spans = np.cumsum([0, *(len(a.begins) for a in stacks)])
    joined = {
        name: np.concatenate([getattr(a, name) for a in stacks])
        for name in CurveStack._fields
        if name not in ("first", "span")
    }
    span = np.concatenate([a.span + first for a, first in zip(stacks, spans, strict=False)])
    return CurveStack(first=nodes, span=span, **joined)


_NO_CURVE = CurveStack(
    np.zeros(0, dtype=np.int64),
    np.zeros((0, NUMBERS)),
    np.zeros(0),
    np.zeros(1, dtype=np.int64),
    np.zeros(0),
    np.zeros(0),
    np.zeros((0, len(_X) + 1)),
    np.zeros((0, len(_X))),
    np.zeros(0, dtype=np.int64),
    np.zeros(0),
    np.zeros((0, COEFFICIENTS, 3)),
)
