"""The shortest time along a motion played at another speed: an interior-point method, compiled."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.joint_path.evaluation import interval_of
from ikplan.timing.jerk.course_kernels import FIRST, spline_basis
from ikplan.timing.jerk.jerk_kernels import spread

__all__ = ["fastest_warp"]

_MAX_STEPS = 40
_HALVINGS = 30
# A squared speed within the limits as a share of that asked for, above which little is to do.
_NEAR = 0.8
# Where a motion exceeds limits it is slowed at first: by so much more than needed, over these
# multiples of the time in which accelerations build up, so many times.
_BELOW = 0.03
# On fewer intervals the whole is slowed and steps are halved: that costs little there, and its
# local optima are a little shorter.
_FEW = 1_500
_REACHES = (20.0, 60.0, 6.0)
_DIPS = 6
# How much of the way to the limits a step may go.
_WAY = 0.98


@kernel
def _time_and_room(
    c: Array,
    h: Array,
    value: Array,
    slope: Array,
    bend: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
) -> tuple[float, float]:
    """Return the time, and the logarithms of the room to the limits; outside them inf and 0.

    The merit is the time less mu times the other.
    """
    total, room = 0.0, 0.0
    n, p = value.shape[0], value.shape[1]
    for i in range(n):
        c0, c1, c2 = c[i], c[i + 1], c[i + 2]
        b2 = bend[i, 0] * c0 + bend[i, 1] * c1 + bend[i, 2] * c2
        for k in range(p):
            b = value[i, k, 0] * c0 + value[i, k, 1] * c1 + value[i, k, 2] * c2
            b1 = slope[i, k, 0] * c0 + slope[i, k, 1] * c1 + slope[i, k, 2] * c2
            if not b > 0.0:
                return np.inf, 0.0
            w = 1.0 / np.sqrt(b)
            total += 0.5 * h[i] * w
            product = 1.0
            if most[i, k] < np.inf:
                left = 1.0 - b / most[i, k]
                if not left > 0.0:
                    return np.inf, 0.0
                product *= left
            for j in range(rates.shape[2]):
                pull = rates[i, k, j, 0] * b + rates[i, k, j, 1] * b1
                left = 1.0 - pull * up[i, k, j]
                other = 1.0 - pull * down[i, k, j]
                if not (left > 0.0 and other > 0.0):
                    return np.inf, 0.0
                product *= left * other
                jerk = rates[i, k, j, 2] * b + rates[i, k, j, 3] * b1 + rates[i, k, j, 4] * b2
                if not abs(jerk) < w:
                    return np.inf, 0.0
                product *= w * w - jerk * jerk
                if not 1e-200 < product < 1e200:
                    room += np.log(product)
                    product = 1.0
            for r in range(rows_b.shape[2]):
                left = 1.0 - rows_b[i, k, r] * b - rows_d[i, k, r] * b1
                if not left > 0.0:
                    return np.inf, 0.0
                product *= left
                if product < 1e-200:
                    room += np.log(product)
                    product = 1.0
            room += np.log(product)
    return total, room


@kernel
def _newton(
    c: Array,
    mu: float,
    h: Array,
    value: Array,
    slope: Array,
    bend: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
) -> tuple[Array, float]:
    """Return a step that lowers the merit, and by how much it would if that were quadratic.

    The room to a jerk limit is not concave in the speed; its curvature is left out, which is the
    convex-concave procedure: the matrix is positive definite.
    """
    n, p = value.shape[0], value.shape[1]
    m = n + 2
    g, band = np.zeros(m), np.zeros((m, 3))
    for i in range(n):
        c0, c1, c2 = c[i], c[i + 1], c[i + 2]
        b2 = bend[i, 0] * c0 + bend[i, 1] * c1 + bend[i, 2] * c2
        for k in range(p):
            b = value[i, k, 0] * c0 + value[i, k, 1] * c1 + value[i, k, 2] * c2
            b1 = slope[i, k, 0] * c0 + slope[i, k, 1] * c1 + slope[i, k, 2] * c2
            w = 1.0 / np.sqrt(b)
            dw = -0.5 * w / b
            # Gradient and Hessian in the value, the slope and the bend of the spline, over mu.
            g0, g1, g2 = 0.5 * h[i] * dw / mu, 0.0, 0.0
            h00, h01, h02, h11, h12, h22 = -0.75 * h[i] * dw / (b * mu), 0.0, 0.0, 0.0, 0.0, 0.0
            if most[i, k] < np.inf:
                q = 1.0 / (most[i, k] - b)
                g0 += q
                h00 += q * q
            for j in range(rates.shape[2]):
                d0, d1 = rates[i, k, j, 0], rates[i, k, j, 1]
                pull = d0 * b + d1 * b1
                q, o = up[i, k, j], down[i, k, j]
                q, o = q / (1.0 - pull * q), o / (1.0 - pull * o)
                first, second = q + o, q * q + o * o
                g0 += first * d0
                g1 += first * d1
                h00 += second * d0 * d0
                h01 += second * d0 * d1
                h11 += second * d1 * d1
                e0, e1, e2 = rates[i, k, j, 2], rates[i, k, j, 3], rates[i, k, j, 4]
                jerk = e0 * b + e1 * b1 + e2 * b2
                q, o = 1.0 / (w - jerk), 1.0 / (w + jerk)
                first, second = q - o, q * q + o * o
                cross = (q * q - o * o) * dw
                g0 += first * e0 - (q + o) * dw
                g1 += first * e1
                g2 += first * e2
                h00 += second * (e0 * e0 + dw * dw) - 2.0 * cross * e0
                h01 += second * e0 * e1 - cross * e1
                h02 += second * e0 * e2 - cross * e2
                h11 += second * e1 * e1
                h12 += second * e1 * e2
                h22 += second * e2 * e2
            for r in range(rows_b.shape[2]):
                d0, d1 = rows_b[i, k, r], rows_d[i, k, r]
                q = 1.0 / (1.0 - d0 * b - d1 * b1)
                g0 += q * d0
                g1 += q * d1
                h00 += q * q * d0 * d0
                h01 += q * q * d0 * d1
                h11 += q * q * d1 * d1
            for x in range(3):
                vx, sx, bx = value[i, k, x], slope[i, k, x], bend[i, x]
                g[i + x] += mu * (g0 * vx + g1 * sx + g2 * bx)
                t0 = h00 * vx + h01 * sx + h02 * bx
                t1 = h01 * vx + h11 * sx + h12 * bx
                t2 = h02 * vx + h12 * sx + h22 * bx
                for y in range(x + 1):
                    band[i + x, x - y] += mu * (
                        t0 * value[i, k, y] + t1 * slope[i, k, y] + t2 * bend[i, y]
                    )
    # L D L^T of a matrix with two bands below the diagonal, and the solution.
    step = -g
    for i in range(m):
        for y in range(max(i - 2, 0), i):
            total = band[i, i - y]
            for z in range(max(i - 2, 0), y):
                total -= band[i, i - z] * band[y, y - z] * band[z, 0]
            band[i, i - y] = total / band[y, 0]
        for y in range(max(i - 2, 0), i):
            band[i, 0] -= band[i, i - y] * band[i, i - y] * band[y, 0]
            step[i] -= band[i, i - y] * step[y]
    for i in range(m):
        step[i] /= band[i, 0]
    for i in range(m - 1, -1, -1):
        for y in range(i + 1, min(i + 3, m)):
            step[i] -= band[y, y - i] * step[y]
    fall = 0.0
    for i in range(m):
        fall -= step[i] * g[i]
    return step, fall


@kernel
def _longest(
    c: Array,
    step: Array,
    value: Array,
    slope: Array,
    bend: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
) -> float:
    """Return how much of a step keeps inside the limits, at most 1.

    The room to a jerk limit is taken along its tangent, below which it does not fall.
    """
    largest = 0.0
    for i in range(value.shape[0]):
        c0, c1, c2 = c[i], c[i + 1], c[i + 2]
        d0, d1, d2 = step[i], step[i + 1], step[i + 2]
        b2 = bend[i, 0] * c0 + bend[i, 1] * c1 + bend[i, 2] * c2
        e2 = bend[i, 0] * d0 + bend[i, 1] * d1 + bend[i, 2] * d2
        for k in range(value.shape[1]):
            b = value[i, k, 0] * c0 + value[i, k, 1] * c1 + value[i, k, 2] * c2
            e = value[i, k, 0] * d0 + value[i, k, 1] * d1 + value[i, k, 2] * d2
            b1 = slope[i, k, 0] * c0 + slope[i, k, 1] * c1 + slope[i, k, 2] * c2
            e1 = slope[i, k, 0] * d0 + slope[i, k, 1] * d1 + slope[i, k, 2] * d2
            w = 1.0 / np.sqrt(b)
            dw = -0.5 * w / b * e
            largest = max(largest, -e / b)
            if most[i, k] < np.inf:
                largest = max(largest, e / (most[i, k] - b))
            for j in range(rates.shape[2]):
                pull = rates[i, k, j, 0] * b + rates[i, k, j, 1] * b1
                more = rates[i, k, j, 0] * e + rates[i, k, j, 1] * e1
                q = up[i, k, j] if more > 0.0 else down[i, k, j]
                largest = max(largest, more * q / (1.0 - pull * q))
                jerk = rates[i, k, j, 2] * b + rates[i, k, j, 3] * b1 + rates[i, k, j, 4] * b2
                change = rates[i, k, j, 2] * e + rates[i, k, j, 3] * e1 + rates[i, k, j, 4] * e2
                largest = max(largest, (change - dw) / (w - jerk), (-change - dw) / (w + jerk))
            for r in range(rows_b.shape[2]):
                left = 1.0 - rows_b[i, k, r] * b - rows_d[i, k, r] * b1
                largest = max(largest, (rows_b[i, k, r] * e + rows_d[i, k, r] * e1) / left)
    return min(1.0, _WAY / largest) if largest > 0.0 else 1.0


@kernel
def _excess(
    c: Array,
    value: Array,
    slope: Array,
    bend: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
) -> Array:
    """Return by what factor the squared speed is too high, interval by interval, shape (n,)."""
    n = value.shape[0]
    found = np.zeros(n)
    for i in range(n):
        c0, c1, c2 = c[i], c[i + 1], c[i + 2]
        b2 = bend[i, 0] * c0 + bend[i, 1] * c1 + bend[i, 2] * c2
        for k in range(value.shape[1]):
            b = value[i, k, 0] * c0 + value[i, k, 1] * c1 + value[i, k, 2] * c2
            b1 = slope[i, k, 0] * c0 + slope[i, k, 1] * c1 + slope[i, k, 2] * c2
            if not b > 0.0:
                found[i] = np.inf
                continue
            top, top_jerk = b / most[i, k], 0.0
            for j in range(rates.shape[2]):
                pull = rates[i, k, j, 0] * b + rates[i, k, j, 1] * b1
                top = max(top, pull * up[i, k, j], pull * down[i, k, j])
                jerk = rates[i, k, j, 2] * b + rates[i, k, j, 3] * b1 + rates[i, k, j, 4] * b2
                top_jerk = max(top_jerk, abs(jerk))
            for r in range(rows_b.shape[2]):
                top = max(top, rows_b[i, k, r] * b + rows_d[i, k, r] * b1)
            found[i] = max(found[i], top, np.cbrt(np.square(top_jerk) * b))
    return found


@kernel
def _running_mean(values: Array, tau: Array, reach: float) -> Array:
    """Return the means of values over a reach each way, the ends going on for ever, shape (n,)."""
    n = len(values)
    below = np.zeros(n + 1)
    for i in range(n):
        below[i + 1] = below[i] + values[i] * (tau[i + 1] - tau[i])
    out = np.empty(n)
    for i in range(n):
        middle = 0.5 * (tau[i] + tau[i + 1])
        ends = np.empty(2)
        for side in range(2):
            at = middle + (reach if side == 1 else -reach)
            if at <= tau[0]:
                ends[side] = values[0] * (at - tau[0])
            elif at >= tau[n]:
                ends[side] = below[n] + values[n - 1] * (at - tau[n])
            else:
                k = interval_of(tau, at)
                ends[side] = below[k] + values[k] * (at - tau[k])
        out[i] = (ends[1] - ends[0]) / (2.0 * reach)
    return out


@kernel
def _dipped(excess: Array, tau: Array, reach: float) -> Array:
    """Return logarithms of what to slow a motion by: smooth, at least what is asked, (n,)."""
    needed = np.zeros(len(excess))
    for i in range(len(excess)):
        if excess[i] > 1.0 - 0.5 * _BELOW:
            needed[i] = np.log(min(excess[i], 10.0)) + _BELOW
    wide = spread(needed, tau, reach)
    for _ in range(3):
        wide = _running_mean(wide, tau, reach / 3.0)
    return wide


@kernel
def _begin(
    tau: Array,
    value: Array,
    slope: Array,
    bend: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
    swing: float,
) -> Array:
    """Return coefficients within the limits, slowed smoothly about the places that exceed them.

    The arguments are those of fastest_warp.

    Returns:
        Coefficients, shape (n + 2,); where smooth dips do not do, the whole is slowed; all zero
        where not even that does.
    """
    n = len(tau) - 1
    for reach in _REACHES:
        if n <= _FEW or reach * swing > 0.25:
            break
        slower = np.zeros(n)
        for _ in range(_DIPS):
            c = np.empty(n + 2)
            for i in range(n + 2):
                c[i] = 0.98 * np.exp(-0.5 * (slower[max(i - 2, 0)] + slower[min(i, n - 1)]))
            excess = _excess(c, value, slope, bend, rates, most, up, down, rows_b, rows_d)
            if excess.max() < 0.999:
                return c
            if not excess.max() < np.inf:
                break
            slower += _dipped(excess, tau, reach * swing)
    c = np.full(n + 2, 0.98)
    for _ in range(100):
        excess = _excess(c, value, slope, bend, rates, most, up, down, rows_b, rows_d)
        if excess.max() < 1.0:
            return c
        c *= 0.9
    return np.zeros(n + 2)


@kernel
def fastest_warp(
    tau: Array,
    rates: Array,
    most: Array,
    up: Array,
    down: Array,
    rows_b: Array,
    rows_d: Array,
    weights: tuple[float, float, float],
    shrink: float,
    swing: float,
) -> Array:
    """Play a motion as fast as limits allow, at a speed that varies along it.

    A motion r(tau) is played at tau(t). With b = (dtau/dt)^2, velocities are r' sqrt(b),
    accelerations r'' b + r' b' / 2, and jerks sqrt(b) (r''' b + 3 r'' b' / 2 + r' b'' / 2). b is
    a quadratic spline; the time is the integral of b^(-1/2). A barrier of logarithms keeps the
    limits.

    Args:
        tau: Knots of the spline, shape (n + 1,), strictly increasing.
        rates: At two points of each interval, for each joint: r'', r' / 2, and, over
            the jerk limit, r''', 3 r'' / 2 and r' / 2; shape (n, 2, dof, 5).
        most: Upper bounds of b there, shape (n, 2).
        up: Inverse of the upper acceleration limits, shape (n, 2, dof); 0: none is looked at.
        down: Inverse of the lower ones, shape (n, 2, dof), not positive.
        rows_b: Further limits p b + d b' <= 1: p, shape (n, 2, rows).
        rows_d: d, shape (n, 2, rows).
        weights: First weight of the barrier for a motion that exceeds limits by much, first
            weight for another, and last weight.
        shrink: Factor from one to the next, below 1.
        swing: About the time in which accelerations build up, as a share of the duration.

    Returns:
        The coefficients of b, shape (n + 2,); all zero where not even a slow motion keeps the
        limits.
    """
    h = np.diff(tau)
    value, slope, bend = spline_basis(tau, np.array([FIRST, 1.0 - FIRST]))
    c = _begin(tau, value, slope, bend, rates, most, up, down, rows_b, rows_d, swing)
    mu, again_mu, last_mu = weights
    total, room = _time_and_room(c, h, value, slope, bend, rates, most, up, down, rows_b, rows_d)
    if not total < np.inf:
        return np.zeros(len(c))
    if c.max() > _NEAR:
        mu = again_mu
    while True:
        merit = total - mu * room
        for _ in range(_MAX_STEPS):
            step, fall = _newton(
                c, mu, h, value, slope, bend, rates, most, up, down, rows_b, rows_d
            )
            if not fall > 0.02 * mu * len(h):
                break
            size, moved = 1.0, False
            if len(h) > _FEW:
                size = _longest(c, step, value, slope, bend, rates, most, up, down, rows_b, rows_d)
            for _ in range(_HALVINGS):
                trial = c + size * step
                new_total, new_room = _time_and_room(
                    trial, h, value, slope, bend, rates, most, up, down, rows_b, rows_d
                )
                new = new_total - mu * new_room
                if new < merit - 1e-3 * size * fall:
                    moved = True
                    break
                size *= 0.5
            if not moved:
                break
            c, merit, total, room = trial, new, new_total, new_room
        if mu <= last_mu:
            return c
        mu = max(mu * shrink, last_mu)
