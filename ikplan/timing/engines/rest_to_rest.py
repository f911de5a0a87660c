"""TOPP-RA over many spans from rest to rest, under limits of the joints alone.

What the compiled engine finds on the rows of such spans, found without writing the rows down: of
the 6 dof rows of an interval only a few can bind at any speed, and only those are looked at again.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.timing.engines.compiled_engine import FLOOR, NO_MATTER

__all__ = ["spans_at_limit", "time_rest_to_rest"]

# A row is left out where it is above another one by this share at both ends of the range of x.
_CLEAR = 1e-9


@leaf_kernel
def _that_bind(
    side: float,
    m: int,
    a: Array,
    b: Array,
    at_rest: Array,
    at_top: Array,
    out_a: Array,
    out_b: Array,
    begin: int,
) -> int:
    """Keep the rows that may bound u from above (side 1) or below (side -1); where they end.

    Each is a line u(x) between its values at x = 0 and at the highest x. One that is beyond
    another one at both ends is beyond it in between.
    """
    first, last = -1, -1
    for r in range(m):
        if side * a[r] > 0.0:
            if first < 0 or side * at_rest[r] < side * at_rest[first]:
                first = r
            if last < 0 or side * at_top[r] < side * at_top[last]:
                last = r
    if first < 0:
        return begin
    size = _CLEAR * max(
        abs(at_rest[first]), abs(at_rest[last]), abs(at_top[first]), abs(at_top[last])
    )
    rest_0, top_0 = side * at_rest[first] + size, side * at_top[first] + size
    rest_1, top_1 = side * at_rest[last] + size, side * at_top[last] + size
    count = begin
    for r in range(m):
        if side * a[r] > 0.0:
            rest, top = side * at_rest[r], side * at_top[r]
            if not ((rest > rest_0 and top > top_0) or (rest > rest_1 and top > top_1)):
                out_a[count], out_b[count] = a[r], b[r]
                count += 1
    return count


@leaf_kernel
def _joints_that_bind(
    i: int,
    h: float,
    top: float,
    per_u: float,
    per_x: float,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    scale_up: Array,
    scale_down: Array,
    may: Flags,
) -> float:
    """Mark the joints whose acceleration may bind at some x up to top; the largest |a| of a row.

    The joint that the path asks most of bounds |u| by some U at every x. Another joint whose
    rows hold for all |u| up to U and all x up to top binds nowhere.
    """
    dof = qs0.shape[1]
    most, widest, of_most = 0.0, 0.0, -1
    for j in range(dof):
        qs, c0, c1 = qs0[i, j], qss0[i, j], qss1[i, j]
        end = qs + 0.5 * h * (c0 + c1)
        size = max(abs(qs), abs(qs + 1.5 * h * c0), abs(end + 2.0 * h * c1))
        scale = max(scale_up[j], -scale_down[j])
        widest = max(widest, size * scale)
        if abs(qs) * scale > most:
            most, of_most = abs(qs) * scale, j
    largest = np.inf
    if of_most >= 0:
        qs, c0 = qs0[i, of_most], qss0[i, of_most]
        # u <= (1 - b x) / a on one side of the joint, and on the other u >= that.
        up, down = scale_up[of_most], -scale_down[of_most]
        slowest = abs(qs) * min(up, down) * per_u
        if slowest > NO_MATTER * widest * per_u:
            largest = (1.0 + abs(c0) * max(up, down) * per_x * top) / slowest
    for j in range(dof):
        qs, c0, c1 = qs0[i, j], qss0[i, j], qss1[i, j]
        end = qs + 0.5 * h * (c0 + c1)
        size = max(abs(qs), abs(qs + 1.5 * h * c0), abs(end + 2.0 * h * c1))
        scale = max(scale_up[j], -scale_down[j])
        of_x = max(abs(c0), abs(c1)) * per_x * top
        may[j] = not (size * per_u * largest + of_x) * scale < 1.0 - _CLEAR
    return widest * per_u


@leaf_kernel
def _rows_of(
    i: int,
    h: float,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    scale_up: Array,
    scale_down: Array,
    may: Flags,
    least: float,
    per_u: float,
    per_x: float,
    a: Array,
    b: Array,
) -> int:
    """Write the rows of the joints that may bind, see interval_rows; how many."""
    row = 0
    for j in range(qs0.shape[1]):
        if not may[j]:
            continue
        qs, c0, c1 = qs0[i, j], qss0[i, j], qss1[i, j]
        end = qs + 0.5 * h * (c0 + c1)
        for side in range(2):
            scale = scale_up[j] if side == 0 else scale_down[j]
            a[row], b[row] = qs * scale, c0 * scale
            a[row + 1], b[row + 1] = (qs + 1.5 * h * c0) * scale, 0.5 * (c0 + c1) * scale
            a[row + 2], b[row + 2] = (end + 2.0 * h * c1) * scale, c1 * scale
            row += 3
    for r in range(row):
        a[r] *= per_u
        b[r] *= per_x
        # As the compiled engine: such a row bounds x alone.
        if abs(a[r]) < least:
            a[r] = 0.0
    return row


@leaf_kernel
def _highest(
    x: float,
    x_next: float,
    h: float,
    at_rest: float,
    high_a: Array,
    high_b: Array,
    begin: int,
    end: int,
    low_a: Array,
    low_b: Array,
    lows: int,
    tries: int,
) -> float:
    """Return the greatest controllable x, see largest_controllable of the compiled engine."""
    floor = min(FLOOR * x_next, 2.0 * h * at_rest)
    p_floor, p_next, g_next = floor / (2.0 * h), x_next / (2.0 * h), -1.0 / (2.0 * h)
    for _ in range(tries):
        low, high, low_row, high_row = -np.inf, np.inf, -1, -1
        for r in range(begin, end):
            u = (1.0 - high_b[r] * x) / high_a[r]
            if u < high:
                high, high_row = u, r
        for r in range(lows):
            u = (1.0 - low_b[r] * x) / low_a[r]
            if u > low:
                low, low_row = u, r
        p_low, g_low, p_high, g_high = p_floor, g_next, p_next, g_next
        if low_row >= 0 and low >= p_low + g_low * x:
            p_low, g_low = 1.0 / low_a[low_row], -low_b[low_row] / low_a[low_row]
        if high_row >= 0 and high <= p_high + g_high * x:
            p_high, g_high = 1.0 / high_a[high_row], -high_b[high_row] / high_a[high_row]
        slope = g_high - g_low
        if p_high - p_low + slope * x >= 0.0 or slope >= 0.0:
            return x
        following = (p_low - p_high) / slope
        if not following < x:
            return max(following, 0.0)
        x = max(following, 0.0)
    return x


@kernel
def time_rest_to_rest(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    upper: Array,
    lower: Array,
    s: Array,
    unit: float,
    length: float,
    x_max: Array,
    ends: Indices,
    wanted: Flags,
    x: Array,
) -> None:
    """Write the highest squared path velocities of spans, each from rest to rest.

    In units of their own: lengths by ``length``, x by ``unit``; see natural_units.

    Args:
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        pieces: Piece of each interval, shape (n,).
        upper: Upper acceleration limits of the pieces, shape (k, dof).
        lower: Lower acceleration limits of the pieces, shape (k, dof), negative.
        s: Nodes in units of the length, shape (n + 1,).
        unit: Unit of x.
        length: Unit of lengths.
        x_max: Upper bounds of x at the nodes in its unit, shape (n + 1,), finite.
        ends: First interval of each span, and n, shape (r + 1,).
        wanted: Which spans, shape (r,).
        x: Out: at the nodes of those spans, in its unit, shape (n + 1,).
    """
    dof = qs0.shape[1]
    m, longest, known = 6 * dof, 0, -1
    per_u, per_x = unit / length, unit
    for span in range(len(wanted)):
        longest = max(longest, ends[span + 1] - ends[span])
    a, b, at_rest, at_top = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    scale_up, scale_down, may = np.empty(dof), np.empty(dof), np.empty(dof, np.bool_)
    low_a, low_b = np.empty(m), np.empty(m)
    # The rows that bound u from above, for the forward pass; of most intervals a few.
    high_a, high_b = np.empty(longest * m), np.empty(longest * m)
    begin, count = np.empty(longest, np.int64), np.empty(longest, np.int64)
    for span in range(len(wanted)):
        if not wanted[span]:
            continue
        first, last = ends[span], ends[span + 1]
        used = 0
        x[last] = 0.0
        for i in range(last - 1, first - 1, -1):
            if pieces[i] != known:
                known = pieces[i]
                for j in range(dof):
                    scale_up[j], scale_down[j] = 1.0 / upper[known, j], 1.0 / lower[known, j]
            top = 0.0 if i == first else x_max[i]
            widest = _joints_that_bind(
                i, h[i], top, per_u, per_x, qs0, qss0, qss1, scale_up, scale_down, may
            )
            rows = _rows_of(
                i, h[i], qs0, qss0, qss1, scale_up, scale_down, may, NO_MATTER * widest,
                per_u, per_x, a, b
            )  # fmt: skip
            for r in range(rows):
                if a[r] == 0.0 and b[r] > 0.0:
                    top = min(top, 1.0 / b[r])
            for r in range(rows):
                at_rest[r] = 1.0 / a[r]
                at_top[r] = (1.0 - b[r] * top) / a[r]
            end = _that_bind(1.0, rows, a, b, at_rest, at_top, high_a, high_b, used)
            lows = _that_bind(-1.0, rows, a, b, at_rest, at_top, low_a, low_b, 0)
            high_at_rest = np.inf
            for r in range(used, end):
                high_at_rest = min(high_at_rest, 1.0 / high_a[r])
            x[i] = _highest(
                top, x[i + 1], s[i + 1] - s[i], high_at_rest, high_a, high_b, used, end,
                low_a, low_b, lows, 4 * m + 8
            )  # fmt: skip
            begin[i - first], count[i - first] = used, end - used
            used = end
        for i in range(first, last):
            high = np.inf
            at = begin[i - first]
            for r in range(at, at + count[i - first]):
                high = min(high, (1.0 - high_b[r] * x[i]) / high_a[r])
            x[i + 1] = min(max(x[i] + 2.0 * (s[i + 1] - s[i]) * high, 0.0), x[i + 1])


@kernel
def spans_at_limit(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    upper: Array,
    lower: Array,
    joint: int,
    x: Array,
    x_max: Array,
    wider: Array,
    ends: Indices,
) -> Flags:
    """Return which spans are held by a limit of a joint; the others are as fast without it.

    Args:
        h: As in time_rest_to_rest.
        qs0: As in time_rest_to_rest.
        qss0: As in time_rest_to_rest.
        qss1: As in time_rest_to_rest.
        pieces: As in time_rest_to_rest.
        upper: As in time_rest_to_rest.
        lower: As in time_rest_to_rest.
        joint: The joint whose acceleration limit is widened; -1: none is.
        x: The highest squared path velocities, shape (n + 1,).
        x_max: Their upper bounds, shape (n + 1,).
        wider: The upper bounds with the limit widened, shape (n + 1,).
        ends: As in time_rest_to_rest.

    Returns:
        Flags, shape (r,).
    """
    held = np.zeros(len(ends) - 1, np.bool_)
    most = 1.0 - _CLEAR
    for span in range(len(held)):
        first, last = ends[span], ends[span + 1]
        for i in range(first, last):
            k, d = pieces[i], h[i]
            if x_max[i] < wider[i] and x[i] > most * x_max[i]:
                held[span] = True
            if joint >= 0:
                u = (x[i + 1] - x[i]) / (2.0 * d)
                qs, c0, c1 = qs0[i, joint], qss0[i, joint], qss1[i, joint]
                end = qs + 0.5 * d * (c0 + c1)
                start = qs * u + c0 * x[i]
                inner = (qs + 1.5 * d * c0) * u + 0.5 * (c0 + c1) * x[i]
                later = (end + 2.0 * d * c1) * u + c1 * x[i]
                if max(start, inner, later) > most * upper[k, joint]:
                    held[span] = True
                if min(start, inner, later) < most * lower[k, joint]:
                    held[span] = True
            if held[span]:
                break
    return held
