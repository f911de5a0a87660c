"""Tangents of cubic splines that pass their knots and stay inside a box."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.copying import copy_rows_into

__all__ = ["hermite_extrema", "limit_tangents", "natural_tangents", "tangents_between"]


@kernel
def natural_tangents(s: Array, q: Array) -> Array:
    """Return the tangents of the natural cubic spline, whose second derivative is continuous.

    The tridiagonal system of the tangents (de Boor, A Practical Guide to Splines, ch. IV), solved
    by Thomas' elimination; it is diagonally dominant for any spacing of the knots.

    Args:
        s: Knots, shape (n,), n >= 2, strictly increasing.
        q: Values at the knots, shape (n, dof).

    Returns:
        dq/ds at the knots, shape (n, dof).
    """
    n, dof = q.shape
    upper = np.empty(n)
    m = np.empty((n, dof))
    h = s[1] - s[0]
    upper[0] = 0.5
    for j in range(dof):
        m[0, j] = 1.5 * (q[1, j] - q[0, j]) / h
    for i in range(1, n):
        h0 = s[i] - s[i - 1]
        h1 = s[i + 1] - s[i] if i + 1 < n else np.inf
        if i + 1 < n:
            # h1 m[i-1] + 2 (h0 + h1) m[i] + h0 m[i+1] = 3 (h1 d[i-1] + h0 d[i]), over h0 + h1.
            w0, w1 = h1 / (h0 + h1), h0 / (h0 + h1)
            diagonal = 2.0 - w0 * upper[i - 1]
            upper[i] = w1 / diagonal
            for j in range(dof):
                d0 = (q[i, j] - q[i - 1, j]) / h0
                d1 = (q[i + 1, j] - q[i, j]) / h1
                m[i, j] = (3.0 * (w0 * d0 + w1 * d1) - w0 * m[i - 1, j]) / diagonal
        else:
            diagonal = 2.0 - upper[i - 1]
            for j in range(dof):
                m[i, j] = (3.0 * (q[i, j] - q[i - 1, j]) / h0 - m[i - 1, j]) / diagonal
    for i in range(n - 2, -1, -1):
        for j in range(dof):
            m[i, j] -= upper[i] * m[i + 1, j]
    return m


@kernel
def _extrema(h: float, q0: float, q1: float, m0: float, m1: float) -> tuple[float, float]:
    """Return the least and greatest value of one cubic Hermite piece of length h."""
    low, high = min(q0, q1), max(q0, q1)
    # dq/ds = a t^2 + b t + m0 with t in [0, 1].
    d = (q1 - q0) / h
    a = 3.0 * (m0 + m1 - 2.0 * d)
    b = 2.0 * (3.0 * d - 2.0 * m0 - m1)
    discriminant = b * b - 4.0 * a * m0
    if discriminant < 0.0:
        return low, high
    w = -0.5 * (b + (np.sqrt(discriminant) if b >= 0.0 else -np.sqrt(discriminant)))
    for root in (w / a if a != 0.0 else -1.0, m0 / w if w != 0.0 else -1.0):
        if 0.0 < root < 1.0:
            r = 1.0 - root
            value = q0 * r * r * (1.0 + 2.0 * root) + q1 * root * root * (3.0 - 2.0 * root)
            value += h * root * r * (m0 * r - m1 * root)
            low, high = min(low, value), max(high, value)
    return low, high


@kernel
def hermite_extrema(s: Array, q: Array, m0: Array, m1: Array) -> tuple[Array, Array]:
    """Return the exact range of every piece.

    Args:
        s: Knots, shape (n,).
        q: Values at the knots, shape (n, dof).
        m0: Tangents at the start of each piece, shape (n - 1, dof).
        m1: Tangents at the end of each piece, shape (n - 1, dof).

    Returns:
        Least and greatest values, each of shape (n - 1, dof).
    """
    low, high = np.empty(m0.shape), np.empty(m0.shape)
    for i in range(m0.shape[0]):
        for j in range(m0.shape[1]):
            low[i, j], high[i, j] = _extrema(
                s[i + 1] - s[i], q[i, j], q[i + 1, j], m0[i, j], m1[i, j]
            )
    return low, high


@kernel
def limit_tangents(s: Array, q: Array, m: Array, lower: Array, upper: Array) -> int:
    """Bend the tangents of the pieces that leave the box, until none does.

    A cubic lies in the hull of its Bezier points q0, q0 + h m0 / 3, q1 - h m1 / 3, q1. Where a
    piece leaves the box, both tangents of that joint are shortened so that these points are in
    it; then the piece is inside for good. A shortened tangent can push out the piece on its
    other side, which is treated in a later pass. First derivatives stay continuous, second
    derivatives jump at the knots that were touched.

    Args:
        s: Knots, shape (n,).
        q: Values at the knots, shape (n, dof), inside the box.
        m: Tangents at the knots, shape (n, dof); changed in place.
        lower: Lower bounds, shape (dof,), may be -inf.
        upper: Upper bounds, shape (dof,), may be +inf.

    Returns:
        The number of tangents that were changed.
    """
    changed = 0
    pending = True
    while pending:
        pending = False
        for i in range(q.shape[0] - 1):
            h = s[i + 1] - s[i]
            for j in range(q.shape[1]):
                low, high = _extrema(h, q[i, j], q[i + 1, j], m[i, j], m[i + 1, j])
                if low >= lower[j] and high <= upper[j]:
                    continue
                first = min(
                    max(m[i, j], 3.0 * (lower[j] - q[i, j]) / h), 3.0 * (upper[j] - q[i, j]) / h
                )
                last = min(
                    max(m[i + 1, j], 3.0 * (q[i + 1, j] - upper[j]) / h),
                    3.0 * (q[i + 1, j] - lower[j]) / h,
                )
                # Nothing left to shorten: what remains outside is rounding.
                if first != m[i, j] or last != m[i + 1, j]:
                    changed += int(first != m[i, j]) + int(last != m[i + 1, j])
                    m[i, j], m[i + 1, j] = first, last
                    pending = True
    return changed


@kernel
def tangents_between(
    s: Array, q: Array, rests: Indices, lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Return the tangents of natural splines between rests, bent to stay inside the box.

    Args:
        s: Knots, shape (n,).
        q: Values at the knots, shape (n, dof), inside the box.
        rests: Knots at which the motion rests, the first and the last among them, in order.
        lower: Lower bounds, shape (dof,), may be -inf.
        upper: Upper bounds, shape (dof,), may be +inf.

    Returns:
        dq/ds at the start and at the end of every piece, each of shape (n - 1, dof).
    """
    start, end = np.zeros((len(s) - 1, q.shape[1])), np.zeros((len(s) - 1, q.shape[1]))
    for k in range(len(rests) - 1):
        first, last = rests[k], rests[k + 1]
        here, values = s[first : last + 1], q[first : last + 1]
        m = natural_tangents(here, values)
        limit_tangents(here, values, m, lower, upper)
        copy_rows_into(start[first:last], m[:-1])
        copy_rows_into(end[first:last], m[1:])
    return start, end
