"""The limits of the joints as linear rows in path acceleration and squared path velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Indices
from ikplan.timing.limit_ratios import velocity_ratio

__all__ = [
    "StageRows",
    "acceleration_rows",
    "interval_unit",
    "natural_units",
    "place_rows",
    "velocity_bounds",
]

# What is compared instead of dividing may be off by rounding.
_ROUNDING = 1.0 - 1e-12
# About how many intervals are looked at for the natural unit.
_SOME = 64


@dataclass(frozen=True, eq=False)
class StageRows:
    """Constraints a u + b x <= 1 in each interval and x <= x_max at each node.

    u is the second time derivative of s, constant in an interval, and x the square of the first
    at the interval's start; x at the interval's end is x + 2 u h. Rest (x = 0, u = 0) keeps all.

    Attributes:
        s: Path positions of the nodes, shape (n + 1,).
        a: Coefficients of u, shape (n, m).
        b: Coefficients of x, shape (n, m).
        x_max: Upper bounds of x at the nodes, shape (n + 1,).
        ends: x at the first and at the last node; zero: the motion begins or ends at rest.
    """

    s: Array
    a: Array
    b: Array
    x_max: Array
    ends: tuple[float, float] = (0.0, 0.0)


@leaf_kernel
def _of_u(h: float, qs: float, qss0: float, qss1: float) -> tuple[float, float, float]:
    """Return the coefficients of u in a joint's acceleration on an interval, as Bezier values."""
    end = qs + 0.5 * h * (qss0 + qss1)
    return qs, qs + 1.5 * h * qss0, end + 2.0 * h * qss1


@kernel
def acceleration_rows(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    upper: Array,
    lower: Array,
    a: Array,
    b: Array,
) -> None:
    """Write rows that bound the joint accelerations over whole intervals.

    On an interval of a cubic path with constant path acceleration, a joint's acceleration is a
    quadratic in s. Its three Bezier coefficients are linear in (u, x); bounding them bounds the
    acceleration over the whole interval, and not at its ends alone.

    Args:
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        pieces: Piece of each interval, shape (n,).
        upper: Upper acceleration limits of the pieces, shape (k, dof).
        lower: Lower acceleration limits of the pieces, shape (k, dof), negative.
        a: Out: coefficients of u in rows a u + b x <= 1, in the first 6 dof columns.
        b: Out: coefficients of x.
    """
    n, dof = qs0.shape
    for i in range(n):
        k = pieces[i]
        for j in range(dof):
            c0, c1 = qss0[i, j], qss1[i, j]
            first, middle, last = _of_u(h[i], qs0[i, j], c0, c1)
            for side in range(2):
                scale = 1.0 / upper[k, j] if side == 0 else 1.0 / lower[k, j]
                row = 3 * (2 * j + side)
                a[i, row], b[i, row] = first * scale, c0 * scale
                a[i, row + 1] = middle * scale
                b[i, row + 1] = 0.5 * (c0 + c1) * scale
                a[i, row + 2] = last * scale
                b[i, row + 2] = c1 * scale


@kernel
def _largest_slopes(h: float, qs: float, qss0: float, qss1: float) -> tuple[float, float]:
    """Return the greatest and the least dq/ds on an interval, zero where none has the sign."""
    end = qs + 0.5 * h * (qss0 + qss1)
    inner = qs + 0.5 * h * qss0 * qss0 / (qss0 - qss1) if qss0 * qss1 < 0.0 else qs
    return max(qs, end, inner, 0.0), min(qs, end, inner, 0.0)


@kernel
def _may_bind(
    h: float, qs: float, qss0: float, end: float, x0: float, x1: float, up: float, down: float
) -> bool:
    """Whether a joint may reach a velocity limit on an interval, x up to its values at the ends.

    The Bezier coefficients of dq/ds bound it.
    """
    slope = max(abs(qs), abs(qs + 0.5 * h * qss0), abs(end))
    return not slope * slope * max(x0, x1) < _ROUNDING * min(up * up, down * down)


@kernel
def velocity_bounds(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    velocity: Array,
    velocity_lower: Array,
) -> Array:
    """Bound the squared path velocity at the nodes so that no joint is too fast between them.

    x is linear between nodes. The bounds are first those of the nodes themselves; where the line
    between two of them breaks a velocity limit in the interval, both are lowered to what fits.
    Any x below the bounds is then below a line that keeps every limit.

    Args:
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        pieces: Piece of each interval, shape (n,).
        velocity: Upper velocity limits of the pieces, shape (k, dof).
        velocity_lower: Lower velocity limits of the pieces, shape (k, dof), negative.

    Returns:
        Upper bounds of x, shape (n + 1,).
    """
    n, dof = qs0.shape
    x_max = np.full(n + 1, np.inf)
    for i in range(n):
        piece = pieces[i]
        for j in range(dof):
            up, down = velocity[piece, j], velocity_lower[piece, j]
            end = qs0[i, j] + 0.5 * h[i] * (qss0[i, j] + qss1[i, j])
            if not _may_bind(h[i], qs0[i, j], qss0[i, j], end, x_max[i], x_max[i + 1], up, down):
                continue
            for node, qs in ((i, qs0[i, j]), (i + 1, end)):
                limit = up if qs > 0.0 else down
                if qs != 0.0:
                    root = limit / qs
                    x_max[node] = min(x_max[node], root * root)
            # A node where the joints stand still would else allow any speed.
            rise, fall = _largest_slopes(h[i], qs0[i, j], qss0[i, j], qss1[i, j])
            for slope, limit in ((rise, up), (fall, down)):
                if slope != 0.0:
                    root = limit / slope
                    for node in (i, i + 1):
                        x_max[node] = min(x_max[node], 4.0 * root * root)
    ratio = np.ones(n + 1)
    for i in range(n):
        highest = max(x_max[i], x_max[i + 1])
        if not np.isfinite(highest):
            continue
        piece = pieces[i]
        u = (x_max[i + 1] - x_max[i]) / (2.0 * h[i])
        for j in range(dof):
            up, down = velocity[piece, j], velocity_lower[piece, j]
            end = qs0[i, j] + 0.5 * h[i] * (qss0[i, j] + qss1[i, j])
            # Most joints are far from their limits, and need no closer look.
            if not _may_bind(h[i], qs0[i, j], qss0[i, j], end, x_max[i], x_max[i + 1], up, down):
                continue
            rise, fall = _largest_slopes(h[i], qs0[i, j], qss0[i, j], qss1[i, j])
            if max(rise / up, fall / down) ** 2 * highest > 1.0:
                largest = velocity_ratio(
                    h[i], x_max[i], u, qs0[i, j], qss0[i, j], qss1[i, j], up, down
                )
                ratio[i], ratio[i + 1] = max(ratio[i], largest), max(ratio[i + 1], largest)
    for i in range(n + 1):
        x_max[i] /= ratio[i] * ratio[i]
    return x_max


