"""A capsule about each convex piece: a cheap bound before the distance of the hulls is computed."""

from __future__ import annotations

import functools
import math

import numpy as np

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array

__all__ = ["enclosing_capsule", "segment_distance"]

_LEAN = (-0.2, -0.1, 0.0, 0.1, 0.2)
_TURNS = np.array([(1.0, a, b) for a in _LEAN for b in _LEAN])
"""The first principal axis turned a little about the others."""


def enclosing_capsule(points: Array) -> tuple[Array, Array, float]:
    """Return a small capsule that encloses some points.

    Its axis is the best of the principal axes of the points and those turned a little, which is
    not the smallest capsule there is, but a deterministic one near it.

    Args:
        points: Shape (n, 3), n >= 1 [m].

    Returns:
        Both ends of its axis, shape (3,) [m], and its radius [m].
    """
    return _capsule_about(np.ascontiguousarray(points, dtype=np.float64).tobytes())


@functools.lru_cache(maxsize=1024)
def _capsule_about(content: bytes) -> tuple[Array, Array, float]:
    points = np.frombuffer(content).reshape(-1, 3)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    _, _, principal = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)
    axes = np.vstack([principal, _TURNS @ principal])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    # Two directions across each axis, and the middle of the points' bounding box in them.
    helper = np.eye(3)[np.argmin(np.abs(axes), axis=1)]
    u = np.cross(axes, helper)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(axes, u)
    side = points - middle
    x, y, along = side @ u.T, side @ v.T, side @ axes.T
    centre_x = 0.5 * (x.min(axis=0) + x.max(axis=0))
    centre_y = 0.5 * (y.min(axis=0) + y.max(axis=0))
    off = np.hypot(x - centre_x, y - centre_y)
    radius = off.max(axis=0)
    # A point this far from the axis may stand out beyond its end by the rest of the radius.
    rest = np.sqrt(np.maximum(radius**2 - off**2, 0.0))
    low, high = (along + rest).min(axis=0), (along - rest).max(axis=0)
    short = low > high
    low[short] = high[short] = 0.5 * (low + high)[short]
    radius = np.where(short, np.hypot(off, along - low).max(axis=0), radius)
    k = int(np.argmin(radius**2 * (high - low) + 4.0 / 3.0 * radius**3))
    origin = middle + centre_x[k] * u[k] + centre_y[k] * v[k]
    # Rounding must not leave a point outside.
    wide = float(radius[k]) * (1.0 + 1e-12) + 1e-12
    return origin + low[k] * axes[k], origin + high[k] * axes[k], wide


@leaf_kernel
def segment_distance(ends: Array, i: int, j: int) -> float:
    """Return the distance of two segments [m].

    C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.9.

    Args:
        ends: Both ends of each segment, shape (k, 6) [m].
        i: The first segment.
        j: The second.
    """
    a, e, b, c, f = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        d1, d2 = ends[i, 3 + k] - ends[i, k], ends[j, 3 + k] - ends[j, k]
        r = ends[i, k] - ends[j, k]
        a += d1 * d1
        e += d2 * d2
        b += d1 * d2
        c += d1 * r
        f += d2 * r
    s, t = 0.0, 0.0
    if a > 0.0 and e > 0.0:
        across = a * e - b * b
        if across > 1e-12 * a * e:
            s = min(max((b * f - c * e) / across, 0.0), 1.0)
        t = (b * s + f) / e
        if t < 0.0:
            t, s = 0.0, min(max(-c / a, 0.0), 1.0)
        elif t > 1.0:
            t, s = 1.0, min(max((b - c) / a, 0.0), 1.0)
    elif e > 0.0:
        t = min(max(f / e, 0.0), 1.0)
    elif a > 0.0:
        s = min(max(-c / a, 0.0), 1.0)
    square = 0.0
    for k in range(3):
        near = ends[i, k] + s * (ends[i, 3 + k] - ends[i, k])
        square += (near - ends[j, k] - t * (ends[j, 3 + k] - ends[j, k])) ** 2
    return math.sqrt(square)
