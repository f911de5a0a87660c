"""Newton's step on the barrier that keeps a motion played at another speed inside its limits."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.timing.jerk.barrier_lanes import (
    BLOCK,
    DW,
    G0,
    G1,
    G2,
    H00,
    H01,
    H02,
    H11,
    H12,
    H22,
    ROWS,
    B,
    SpeedSpline,
    W,
    WarpLimits,
    joint_derivatives,
    row_derivatives,
    speeds,
)

__all__ = ["newton_step"]


@kernel
def newton_step(
    c: Array, mu: float, spline: SpeedSpline, limits: WarpLimits
) -> tuple[Array, float]:
    """Return a step that lowers the merit, and by how much it would if that were quadratic.

    The room to a jerk limit is not concave in the speed; its curvature is left out, which is the
    convex-concave procedure: the matrix is positive definite.
    """
    n = len(spline.h)
    g, band = np.zeros(n + 2), np.zeros((3, n + 2))
    work = np.empty((2, ROWS * BLOCK))
    for i in range(0, n, BLOCK):
        size = min(BLOCK, n - i)
        for k in range(2):
            speeds(spline, c, k, i, work, B)
            s, most, h = work[k], limits.most[k, i : i + size], spline.h[i : i + size]
            s[G0:] = 0.0
            for t in range(size):
                b = s[B + t]
                w = 1.0 / np.sqrt(b)
                dw = -0.5 * w / b
                s[W + t], s[DW + t] = w, dw
                # Over mu, and so is what joints and rows add.
                q = 1.0 / (most[t] - b)
                s[G0 + t] = 0.5 * h[t] * dw / mu + q
                s[H00 + t] = -0.75 * h[t] * dw / (b * mu) + q * q
            joint_derivatives(limits, k, i, work)
            row_derivatives(limits, k, i, work)
        _assemble(mu, spline, i, work, g, band)
    return _solved(g, band)


@kernel
def _assemble(mu: float, spline: SpeedSpline, i: int, work: Array, g: Array, band: Array) -> None:
    """Add derivatives at both points of a block of intervals to gradient and matrix."""
    size = min(BLOCK, len(spline.h) - i)
    end = i + size
    # The later function of an interval first: so each coefficient's terms come in their order.
    for x in range(2, -1, -1):
        out, bx = g[i + x : end + x], spline.bend[x, i:end]
        for k in range(2):
            s, vx, sx = work[k], spline.value[k, x, i:end], spline.slope[k, x, i:end]
            for t in range(size):
                out[t] += mu * (s[G0 + t] * vx[t] + s[G1 + t] * sx[t] + s[G2 + t] * bx[t])
        for y in range(x + 1):
            line, by = band[x - y, i + x : end + x], spline.bend[y, i:end]
            for k in range(2):
                s, vx, sx = work[k], spline.value[k, x, i:end], spline.slope[k, x, i:end]
                vy, sy = spline.value[k, y, i:end], spline.slope[k, y, i:end]
                for t in range(size):
                    t0 = s[H00 + t] * vx[t] + s[H01 + t] * sx[t] + s[H02 + t] * bx[t]
                    t1 = s[H01 + t] * vx[t] + s[H11 + t] * sx[t] + s[H12 + t] * bx[t]
                    t2 = s[H02 + t] * vx[t] + s[H12 + t] * sx[t] + s[H22 + t] * bx[t]
                    line[t] += mu * (t0 * vy[t] + t1 * sy[t] + t2 * by[t])


@kernel
def _solved(g: Array, band: Array) -> tuple[Array, float]:
    """Solve for a step against a gradient by L D L^T, two bands below the diagonal.

    Args:
        g: The gradient, shape (m,).
        band: Diagonal, first and second band below it, at the row of each entry, shape (3, m);
            overwritten.

    Returns:
        The step, and what it would lower the merit by.
    """
    step, m = -g, len(g)
    for i in range(m):
        for y in range(max(i - 2, 0), i):
            total = band[i - y, i]
            for z in range(max(i - 2, 0), y):
                total -= band[i - z, i] * band[y - z, y] * band[0, z]
            band[i - y, i] = total / band[0, y]
        for y in range(max(i - 2, 0), i):
            band[0, i] -= band[i - y, i] * band[i - y, i] * band[0, y]
            step[i] -= band[i - y, i] * step[y]
    for i in range(m):
        step[i] /= band[0, i]
    for i in range(m - 1, -1, -1):
        for y in range(i + 1, min(i + 3, m)):
            step[i] -= band[y - i, y] * step[y]
    fall = 0.0
    for i in range(m):
        fall -= step[i] * g[i]
    return step, fall
