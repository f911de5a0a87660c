"""Orientations led smoothly through rotations."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.path.curves.natural_spline import NaturalSpline
from ikplan.path.pieces.piece import dot
from ikplan.path.pieces.turning import Turning, quaternion_rows
from ikplan.path.pieces.turning_kernels import BY_LENGTH

__all__ = ["SplineTurning"]


_SWINGS = 0.4
"""Farther than this from unit length, the quaternions turn back and forth when scaled to it."""


class SplineTurning(Turning):
    """Leads the orientation through rotations with continuous angular acceleration.

    The natural cubic spline of the unit quaternions in R^4, each on the side of the one before,
    brought back to unit length. Left and right multiplication by a unit quaternion are isometries
    of R^4, so that the curve depends on no frame; neither does it on the direction of travel.
    (Interpolation in the embedding space: Gawlik and Leok, Found. Comput. Math. 18, 2018.)

    Its knots are the arc lengths. Where much turning on a short way is next to a long way, such a
    spline would swing far to and fro; its knots are then the sum of the shares of length and of
    turning, and a monotone quintic, C2 as well, leads from arc length to that parameter.

    Args:
        s: Arc lengths of the rotations, shape (k,), k >= 2, increasing [m].
        quaternions: Unit quaternions (x, y, z, w), shape (k, 4), neighbours less than pi apart.

    Attributes:
        off_sphere: How far the spline in R^4 gets from unit length.
        worst_span: Where, 0 for the span between the first two rotations.
    """

    def __init__(self, s: Array, quaternions: Array) -> None:
        q = quaternions.copy()
        signs = np.cumprod(np.where(dot(q[1:], q[:-1]) < 0.0, -1.0, 1.0))
        q[1:] *= signs[:, None]
        spline = self._fit(s, q)
        if self.off_sphere <= _SWINGS:
            super().__init__(BY_LENGTH, np.zeros(1), s, quaternion_rows(spline.c))
            return
        angles = 2.0 * np.arccos(np.minimum(dot(q[1:], q[:-1]), 1.0))
        steps = np.diff(s) / (s[-1] - s[0]) + angles / angles.sum()
        knots = np.concatenate([[0.0], np.cumsum(steps)])
        rows = quaternion_rows(self._fit(knots, q).c)
        super().__init__(BY_LENGTH, np.ones(1), knots, rows, s, _monotone(s, knots))

    def _fit(self, knots: Array, q: Array) -> NaturalSpline:
        spline = NaturalSpline(knots, q)
        between = spline(np.linspace(knots[:-1], knots[1:], 9).ravel())
        off = np.abs(np.linalg.norm(between, axis=1) - 1.0).reshape(9, -1).max(axis=0)
        self.worst_span, self.off_sphere = int(np.argmax(off)), float(off.max())
        return spline


def _monotone(x: Array, y: Array) -> Array:
    """The C2 piecewise quintic through increasing points, increasing too.

    Slopes are harmonic means of those of the chords on either side, so at most twice the smaller,
    and second derivatives 0: by the Bernstein form of its slope such a quintic does not fall.

    Returns:
        Coefficients since each point, highest power first, shape (k, 6); none after the last.
    """
    h, chord = np.diff(x), np.diff(y) / np.diff(x)
    slope = np.concatenate(
        [chord[:1], 2.0 * chord[1:] * chord[:-1] / (chord[1:] + chord[:-1]), chord[-1:]]
    )
    a, b = slope[:-1] - chord, slope[1:] - chord
    nil = np.zeros_like(h)
    # In powers of t = (x - x_k) / h: the chord, and what the slopes differ from it.
    rows = [-3.0 * (a + b), 8.0 * a + 7.0 * b, -6.0 * a - 4.0 * b, nil, slope[:-1]]
    powers = [row * h ** (-power) for row, power in zip(rows, (4, 3, 2, 1, 0), strict=True)]
    return np.vstack([np.array([*powers, y[:-1]]).T, np.zeros((1, 6))])
