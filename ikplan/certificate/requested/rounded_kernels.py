"""Rounded corners, compiled: quintics, their length by quadrature, turns by quaternions."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Indices

__all__ = ["TURN", "RoundedStack", "nearest_parameter", "quintic_nodes", "rounded_rows"]

Quaternion = tuple[float, float, float, float]

TURN = 15
"""Numbers of a turn: whether there is one, quaternion and rate at the begin, and at the end."""
_GAUSS = np.polynomial.legendre.leggauss(8)
_X, _W = tuple(0.5 * (_GAUSS[0] + 1.0)), tuple(0.5 * _GAUSS[1])
"""Gauss points and weights on [0, 1]."""
_EXACT, _POINT, _LEVELS = 1e-10, 1e-12, 40
"""As for other curves: error allowed in a length, what counts as a point, most halvings."""
_STEP = 1e-5
"""Step of a difference over a parameter that goes from 0 to 1."""


class RoundedStack(NamedTuple):
    """Rounded corners as flat arrays.

    Attributes:
        c: Coefficients of the quintics, lowest power first, shape (n, 6, 3) [m].
        turn: How the tool turns, shape (n, TURN).
        first: Row of the first node of each, and the number of nodes, shape (n + 1,).
        t: Parameters of the nodes, shape (k,).
        s: Lengths of the nodes, shape (k,) [m].
    """

    c: Array
    turn: Array
    first: Indices
    t: Array
    s: Array


@leaf_kernel
def _velocity(c: Array, t: float) -> tuple[float, float, float]:
    x = c[1, 0] + t * (
        2.0 * c[2, 0] + t * (3.0 * c[3, 0] + t * (4.0 * c[4, 0] + t * 5.0 * c[5, 0]))
    )
    y = c[1, 1] + t * (
        2.0 * c[2, 1] + t * (3.0 * c[3, 1] + t * (4.0 * c[4, 1] + t * 5.0 * c[5, 1]))
    )
    z = c[1, 2] + t * (
        2.0 * c[2, 2] + t * (3.0 * c[3, 2] + t * (4.0 * c[4, 2] + t * 5.0 * c[5, 2]))
    )
    return x, y, z


@leaf_kernel
def _speed(c: Array, t: float) -> float:
    x, y, z = _velocity(c, t)
    return math.sqrt(x * x + y * y + z * z)


@leaf_kernel
def _between(c: Array, a: float, b: float) -> float:
    """Arc length from parameter a to b [m]."""
    total = 0.0
    for i in range(len(_X)):
        total += _W[i] * _speed(c, a + (b - a) * _X[i])
    return total * (b - a)


@leaf_kernel
def _parameter(a: RoundedStack, r: int, s: float) -> float:
    """Parameter at an arc length: Newton's method in a bracket."""
    c, first, end = a.c[r], a.first[r], a.first[r + 1] - 1
    k = first
    low, high = first, end
    while low < high:
        middle = (low + high) // 2
        if a.s[middle] <= s:
            k, low = middle, middle + 1
        else:
            high = middle
    k = min(k, end - 1)
    begin, below, above = a.t[k], a.t[k], a.t[k + 1]
    part, target = a.s[k + 1] - a.s[k], s - a.s[k]
    share = min(max(target / part, 0.0), 1.0) if part > 0.0 else 0.0
    t = below + (above - below) * share
    for _ in range(60):
        miss = _between(c, begin, t) - target
        if miss > 0.0:
            above = t
        else:
            below = t
        speed = _speed(c, t)
        found = abs(miss) <= 1e-13 * (1.0 + a.s[end])
        ahead = t - miss / speed if speed > 0.0 else below - 1.0
        if below <= ahead <= above:
            t = ahead
        elif not found:
            t = 0.5 * (below + above)
        if found:
            break
    return float(t)


@leaf_kernel
def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + bw * ax + ay * bz - az * by,
        aw * by + bw * ay + az * bx - ax * bz,
        aw * bz + bw * az + ax * by - ay * bx,
        aw * bw - ax * bx - ay * by - az * bz,
    )


@leaf_kernel
def _turned_by(x: float, y: float, z: float) -> Quaternion:
    """Quaternion of a rotation vector."""
    angle = math.sqrt(x * x + y * y + z * z)
    scale = math.sin(0.5 * angle) / angle if angle > 1e-150 else 0.5
    return scale * x, scale * y, scale * z, math.cos(0.5 * angle)


@leaf_kernel
def _vector_of(q: Quaternion) -> tuple[float, float, float]:
    """Rotation vector of a quaternion, no longer than pi."""
    x, y, z, w = q
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-150 else 2.0
    return scale * x, scale * y, scale * z


@leaf_kernel
def _turn_at(turn: Array, t: float) -> Quaternion:
    """Orientation between two even turns A and B: A exp(b log(A^-1 B)), b from 0 to 1."""
    a = _product(
        (turn[1], turn[2], turn[3], turn[4]), _turned_by(t * turn[5], t * turn[6], t * turn[7])
    )
    since = t - 1.0
    b = _product(
        (turn[8], turn[9], turn[10], turn[11]),
        _turned_by(since * turn[12], since * turn[13], since * turn[14]),
    )
    x, y, z = _vector_of(_product((-a[0], -a[1], -a[2], a[3]), b))
    share = t * t * t * (10.0 + t * (6.0 * t - 15.0))
    return _product(a, _turned_by(share * x, share * y, share * z))