@kernel
def place_rows(
    a: Array, b: Array, of_u: Array, of_x: Array, inside: Indices, at: Indices, h: Array, first: int
) -> None:
    """Write rows at nodes, a u + b x <= 1, as rows at the starts and the ends of intervals.

    Args:
        a: Coefficients of u, shape (n, m); changed in place.
        b: Coefficients of x at the starts of the intervals, shape (n, m); changed in place.
        of_u: Coefficients of u at nodes, shape (k, r).
        of_x: Coefficients of x at nodes, shape (k, r).
        inside: The intervals, shape (p,).
        at: Nodes at the starts and at the ends of those, shape (2, p).
        h: Lengths of all intervals, shape (n,).
        first: The first column.
    """
    r = of_u.shape[1]
    for i in range(len(inside)):
        row, start, end = inside[i], at[0, i], at[1, i]
        for k in range(r):
            a[row, first + k], b[row, first + k] = of_u[start, k], of_x[start, k]
            a[row, first + r + k] = of_u[end, k] + 2.0 * h[row] * of_x[end, k]
            b[row, first + r + k] = of_x[end, k]


@leaf_kernel
def _largest_of_u(
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    upper: Array,
    lower: Array,
    step: int,
    out: Array,
) -> None:
    """Write the largest coefficient of u of every so many intervals; see acceleration_rows."""
    for m in range(len(out)):
        i = m * step
        k, largest = pieces[i], 0.0
        for j in range(qs0.shape[1]):
            coefficients = _of_u(h[i], qs0[i, j], qss0[i, j], qss1[i, j])
            for scale in (1.0 / upper[k, j], 1.0 / lower[k, j]):
                for coefficient in coefficients:
                    largest = max(largest, abs(coefficient * scale))
        out[m] = largest


def interval_unit(
    length: float,
    x_max: Array,
    h: Array,
    qs0: Array,
    qss0: Array,
    qss1: Array,
    pieces: Indices,
    upper: Array,
    lower: Array,
) -> float:
    """Return the unit of :func:`natural_units` of intervals whose rows are not written out.

    Args:
        length: Length of the span.
        x_max: Upper bounds of x at the nodes, shape (n + 1,).
        h: Lengths of the intervals, shape (n,).
        qs0: dq/ds at the starts, shape (n, dof).
        qss0: d2q/ds2 at the starts, shape (n, dof).
        qss1: d2q/ds2 at the ends, shape (n, dof).
        pieces: Piece of each interval, shape (n,).
        upper: Upper acceleration limits of the pieces, shape (k, dof).
        lower: Lower acceleration limits of the pieces, shape (k, dof), negative.
    """
    step = max(1, len(h) // _SOME)
    slopes = np.empty((len(h) + step - 1) // step)
    _largest_of_u(h, qs0, qss0, qss1, pieces, upper, lower, step, slopes)
    return _unit(length, x_max, slopes)


def _unit(length: float, x_max: Array, slopes: Array) -> float:
    """Return the natural unit; ``slopes`` are the largest coefficients of u of some intervals."""
    finite = x_max[np.isfinite(x_max)]
    by_velocity = _median(finite) if len(finite) else np.inf
    slope = _median(slopes)
    by_acceleration = length / slope if slope > 0.0 else np.inf
    unit = min(by_velocity, by_acceleration)
    return unit if np.isfinite(unit) else 1.0


def _median(values: Array) -> float:
    """Return the median, as numpy does in four times the time; no value is NaN."""
    middle = len(values) // 2
    if len(values) % 2:
        return float(np.partition(values, middle)[middle])
    ordered = np.partition(values, (middle - 1, middle))
    return 0.5 * (float(ordered[middle - 1]) + float(ordered[middle]))


def natural_units(rows: StageRows) -> tuple[StageRows, float]:
    """Scale a problem so that lengths, speeds and accelerations are about one.

    toppra's solver has absolute tolerances, so that a motion of 1e-9 rad drowns in them.

    Args:
        rows: The problem; its coefficients are scaled where they are.

    Returns:
        The scaled problem, and the factor that turns its x into the caller's.
    """
    length = float(rows.s[-1] - rows.s[0])
    some = rows.a[:: max(1, len(rows.a) // _SOME)]
    unit = _unit(length, rows.x_max, np.abs(some).max(axis=1))
    s = (rows.s - rows.s[0]) / length
    a, b = rows.a, rows.b
    a *= unit / length
    b *= unit
    ends = (rows.ends[0] / unit, rows.ends[1] / unit)
    return StageRows(s, a, b, rows.x_max / unit, ends), unit
