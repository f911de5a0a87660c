"""The terms of joints and of rows of limits over a block of intervals.

Each kernel is a loop over numbers of a block, one number an interval, without branches: the
compiler turns it into vector instructions, for which all that it writes has to be in one array, at
distances that it knows. What is added up over joints and rows is added up in their order, interval
by interval.

All look at the limits at point ``k`` of the intervals from ``i`` on. ``work`` holds rows of a
block each, for both points, shape (2, ROWS * BLOCK): the squared rate b of the motion at B, b' at
B1, b'' at B2, b^(-1/2) at W (see fastest_warp), and what else the constants below name.
"""

from __future__ import annotations

from typing import NamedTuple

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = [
    "B1",
    "B2",
    "BLOCK",
    "DW",
    "G0",
    "G1",
    "G2",
    "H00",
    "H01",
    "H02",
    "H11",
    "H12",
    "H22",
    "HUGE",
    "JERK",
    "OUTSIDE",
    "PRODUCT",
    "ROWS",
    "S0",
    "TINY",
    "TOP",
    "WILD",
    "B",
    "SpeedSpline",
    "W",
    "WarpLimits",
    "joint_derivatives",
    "joint_excess",
    "joint_room",
    "joint_ways",
    "row_derivatives",
    "row_excess",
    "row_room",
    "row_ways",
    "speeds",
]

# So many intervals are looked at together: what is known of them stays near the processor.
BLOCK, ROWS = 64, 14
B, B1, B2, W, DW = (row * BLOCK for row in range(5))
# The product of rooms, how often there is none, and how often the product is to be taken apart.
PRODUCT, OUTSIDE, WILD = (row * BLOCK for row in range(4, 7))
# The gradient in value, slope and bend of the spline, and the upper triangle of the Hessian.
G0, G1, G2, H00, H01, H02, H11, H12, H22 = (row * BLOCK for row in range(5, 14))
# The largest ratio, and the steps of b, b' and b'', or the largest ratio to a jerk limit.
TOP, S0, S1, S2 = (row * BLOCK for row in range(5, 9))
JERK = S0
# A product of rooms outside this range is taken apart, before it overflows.
TINY, HUGE = 1e-200, 1e200


class SpeedSpline(NamedTuple):
    """The quadratic spline of a squared rate at two points of each interval; see spline_basis.

    Attributes:
        h: Lengths of the intervals, shape (n,).
        value: Values of its functions at the points, shape (2, 3, n).
        slope: Their first derivatives there, shape (2, 3, n).
        bend: Their second derivatives, shape (3, n).
    """

    h: Array
    value: Array
    slope: Array
    bend: Array


class WarpLimits(NamedTuple):
    """What bounds a motion played at another speed, at two points of each interval.

    Attributes:
        rates: For each joint: r'', r' / 2, and, over the jerk limit, r''', 3 r'' / 2 and r' / 2;
            shape (2, dof, 5, n).
        most: Upper bounds of the squared rate b, shape (2, n).
        up: Inverse of the upper acceleration limits, shape (2, dof, n); 0: none is looked at.
        down: Inverse of the lower ones, shape (2, dof, n), not positive.
        rows_b: Further limits p b + d b' <= 1: p, shape (2, rows, n).
        rows_d: d, shape (2, rows, n).
    """

    rates: Array
    most: Array
    up: Array
    down: Array
    rows_b: Array
    rows_d: Array


@kernel
def speeds(spline: SpeedSpline, c: Array, k: int, i: int, work: Array, first: int) -> None:
    """Write the spline of coefficients c, its slope and its bend to rows, one after the other."""
    end = min(i + BLOCK, len(spline.h))
    c0, c1, c2 = c[i:end], c[i + 1 : end + 1], c[i + 2 : end + 2]
    for row in range(3):
        functions = spline.bend if row == 2 else (spline.value[k] if row == 0 else spline.slope[k])
        f0, f1, f2 = functions[0, i:end], functions[1, i:end], functions[2, i:end]
        out = work[k, first + row * BLOCK : first + (row + 1) * BLOCK]
        for t in range(end - i):
            out[t] = f0[t] * c0[t] + f1[t] * c1[t] + f2[t] * c2[t]


