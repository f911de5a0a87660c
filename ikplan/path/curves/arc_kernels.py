"""The compiled arc length of curves; see :mod:`ikplan.path.curves.arc_length`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.path.curves.shape_kernels import shape_into

__all__ = ["CurveStack", "arc_intervals", "curve_into", "last_at_or_before", "parameter_at"]


class CurveStack(NamedTuple):
    """Curves as flat arrays: the rows of one curve follow those of the one before.

    Attributes:
        kind: Kind of the shape of each curve, shape (c,).
        numbers: Numbers of each shape, shape (c, NUMBERS).
        floor: Smallest speed |dp/dt| of each, shape (c,).
        first: Row of the first node of each, and the number of nodes, shape (c + 1,).
        s: Arc lengths of the nodes, shape (n,) [m].
        t: Parameters of the nodes, shape (n,).
        arcs: Arc length since the node, over [-1, 1], lowest power first, shape (n, 9) [m].
        speeds: Speed over [-1, 1], lowest power first, shape (n, 8).
        span: Row of the span of the shape that follows the node, shape (n,).
        begins: Parameter at which each span begins, shape (b,).
        rows: Coefficients of each span, shape (b, COEFFICIENTS, 3).
    """

    kind: Indices
    numbers: Array
    floor: Array
    first: Indices
    s: Array
    t: Array
    arcs: Array
    speeds: Array
    span: Indices
    begins: Array
    rows: Array


@leaf_kernel
def last_at_or_before(values: Array, first: int, end: int, x: float) -> int:
    """Return the last row in [first, end) whose value is at most x; else the first."""
    low, high = first, end
    while low < high:
        middle = (low + high) // 2
        if values[middle] <= x:
            low = middle + 1
        else:
            high = middle
    return max(low - 1, first)


@leaf_kernel
def _horner(coefficients: Array, x: float) -> float:
    """Value of a polynomial, lowest power first."""
    value = coefficients[len(coefficients) - 1]
    for k in range(len(coefficients) - 2, -1, -1):
        value = value * x + coefficients[k]
    return float(value)


@leaf_kernel
def parameter_at(a: CurveStack, node: int, end: int, s: float) -> float:
    """Return the parameter at an arc length on the interval after a node: Newton's method."""
    if s >= a.s[end]:
        return float(a.t[end])
    since = s - a.s[node]
    if since == 0.0:
        return float(a.t[node])
    half, length = 0.5 * (a.t[node + 1] - a.t[node]), a.s[node + 1] - a.s[node]
    arcs, speeds = a.arcs[node], a.speeds[node]
    x = min(max(2.0 * since / length - 1.0, -1.0), 1.0)
    for _ in range(8):
        step = (_horner(arcs, x) - since) / (half * _horner(speeds, x))
        x = min(max(x - step, -1.0), 1.0)
        if abs(step) < 1e-15:
            break
    return float(a.t[node] + half * (x + 1.0))


@leaf_kernel
def curve_into(a: CurveStack, c: int, s: float, d: Array) -> tuple[int, float, float]:
    """Write position, unit tangent and curvature vector at arc length s to the rows of d, (3, 3).

    Where the point stands, the tangent is the direction in which it leaves.

    Returns:
        The row of the last node before the point, the parameter, and |dp/dt|.
    """
    end = a.first[c + 1] - 1
    node = last_at_or_before(a.s, a.first[c], end, s)
    t = parameter_at(a, node, end, s)
    k = a.span[node]
    shape_into(a.kind[c], a.numbers[c], a.begins[k], t == a.t[end], a.rows[k], t, d)
    speed = math.sqrt(d[1, 0] * d[1, 0] + d[1, 1] * d[1, 1] + d[1, 2] * d[1, 2])
    if speed < a.floor[c]:
        d[1, 0], d[1, 1], d[1, 2] = d[2, 0], d[2, 1], d[2, 2]
        speed = a.floor[c]
    norm = math.sqrt(d[1, 0] * d[1, 0] + d[1, 1] * d[1, 1] + d[1, 2] * d[1, 2])
    scale = norm if norm > 0.0 else 1.0
    along = 0.0
    for j in range(3):
        d[1, j] /= scale
        along += d[1, j] * d[2, j]
    for j in range(3):
        d[2, j] = (d[2, j] - along * d[1, j]) / (speed * speed)
    return node, t, speed


