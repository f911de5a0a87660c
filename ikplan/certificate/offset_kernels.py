"""What a tool pose is off its target beyond what is allowed, compiled, row by row."""

from __future__ import annotations

import math
from typing import NamedTuple

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array, Flags, Indices

__all__ = ["Allowed", "keep_better", "offset_rows"]


class Allowed(NamedTuple):
    """What a path allows at its targets.

    Attributes:
        position: Tolerance of positions [m].
        orientation: Tolerance of orientations [rad].
        free_axis: Axis about which the tool may turn; -1: none.
        cone: Angle by which that axis may tilt [rad].
        boxed: Whether there is a box.
        of_target: Whether its axes are those of the target, or of the base where none counts.
        axes: Its axes where they are not, shape (3, 3).
        box_position: Half widths of the box, shape (3,) [m].
        box_orientation: The same of rotations, shape (3,) [rad].
    """

    position: float
    orientation: float
    free_axis: int
    cone: float
    boxed: bool
    of_target: bool
    axes: Array
    box_position: Array
    box_orientation: Array


@leaf_kernel
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@leaf_kernel
def _cross_into(a: Array, b: Array, out: Array) -> None:
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@leaf_kernel
def _scale_to(vector: Array, norm: float, length: float) -> None:
    """Scale a vector of a norm to a length; where it has none, along x."""
    if norm > 1e-300:
        scale = length / norm
        for i in range(3):
            vector[i] *= scale
        return
    vector[0], vector[1], vector[2] = length, 0.0, 0.0


@leaf_kernel
def _to_axes(axes: Array, vector: Array, out: Array) -> None:
    for j in range(3):
        out[j] = axes[0, j] * vector[0] + axes[1, j] * vector[1] + axes[2, j] * vector[2]


@leaf_kernel
def _from_axes(axes: Array, vector: Array, out: Array) -> None:
    for i in range(3):
        out[i] = axes[i, 0] * vector[0] + axes[i, 1] * vector[1] + axes[i, 2] * vector[2]


@leaf_kernel
def _outside(vector: Array, axes: Array, half_widths: Array, inside: Array) -> None:
    """Leave of a vector the part beyond a box of given axes."""
    _to_axes(axes, vector, inside)
    for i in range(3):
        along = inside[i]
        beyond = max(abs(along) - half_widths[i], 0.0)
        inside[i] = beyond if along > 0.0 else -beyond
    _from_axes(axes, inside, vector)


@leaf_kernel
def _felt(rate: Array, beyond: Array, axes: Array, faces: Array, inside: Array) -> None:
    """Leave of a rate the part along those axes of a box beyond whose faces something is."""
    _to_axes(axes, beyond, faces)
    _to_axes(axes, rate, inside)
    for i in range(3):
        if not abs(faces[i]) > 1e-15:
            inside[i] = 0.0
    _from_axes(axes, inside, rate)


@leaf_kernel
def _turned_into(allowed: Allowed, R: Array, R_target: Array, axes: Array, out: Array) -> None:
    """Write the rotation vector from an orientation, or from the cone about its free axis."""
    f = allowed.free_axis
    if f < 0:
        # The rotation from the target is R R_target^T.
        out[0] = _dot(R[2], R_target[1]) - _dot(R[1], R_target[2])
        out[1] = _dot(R[0], R_target[2]) - _dot(R[2], R_target[0])
        out[2] = _dot(R[1], R_target[0]) - _dot(R[0], R_target[1])
        trace = _dot(R[0], R_target[0]) + _dot(R[1], R_target[1]) + _dot(R[2], R_target[2])
        sine = math.sqrt(_dot(out, out))
        _scale_to(out, sine, math.atan2(sine, trace - 1.0))
        return
    a, b = axes[0], axes[1]
    for i in range(3):
        a[i], b[i] = R_target[i, f], R[i, f]
    _cross_into(a, b, out)
    sine = math.sqrt(_dot(out, out))
    angle = math.atan2(sine, _dot(a, b))
    _scale_to(out, sine, max(angle - allowed.cone, 0.0))


