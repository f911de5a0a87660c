"""A capsule about each convex piece: a cheap bound before the distance of the hulls is computed."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array

__all__ = ["enclosing_capsule", "segment_distance"]


def enclosing_capsule(points: Array) -> tuple[Array, Array, float]:
    """Return a small capsule that encloses some points.

    Its axis is the best of the principal axes of the points and those turned a little, which is
    not the smallest capsule there is, but a deterministic one near it.

    Args:
        points: Shape (n, 3), n >= 1 [m].

    Returns:
        Both ends of its axis, shape (3,) [m], and its radius [m].
    """
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)
    best: tuple[float, Array, Array, float] | None = None
    for axis in _around(axes):
        side = points - middle
        across = side - np.outer(side @ axis, axis)
        # The middle of the shadow along the axis: of its bounding box, in two directions.
        u = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        u /= np.linalg.norm(u)
        v = np.cross(axis, u)
        shadow = np.column_stack([across @ u, across @ v])
        centre = 0.5 * (shadow.min(axis=0) + shadow.max(axis=0))
        off = np.linalg.norm(shadow - centre, axis=1)
        radius = float(off.max())
        # A point this far from the axis may stand out beyond its end by the rest of the radius.
        rest = np.sqrt(np.maximum(radius * radius - off * off, 0.0))
        along = side @ axis
        low, high = float((along + rest).min()), float((along - rest).max())
        if low > high:
            low = high = 0.5 * (low + high)
            radius = float(np.sqrt(off**2 + (along - low) ** 2).max())
        volume = np.pi * radius**2 * (high - low) + 4.0 / 3.0 * np.pi * radius**3
        if best is None or volume < best[0]:
            origin = middle + centre[0] * u + centre[1] * v
            best = (volume, origin + low * axis, origin + high * axis, radius)
    assert best is not None
    # Rounding must not leave a point outside.
    return best[1], best[2], best[3] * (1.0 + 1e-12) + 1e-12


def _around(axes: Array) -> list[Array]:
    """The three axes, and the first turned a little about the others."""
    found = [axes[0], axes[1], axes[2]]
    for one in (-0.2, -0.1, 0.0, 0.1, 0.2):
        for other in (-0.2, -0.1, 0.0, 0.1, 0.2):
            axis = axes[0] + one * axes[1] + other * axes[2]
            found.append(axis / np.linalg.norm(axis))
    return found


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
