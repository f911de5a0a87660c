"""Where the pieces are at a configuration, and how far two are apart."""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.collision.bodies import Bodies
from ikplan.collision.capsules import segment_distance
from ikplan.collision.coverings import sphere_box_gap
from ikplan.collision.frames import link_frames
from ikplan.collision.gjk import gap_between
from ikplan.collision.inlining import inlined_kernel
from ikplan.collision.scratch import Scratch
from ikplan.kinematics.chain import Chain

__all__ = [
    "bounded_gap",
    "pair_gap",
    "place_pieces",
    "place_rest",
    "sphere_gap",
    "spheres_meet",
    "swept_gap",
]


@leaf_kernel
def place_pieces(chain: Chain, bodies: Bodies, q: Array, w: Scratch) -> None:
    """Write the link frames and the centres of the pieces at a configuration.

    The rest of a piece is placed when it is looked at: mostly few of them are.
    """
    link_frames(chain, q, w.R, w.p)
    w.now[0] += 1
    for i in bodies.moving:
        c = bodies.carrier[i]
        for k in range(3):
            w.centre[i, k] = (
                w.p[c, k]
                + w.R[c, k, 0] * bodies.centre[i, 0]
                + w.R[c, k, 1] * bodies.centre[i, 1]
                + w.R[c, k, 2] * bodies.centre[i, 2]
            )


@leaf_kernel
def place_rest(bodies: Bodies, i: int, w: Scratch) -> None:
    """Write the capsule, the box and the spheres of a piece, unless they are there already."""
    c = bodies.carrier[i]
    if w.placed[i] == w.now[0] or (c == 0 and w.placed[i] > 0):
        return
    w.placed[i] = w.now[0]
    for k in range(3):
        for end in (0, 3):
            w.ends[i, end + k] = (
                w.p[c, k]
                + w.R[c, k, 0] * bodies.axis[i, end]
                + w.R[c, k, 1] * bodies.axis[i, end + 1]
                + w.R[c, k, 2] * bodies.axis[i, end + 2]
            )
        for row in (0, 3, 6):
            w.box[i, row + k] = (
                w.R[c, k, 0] * bodies.box[i, row]
                + w.R[c, k, 1] * bodies.box[i, row + 1]
                + w.R[c, k, 2] * bodies.box[i, row + 2]
            )
        w.box[i, 9 + k] = (
            w.p[c, k]
            + w.R[c, k, 0] * bodies.box[i, 9]
            + w.R[c, k, 1] * bodies.box[i, 10]
            + w.R[c, k, 2] * bodies.box[i, 11]
        )
        for s in range(bodies.first_sphere[i], bodies.first_sphere[i + 1]):
            w.spheres[s, k] = (
                w.p[c, k]
                + w.R[c, k, 0] * bodies.spheres[s, 0]
                + w.R[c, k, 1] * bodies.spheres[s, 1]
                + w.R[c, k, 2] * bodies.spheres[s, 2]
            )


@leaf_kernel
def sphere_gap(bodies: Bodies, i: int, j: int, w: Scratch) -> float:
    """Return the gap of the spheres about two pieces [m]."""
    square = 0.0
    for k in range(3):
        square += (w.centre[i, k] - w.centre[j, k]) ** 2
    return math.sqrt(square) - float(bodies.bound[i] + bodies.bound[j])


@leaf_kernel
def spheres_meet(bodies: Bodies, i: int, j: int, need: float, w: Scratch) -> bool:
    """Whether the gap of the spheres about two pieces is not larger than needed."""
    square = 0.0
    for k in range(3):
        step = w.centre[i, k] - w.centre[j, k]
        square += step * step
    far = bodies.bound[i] + bodies.bound[j] + need
    return bool(square <= far * far)


@inlined_kernel
def bounded_gap(bodies: Bodies, i: int, j: int, need: float, w: Scratch) -> float:
    """Return a lower bound of the gap of two pieces whose spheres meet [m], without their hulls.

    Of their capsules, or, where i stands, of the sphere about j and the box about i; then of the
    spheres that cover j, that of the outer carrier, and the box about i. The first of these that
    is larger than ``need`` is returned. Loops look at the spheres about both first, themselves:
    the call costs more than that.
    """
    best = -math.inf
    place_rest(bodies, i, w)
    if bodies.carrier[i] == 0:
        x, y, z = w.centre[j, 0], w.centre[j, 1], w.centre[j, 2]
        about = bodies.bound[j] + bodies.radius[i]
        best = max(best, float(sphere_box_gap(x, y, z, w.box[i], bodies.half[i]) - about))
        if best > need:
            return best
        place_rest(bodies, j, w)
    else:
        place_rest(bodies, j, w)
        around = bodies.around[i] + bodies.around[j]
        best = max(best, float(segment_distance(w.ends, i, j) - around))
        if best > need:
            return best
    least = math.inf
    for s in range(bodies.first_sphere[j], bodies.first_sphere[j + 1]):
        x, y, z = w.spheres[s, 0], w.spheres[s, 1], w.spheres[s, 2]
        gap = sphere_box_gap(x, y, z, w.box[i], bodies.half[i]) - bodies.spheres[s, 3]
        if gap < least:
            least = gap
            if least <= best:
                return best
    return float(max(best, least - bodies.radius[i]))


@leaf_kernel
def pair_gap(
    bodies: Bodies, row: int, need: float, enough: float, w: Scratch
) -> tuple[float, float]:
    """Bound the gap of a pair at the placed configuration; see :func:`gap_between`."""
    lower, upper, _ = swept_gap(bodies, row, need, enough, w.still, w)
    return lower, upper


@inlined_kernel
def swept_gap(
    bodies: Bodies, row: int, need: float, enough: float, sweep: Array, w: Scratch
) -> tuple[float, float, bool]:
    """Bound the gap of a pair that moves; see :func:`gap_between`."""
    i, j = bodies.pairs[row, 0], bodies.pairs[row, 1]
    a, b = bodies.carrier[i], bodies.carrier[j]
    reach = bodies.radius[i] + bodies.radius[j]
    axis = w.axis[row]
    if axis[0] == 0.0 and axis[1] == 0.0 and axis[2] == 0.0:
        for k in range(3):
            axis[k] = w.centre[i, k] - w.centre[j, k]
    lower, upper, proven = gap_between(
        bodies.points,
        (bodies.first[i], bodies.first[i + 1]), w.R[a], w.p[a],
        (bodies.first[j], bodies.first[j + 1]), w.R[b], w.p[b],
        need + reach, enough + reach, sweep, axis, w.work,
    )  # fmt: skip
    return lower - reach, upper - reach, proven
