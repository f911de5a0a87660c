"""The compiled formulas of the shapes; see :mod:`ikplan.path.curves.shapes`."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array

__all__ = [
    "COEFFICIENTS",
    "CUBIC",
    "NUMBERS",
    "QUINTIC",
    "ROSE",
    "SINUSOID",
    "shape_into",
    "shape_rows",
]


CUBIC, QUINTIC, SINUSOID, ROSE = range(4)
"""Kinds of shapes."""
COEFFICIENTS, NUMBERS = 6, 13
"""Rows of coefficients of a span, and numbers of a shape."""


@leaf_kernel
def shape_into(
    kind: int, numbers: Array, begin: float, last: bool, row: Array, t: float, out: Array
) -> None:
    """Write the position and its first two derivatives by t to the rows of ``out``, shape (3, 3).

    Args:
        kind: Kind of the shape.
        numbers: Numbers of the shape, shape (NUMBERS,): of plane curves the origin, the first two
            axes of the frame, and four parameters.
        begin: Parameter at which the span begins.
        last: Whether t is the end of the shape.
        row: Coefficients of the span, shape (COEFFICIENTS, 3): of a cubic the highest power first
            and then, for the last span, the end; of a quintic its control points.
        t: Parameter.
        out: Out: derivatives of order 0, 1 and 2 [m].
    """
    if kind == CUBIC:
        x = t - begin
        for j in range(3):
            c3, c2, c1 = row[0, j], row[1, j], row[2, j]
            p = ((c3 * x + c2) * x + c1) * x + row[3, j]
            out[0, j] = row[4, j] if last else p
            out[1, j] = (3.0 * c3 * x + 2.0 * c2) * x + c1
            out[2, j] = 6.0 * c3 * x + 2.0 * c2
    elif kind == QUINTIC:
        _quintic_into(row, t, out)
    elif kind == SINUSOID:
        amplitude, rate, phase = numbers[9], numbers[10], numbers[11]
        y, dy = math.sin(rate * t + phase), math.cos(rate * t + phase)
        _plane_into(numbers, t, amplitude * y, 0, out)
        _plane_into(numbers, 1.0, amplitude * rate * dy, 1, out)
        _plane_into(numbers, 0.0, -amplitude * rate * rate * y, 2, out)
    else:
        radius, petals, phase, g = numbers[9], numbers[10], numbers[11], numbers[12]
        b = phase + g * t
        rho = radius * math.cos(petals * b)
        drho = -radius * petals * math.sin(petals * b)
        ddrho = -petals * petals * rho
        c, s = math.cos(b), math.sin(b)
        _plane_into(numbers, rho * c, rho * s, 0, out)
        _plane_into(numbers, g * (drho * c - rho * s), g * (drho * s + rho * c), 1, out)
        x, y = (ddrho - rho) * c - 2.0 * drho * s, (ddrho - rho) * s + 2.0 * drho * c
        _plane_into(numbers, g * g * x, g * g * y, 2, out)


@leaf_kernel
def _plane_into(numbers: Array, x: float, y: float, order: int, out: Array) -> None:
    """Write a derivative of a plane curve, given in its frame."""
    for j in range(3):
        out[order, j] = x * numbers[3 + 2 * j] + y * numbers[4 + 2 * j]
        if order == 0:
            out[0, j] += numbers[j]


@leaf_kernel
def _quintic_into(b: Array, t: float, out: Array) -> None:
    """Write a quintic, given by its control points, by Bernstein polynomials."""
    u = 1.0 - t
    t2, u2 = t * t, u * u
    t3, u3 = t2 * t, u2 * u
    t4, u4 = t2 * t2, u2 * u2
    for j in range(3):
        b0, b1, b2, b3, b4, b5 = b[0, j], b[1, j], b[2, j], b[3, j], b[4, j], b[5, j]
        d0, d1, d2, d3, d4 = b1 - b0, b2 - b1, b3 - b2, b4 - b3, b5 - b4
        out[0, j] = (
            u4 * u * b0
            + 5.0 * t * u4 * b1
            + 10.0 * t2 * u3 * b2
            + 10.0 * t3 * u2 * b3
            + 5.0 * t4 * u * b4
            + t4 * t * b5
        )
        out[1, j] = 5.0 * (
            u4 * d0 + 4.0 * t * u3 * d1 + 6.0 * t2 * u2 * d2 + 4.0 * t3 * u * d3 + t4 * d4
        )
        out[2, j] = 20.0 * (
            u3 * (d1 - d0) + 3.0 * t * u2 * (d2 - d1) + 3.0 * t2 * u * (d3 - d2) + t3 * (d4 - d3)
        )


@kernel
def shape_rows(
    kind: int, numbers: Array, begins: Array, rows: Array, end: float, t: Array
) -> Array:
    """Return derivatives of order 0, 1 and 2 at parameters, shape (m,) -> (3, m, 3).

    Args:
        kind: Kind of the shape.
        numbers: Its numbers, shape (NUMBERS,).
        begins: Parameter at which each span begins, shape (b,), increasing.
        rows: Coefficients of each span, shape (b, COEFFICIENTS, 3).
        end: Parameter at which the shape ends.
        t: Parameters.
    """
    out, d = np.empty((3, len(t), 3)), np.empty((3, 3))
    for i in range(len(t)):
        k = max(np.searchsorted(begins, t[i], "right") - 1, 0)
        shape_into(kind, numbers, begins[k], t[i] == end, rows[k], t[i], d)
        for order in range(3):
            for j in range(3):
                out[order, i, j] = d[order, j]
    return out
