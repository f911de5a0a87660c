"""A compiled engine: it finds the grid, answers what-ifs, and stands in where toppra fails."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.timing.engines.engine import checked
from ikplan.timing.engines.rows import StageRows

__all__ = ["FLOOR", "HIGHEST", "NO_MATTER", "CompiledEngine"]


# A row whose coefficient of u is this much smaller than that of another bounds x alone: where it
# binds, (1 - b x) / a would be rounding over nothing.
NO_MATTER = 1e-10
HIGHEST = 1e8
"""Upper bound of every squared path velocity."""
# The speed after an interval is kept above this share of the highest one that is controllable,
# where rest may reach it: a motion that the highest speeds force to stop would stand still.
FLOOR = 1e-3


@kernel
def _accelerations(a: Array, b: Array, x: float) -> tuple[float, float, int, int]:
    """Return the interval of u that the rows allow at x, and the rows that bound it."""
    low, high = -np.inf, np.inf
    low_row, high_row = -1, -1
    for r in range(a.shape[0]):
        if a[r] > 0.0:
            u = (1.0 - b[r] * x) / a[r]
            if u < high:
                high, high_row = u, r
        elif a[r] < 0.0:
            u = (1.0 - b[r] * x) / a[r]
            if u > low:
                low, low_row = u, r
    return low, high, low_row, high_row


@kernel
def _largest_controllable(a: Array, b: Array, h: float, x_max: float, x_next: float) -> float:
    """Return the greatest x from which some u leads to an x up to x_next and not near zero.

    The room between the bounds of u is a concave function of x that is not negative at x = 0.
    Newton's steps from the right, each to where the two lines that bind now cross, arrive at its
    greatest root without passing it, after finitely many steps.
    """
    x = x_max
    for r in range(a.shape[0]):
        if b[r] > 0.0 and a[r] == 0.0:
            x = min(x, 1.0 / b[r])
    at_rest = _accelerations(a, b, 0.0)[1]
    floor = min(FLOOR * x_next, 2.0 * h * at_rest)
    for _ in range(4 * a.shape[0] + 8):
        low, high, low_row, high_row = _accelerations(a, b, x)
        # Lines u = p + g x: first the rows, then those of floor <= x + 2 h u <= x_next.
        p_low, g_low = floor / (2.0 * h), -1.0 / (2.0 * h)
        p_high, g_high = x_next / (2.0 * h), -1.0 / (2.0 * h)
        if low_row >= 0 and low >= p_low + g_low * x:
            p_low, g_low = 1.0 / a[low_row], -b[low_row] / a[low_row]
        if high_row >= 0 and high <= p_high + g_high * x:
            p_high, g_high = 1.0 / a[high_row], -b[high_row] / a[high_row]
        slope = g_high - g_low
        if p_high - p_low + slope * x >= 0.0 or slope >= 0.0:
            return x
        following = (p_low - p_high) / slope
        if not following < x:
            return max(following, 0.0)
        x = max(following, 0.0)
    return x


@kernel
def _those_that_matter(row: Array, a: Array) -> None:
    """Write the coefficients of u of one interval, 0 for those that bound x alone."""
    least = 0.0
    for r in range(len(row)):
        least = max(least, abs(row[r]))
    least *= NO_MATTER
    for r in range(len(row)):
        a[r] = 0.0 if abs(row[r]) < least else row[r]


@kernel
def _solve(s: Array, rows_a: Array, b: Array, x_max: Array, x_first: float, x_last: float) -> Array:
    n, m = rows_a.shape
    a = np.empty(m)
    controllable = np.zeros(n + 1)
    controllable[n] = x_last
    for i in range(n - 1, -1, -1):
        h = s[i + 1] - s[i]
        _those_that_matter(rows_a[i], a)
        controllable[i] = _largest_controllable(a, b[i], h, x_max[i], controllable[i + 1])
    x = np.zeros(n + 1)
    x[0] = min(x_first, controllable[0])
    for i in range(n):
        h = s[i + 1] - s[i]
        _those_that_matter(rows_a[i], a)
        _, high, _, _ = _accelerations(a, b[i], x[i])
        x[i + 1] = min(max(x[i] + 2.0 * h * high, 0.0), controllable[i + 1])
    return x


class CompiledEngine:
    """TOPP-RA as a compiled kernel, for problems where rest is allowed everywhere.

    The backward and the forward pass of Pham and Pham (IEEE T-RO 2018). Their linear programs
    have two variables, and rest keeps every row, so that the lower ends of the controllable sets
    are zero and each upper end is the root of a concave function. Of a motion that begins or ends
    moving, the ends of the solution are as fast as asked for, or as fast as can be.
    """

    def solve(self, rows: StageRows) -> Array:
        """Return the squared path velocity at every node; see Engine."""
        x_max = np.minimum(rows.x_max, HIGHEST)
        return checked(_solve(rows.s, rows.a, rows.b, x_max, *rows.ends))