@kernel
def arc_intervals(
    kind: int,
    numbers: Array,
    begins: Array,
    rows: Array,
    breaks: Array,
    floor: float,
    points: Array,
    to_powers: Array,
    weights: Array,
    fit: float,
    point: float,
    levels: int,
) -> tuple[Array, Array, Flags, Indices]:
    """Halve the parts of a shape until the polynomial of the speed fits on each.

    Args:
        kind: Kind of the shape.
        numbers: Its numbers.
        begins: Parameter at which each span begins, shape (b,).
        rows: Coefficients of each span, shape (b, COEFFICIENTS, 3).
        breaks: Parameters between which the shape is smooth, shape (k + 1,), span i after break i.
        floor: Smallest speed.
        points: Places in [-1, 1]: those that the polynomial passes, then those it is held to.
        to_powers: From values at the first n points to coefficients, shape (n, n).
        weights: Weights of the first n points for the integral, shape (n,).
        fit: Error of the speed allowed, as a share of it.
        point: An interval shorter than this share of the length counts as a point.
        levels: Most times that an interval is halved.

    Returns:
        Begins of the intervals (m,), polynomials (m, n), whether they fit (m,), and spans (m,).
    """
    n, count = len(weights), len(breaks) - 1
    d = np.empty((3, 3))
    found, size = np.empty((2 * count, n + 2)), 0
    span = np.empty(2 * count, dtype=np.int64)
    speed, polynomial = np.empty(len(points)), np.empty(n)
    scale = 0.0
    pending = np.empty((levels + 2, 3))
    # The scale is the length by the polynomials on the whole parts.
    for first in (True, False):
        for k in range(count):
            pending[0, 0], pending[0, 1], pending[0, 2] = breaks[k], breaks[k + 1], 0.0
            waiting = 1
            while waiting > 0:
                waiting -= 1
                a, b, level = pending[waiting, 0], pending[waiting, 1], pending[waiting, 2]
                half, middle = 0.5 * (b - a), 0.5 * (a + b)
                length, fits = 0.0, True
                for i in range(len(points)):
                    row = min(k, len(rows) - 1)
                    t = middle + half * points[i]
                    shape_into(kind, numbers, begins[row], False, rows[row], t, d)
                    norm = math.sqrt(d[1, 0] ** 2 + d[1, 1] ** 2 + d[1, 2] ** 2)
                    speed[i] = max(norm, floor)
                for i in range(n):
                    length += weights[i] * speed[i]
                length *= half
                if first:
                    scale += length
                    continue
                for i in range(n):
                    polynomial[i] = 0.0
                    for j in range(n):
                        polynomial[i] += to_powers[i, j] * speed[j]
                for i in range(n, len(points)):
                    off = abs(_horner(polynomial, points[i]) - speed[i])
                    fits = fits and off <= fit * speed[i]
                if not (fits or length <= point * scale or level >= levels - 1):
                    # The later half waits below the earlier one.
                    pending[waiting, 0], pending[waiting, 1] = middle, b
                    pending[waiting + 1, 0], pending[waiting + 1, 1] = a, middle
                    pending[waiting, 2] = pending[waiting + 1, 2] = level + 1.0
                    waiting += 2
                    continue
                if not fits:
                    # A point stands for an interval too short to fit: run through evenly.
                    polynomial[:] = 0.0
                    polynomial[0] = 0.5 * length / half
                if size == len(found):
                    found = np.concatenate((found, np.empty_like(found)))
                    span = np.concatenate((span, np.empty_like(span)))
                found[size, 0], found[size, 1] = a, 1.0 if fits else 0.0
                found[size, 2:] = polynomial
                span[size] = min(k, len(rows) - 1)
                size += 1
    return (
        found[:size, 0].copy(),
        found[:size, 2:].copy(),
        found[:size, 1] > 0.5,
        span[:size].copy(),
    )