@kernel
def joint_room(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Multiply products by the rooms to the limits of the joints."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for j in range(limits.rates.shape[1]):
        d0, d1 = limits.rates[k, j, 0, i:end], limits.rates[k, j, 1, i:end]
        e0, e1 = limits.rates[k, j, 2, i:end], limits.rates[k, j, 3, i:end]
        e2 = limits.rates[k, j, 4, i:end]
        up, down = limits.up[k, j, i:end], limits.down[k, j, i:end]
        for t in range(end - i):
            pull = d0[t] * s[B + t] + d1[t] * s[B1 + t]
            left, other = 1.0 - pull * up[t], 1.0 - pull * down[t]
            jerk = e0[t] * s[B + t] + e1[t] * s[B1 + t] + e2[t] * s[B2 + t]
            w = s[W + t]
            inside = (left > 0.0) & (other > 0.0) & (abs(jerk) < w)
            s[OUTSIDE + t] += 0.0 if inside else 1.0
            product = s[PRODUCT + t] * (left * other) * (w * w - jerk * jerk)
            s[WILD + t] += 0.0 if (product > TINY) & (product < HUGE) else 1.0
            s[PRODUCT + t] = product


@kernel
def row_room(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Multiply products by the room to the rows of limits."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for r in range(limits.rows_b.shape[1]):
        of_b, of_b1 = limits.rows_b[k, r, i:end], limits.rows_d[k, r, i:end]
        for t in range(end - i):
            left = 1.0 - of_b[t] * s[B + t] - of_b1[t] * s[B1 + t]
            s[OUTSIDE + t] += 0.0 if left > 0.0 else 1.0
            product = s[PRODUCT + t] * left
            s[WILD + t] += 1.0 if product < TINY else 0.0
            s[PRODUCT + t] = product


@kernel
def joint_derivatives(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Add what the rooms to the limits of the joints bring to the derivatives of the barrier."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for j in range(limits.rates.shape[1]):
        d0, d1 = limits.rates[k, j, 0, i:end], limits.rates[k, j, 1, i:end]
        e0, e1 = limits.rates[k, j, 2, i:end], limits.rates[k, j, 3, i:end]
        e2 = limits.rates[k, j, 4, i:end]
        up, down = limits.up[k, j, i:end], limits.down[k, j, i:end]
        for t in range(end - i):
            pull = d0[t] * s[B + t] + d1[t] * s[B1 + t]
            q, o = up[t] / (1.0 - pull * up[t]), down[t] / (1.0 - pull * down[t])
            first, second = q + o, q * q + o * o
            of_b, of_bb = s[G0 + t] + first * d0[t], s[H00 + t] + second * d0[t] * d0[t]
            of_b1, of_bb1 = s[G1 + t] + first * d1[t], s[H01 + t] + second * d0[t] * d1[t]
            of_b1b1 = s[H11 + t] + second * d1[t] * d1[t]
            jerk = e0[t] * s[B + t] + e1[t] * s[B1 + t] + e2[t] * s[B2 + t]
            w, dw = s[W + t], s[DW + t]
            q, o = 1.0 / (w - jerk), 1.0 / (w + jerk)
            first, second = q - o, q * q + o * o
            cross = (q * q - o * o) * dw
            s[G0 + t] = of_b + (first * e0[t] - (q + o) * dw)
            s[G1 + t] = of_b1 + first * e1[t]
            s[G2 + t] += first * e2[t]
            s[H00 + t] = of_bb + (second * (e0[t] * e0[t] + dw * dw) - 2.0 * cross * e0[t])
            s[H01 + t] = of_bb1 + (second * e0[t] * e1[t] - cross * e1[t])
            s[H02 + t] += second * e0[t] * e2[t] - cross * e2[t]
            s[H11 + t] = of_b1b1 + second * e1[t] * e1[t]
            s[H12 + t] += second * e1[t] * e2[t]
            s[H22 + t] += second * e2[t] * e2[t]


@kernel
def row_derivatives(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Add what the rooms to the rows of limits bring; see joint_derivatives."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for r in range(limits.rows_b.shape[1]):
        of_b, of_b1 = limits.rows_b[k, r, i:end], limits.rows_d[k, r, i:end]
        for t in range(end - i):
            d0, d1 = of_b[t], of_b1[t]
            q = 1.0 / (1.0 - d0 * s[B + t] - d1 * s[B1 + t])
            s[G0 + t] += q * d0
            s[G1 + t] += q * d1
            s[H00 + t] += q * q * d0 * d0
            s[H01 + t] += q * q * d0 * d1
            s[H11 + t] += q * q * d1 * d1


@kernel
def joint_ways(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Raise what a step takes of the room to the limits of the joints."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for j in range(limits.rates.shape[1]):
        d0, d1 = limits.rates[k, j, 0, i:end], limits.rates[k, j, 1, i:end]
        e0, e1 = limits.rates[k, j, 2, i:end], limits.rates[k, j, 3, i:end]
        e2 = limits.rates[k, j, 4, i:end]
        up, down = limits.up[k, j, i:end], limits.down[k, j, i:end]
        for t in range(end - i):
            pull = d0[t] * s[B + t] + d1[t] * s[B1 + t]
            more = d0[t] * s[S0 + t] + d1[t] * s[S1 + t]
            q = up[t] if more > 0.0 else down[t]
            jerk = e0[t] * s[B + t] + e1[t] * s[B1 + t] + e2[t] * s[B2 + t]
            change = e0[t] * s[S0 + t] + e1[t] * s[S1 + t] + e2[t] * s[S2 + t]
            w, dw = s[W + t], s[DW + t]
            way = max(s[TOP + t], more * q / (1.0 - pull * q))
            way = max(way, (change - dw) / (w - jerk))
            s[TOP + t] = max(way, (-change - dw) / (w + jerk))


@kernel
def row_ways(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Raise what a step takes of the room to the rows of limits."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for r in range(limits.rows_b.shape[1]):
        of_b, of_b1 = limits.rows_b[k, r, i:end], limits.rows_d[k, r, i:end]
        for t in range(end - i):
            left = 1.0 - of_b[t] * s[B + t] - of_b1[t] * s[B1 + t]
            way = (of_b[t] * s[S0 + t] + of_b1[t] * s[S1 + t]) / left
            s[TOP + t] = max(s[TOP + t], way)


@kernel
def joint_excess(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Raise the ratios to the acceleration and jerk limits of the joints."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for j in range(limits.rates.shape[1]):
        d0, d1 = limits.rates[k, j, 0, i:end], limits.rates[k, j, 1, i:end]
        e0, e1 = limits.rates[k, j, 2, i:end], limits.rates[k, j, 3, i:end]
        e2 = limits.rates[k, j, 4, i:end]
        up, down = limits.up[k, j, i:end], limits.down[k, j, i:end]
        for t in range(end - i):
            pull = d0[t] * s[B + t] + d1[t] * s[B1 + t]
            s[TOP + t] = max(s[TOP + t], max(pull * up[t], pull * down[t]))
            jerk = e0[t] * s[B + t] + e1[t] * s[B1 + t] + e2[t] * s[B2 + t]
            s[JERK + t] = max(s[JERK + t], abs(jerk))


@kernel
def row_excess(limits: WarpLimits, k: int, i: int, work: Array) -> None:
    """Raise the ratios to the rows of limits."""
    end = min(i + BLOCK, limits.rates.shape[3])
    s = work[k]
    for r in range(limits.rows_b.shape[1]):
        of_b, of_b1 = limits.rows_b[k, r, i:end], limits.rows_d[k, r, i:end]
        for t in range(end - i):
            s[TOP + t] = max(s[TOP + t], of_b[t] * s[B + t] + of_b1[t] * s[B1 + t])