@leaf_kernel
def rounded_rows(
    a: RoundedStack, row: Indices, s: Array, R: Array, p: Array, v: Array, w: Array
) -> None:
    """Write the motion on corner ``row[i]`` at length ``s[i]`` from its begin to row i.

    The angular rate is a difference, good to tell which way places lie.

    Args:
        a: The corners.
        row: Index of the corner, shape (m,).
        s: Length from its begin, shape (m,) [m].
        R: Out: rotations, shape (m, 3, 3); the identity where the orientation is free.
        p: Out: positions, shape (m, 3) [m].
        v: Out: dp/ds, shape (m, 3).
        w: Out: angular rates in the base, shape (m, 3) [rad/m].
    """
    for i in range(len(s)):
        r = row[i]
        c, turn = a.c[r], a.turn[r]
        t = _parameter(a, r, s[i])
        for j in range(3):
            p[i, j] = c[5, j]
            for k in range(4, -1, -1):
                p[i, j] = p[i, j] * t + c[k, j]
        v[i, 0], v[i, 1], v[i, 2] = _velocity(c, t)
        speed = math.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2)
        scale = speed if speed > 0.0 else 1.0
        for j in range(3):
            v[i, j] /= scale
            w[i, j] = 0.0
        x, y, z, real = 0.0, 0.0, 0.0, 1.0
        if turn[0] > 0.0:
            x, y, z, real = _turn_at(turn, t)
            behind, ahead = max(t - _STEP, 0.0), min(t + _STEP, 1.0)
            q = _turn_at(turn, behind)
            step = _vector_of(_product(_turn_at(turn, ahead), (-q[0], -q[1], -q[2], q[3])))
            for j in range(3):
                w[i, j] = step[j] / ((ahead - behind) * scale)
        two = 2.0 / (x * x + y * y + z * z + real * real)
        R[i, 0, 0] = 1.0 - two * (y * y + z * z)
        R[i, 1, 1] = 1.0 - two * (x * x + z * z)
        R[i, 2, 2] = 1.0 - two * (x * x + y * y)
        R[i, 0, 1], R[i, 1, 0] = two * (x * y - z * real), two * (x * y + z * real)
        R[i, 0, 2], R[i, 2, 0] = two * (x * z + y * real), two * (x * z - y * real)
        R[i, 1, 2], R[i, 2, 1] = two * (y * z - x * real), two * (y * z + x * real)


@kernel
def quintic_nodes(c: Array, parts: int) -> tuple[Array, Array]:
    """Return parameters and lengths between which quadrature gives the length of a quintic.

    Parts are halved until both halves together give what the whole gives.

    Args:
        c: Coefficients, shape (6, 3) [m].
        parts: Number of even parts that are begun with.

    Returns:
        Parameters of the nodes and the lengths up to them [m], both of shape (k + 1,).
    """
    whole = 0.0
    for i in range(parts):
        whole += _between(c, i / parts, (i + 1) / parts)
    t, s, size = np.empty(64), np.empty(64), 1
    t[0] = s[0] = 0.0
    waiting = np.empty((_LEVELS + 2, 3))
    for i in range(parts):
        waiting[0, 0], waiting[0, 1], waiting[0, 2] = i / parts, (i + 1) / parts, 0.0
        count = 1
        while count > 0:
            count -= 1
            a, b, level = waiting[count, 0], waiting[count, 1], waiting[count, 2]
            middle = 0.5 * (a + b)
            halves = _between(c, a, middle) + _between(c, middle, b)
            fits = abs(halves - _between(c, a, b)) <= _EXACT * halves
            if not (fits or halves <= _POINT * whole or level >= _LEVELS):
                waiting[count, 0], waiting[count, 1], waiting[count, 2] = middle, b, level + 1.0
                waiting[count + 1, 0], waiting[count + 1, 1] = a, middle
                waiting[count + 1, 2] = level + 1.0
                count += 2
                continue
            if size == len(t):
                t, s = np.concatenate((t, np.empty(size))), np.concatenate((s, np.empty(size)))
            t[size], s[size] = b, s[size - 1] + halves
            size += 1
    return t[:size].copy(), s[:size].copy()


@leaf_kernel
def nearest_parameter(c: Array, point: Array) -> float:
    """Return the parameter in [0, 1] at which a quintic is nearest to a point, shape (3,) [m].

    A grid of 65 places, then twelve finer ones of nine about the nearest.
    """
    low, high, count = 0.0, 1.0, 65
    for _ in range(12):
        best, at = math.inf, 0
        for i in range(count):
            t = low + (high - low) * i / (count - 1)
            away = 0.0
            for j in range(3):
                p = c[5, j]
                for k in range(4, -1, -1):
                    p = p * t + c[k, j]
                away += (p - point[j]) ** 2
            if away < best:
                best, at = away, i
        step = (high - low) / (count - 1)
        low, high = low + step * max(at - 1, 0), low + step * min(at + 1, count - 1)
        count = 9
    return 0.5 * (low + high)