@leaf_kernel
def offset_rows(
    allowed: Allowed,
    p: Array,
    R: Array,
    p_target: Array,
    R_target: Array,
    counts: Flags,
    v: Array,
    w: Array,
    apart: Array,
    turned: Array,
    steps: Array,
    work: Array,
    unturned: Array,
) -> None:
    """Write how far poses are outside what is allowed, and the Gauss-Newton steps along the path.

    Args:
        allowed: What is allowed.
        p: Positions of the tool, shape (m, 3) [m].
        R: Rotations of the tool, shape (m, 3, 3).
        p_target: Positions asked for, shape (m, 3) [m].
        R_target: Rotations asked for, shape (m, 3, 3).
        counts: Where an orientation counts, shape (m,).
        v: Velocities of the targets along the path, shape (m, 3).
        w: Angular velocities of the targets in the base, shape (m, 3) [rad/m].
        apart: Out: from the nearest position allowed, in the base, shape (m, 3) [m].
        turned: Out: rotation vectors from the nearest orientation allowed, shape (m, 3) [rad].
        steps: Out: the squares of the ratios to both tolerances added, the step [m], and how much
            the root of that sum changes with the length, at most [1/m], shape (m, 3).
        work: Scratch, shape (5, 3).
        unturned: The identity, shape (3, 3).
    """
    lever, moved, spun = work[2], work[3], work[4]
    a, b = 1.0 / allowed.position**2, 1.0 / allowed.orientation**2
    f = allowed.free_axis
    for k in range(len(p)):
        for i in range(3):
            apart[k, i] = p[k, i] - p_target[k, i]
            lever[i], turned[k, i] = apart[k, i], 0.0
            moved[i], spun[i] = v[k, i], w[k, i]
        axes = allowed.axes
        if allowed.of_target:
            axes = R_target[k] if counts[k] else unturned
        if allowed.boxed:
            _outside(apart[k], axes, allowed.box_position, work[0])
        if counts[k]:
            _turned_into(allowed, R[k], R_target[k], work, turned[k])
            if allowed.boxed and f < 0:
                _outside(turned[k], axes, allowed.box_orientation, work[0])
            if f >= 0:
                along = 0.0
                for i in range(3):
                    along += spun[i] * R_target[k, i, f]
                for i in range(3):
                    spun[i] -= along * R_target[k, i, f]
        if allowed.boxed:
            if allowed.of_target:
                _cross_into(spun, lever, work[0])
                for i in range(3):
                    moved[i] += work[0, i]
            _felt(moved, apart[k], axes, work[0], work[1])
            _felt(spun, turned[k], axes, work[0], work[1])
        steps[k, 0] = a * _dot(apart[k], apart[k]) + b * _dot(turned[k], turned[k])
        slope = a * _dot(apart[k], moved) + b * _dot(turned[k], spun)
        bend = a * _dot(moved, moved)
        if turned[k, 0] != 0.0 or turned[k, 1] != 0.0 or turned[k, 2] != 0.0:
            bend += b * _dot(spun, spun)
        steps[k, 1], steps[k, 2] = slope / max(bend, 1e-300), math.sqrt(bend)


@leaf_kernel
def keep_better(
    allowed: Allowed,
    apart: Array,
    turned: Array,
    sample: Indices,
    piece: Indices,
    s: Array,
    best: Array,
    best_piece: Indices,
) -> None:
    """Keep of measured pairs of a sample and a place those that are better than known.

    Args:
        allowed: What is allowed.
        apart: What each pair is off, shape (n, 3) [m].
        turned: The same of its rotation, shape (n, 3) [rad].
        sample: The sample of each, shape (n,).
        piece: The piece of the path of each, shape (n,).
        s: The path length of each, shape (n,) [m].
        best: In and out: the path length [m], the larger ratio to the tolerances, the distance [m]
            and the angle [rad] that are best of each sample, shape (m, 4).
        best_piece: In and out: the piece of each sample, shape (m,).
    """
    for i in range(len(sample)):
        distance = math.sqrt(_dot(apart[i], apart[i]))
        angle = math.sqrt(_dot(turned[i], turned[i]))
        ratio = max(distance / allowed.position, angle / allowed.orientation)
        k = sample[i]
        if ratio < best[k, 1]:
            best[k, 0], best[k, 1], best[k, 2], best[k, 3] = s[i], ratio, distance, angle
            best_piece[k] = piece[i]
