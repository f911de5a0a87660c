"""How far the outer piece of a pair moves against the inner one within an interval, compiled.

Two bounds hold, and the smaller one counts. The whole motion is at most the sum over the joints
between the two: a joint that turns by up to d moves a point at distance r from its axis by at most
d r. In one direction it is at most what the speed in the middle of the interval moves that way, and
half the largest acceleration times the square of half the interval. A body that slides along
another moves hardly towards it, so that far longer intervals are proven by the second.
"""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.collision.bodies import Bodies
from ikplan.collision.capsules import segment_distance
from ikplan.collision.inlining import inlined_kernel
from ikplan.collision.pair_gaps import place_rest
from ikplan.collision.scratch import Queue, Scratch
from ikplan.kinematics.chain import Chain

__all__ = ["cover_proven", "move_links", "move_piece", "spheres_moved", "sweep_pair"]


@leaf_kernel
def move_links(chain: Chain, queue: Queue, w: Scratch) -> None:
    """Write how each link moves at the speeds of the joints in the middle of an interval."""
    for k in range(chain.prismatic.shape[0]):
        speed = queue.speed[k]
        zx, zy, zz = w.R[k + 1, 0, 2], w.R[k + 1, 1, 2], w.R[k + 1, 2, 2]
        for c in range(3):
            w.spin[k + 1, c], w.moment[k + 1, c] = w.spin[k, c], w.moment[k, c]
        if chain.prismatic[k]:
            w.moment[k + 1, 0] -= speed * zx
            w.moment[k + 1, 1] -= speed * zy
            w.moment[k + 1, 2] -= speed * zz
        else:
            ox, oy, oz = w.p[k + 1, 0], w.p[k + 1, 1], w.p[k + 1, 2]
            w.spin[k + 1, 0] += speed * zx
            w.spin[k + 1, 1] += speed * zy
            w.spin[k + 1, 2] += speed * zz
            w.moment[k + 1, 0] += speed * (zy * oz - zz * oy)
            w.moment[k + 1, 1] += speed * (zz * ox - zx * oz)
            w.moment[k + 1, 2] += speed * (zx * oy - zy * ox)


@leaf_kernel
def move_piece(chain: Chain, bodies: Bodies, queue: Queue, i: int, w: Scratch) -> None:
    """Write how far a piece can move against each link inwards of its carrier.

    A point at distance r from the axis of a joint that turns by up to d at most, while it moves by
    up to m outwards of it, has an acceleration of at most ``d^2 r + 2 d m``, that outwards of it
    and that of the joint, all in units of half the interval.
    """
    w.moved[i] = w.now[0]
    outer = bodies.carrier[i]
    total, bend = 0.0, 0.0
    w.motion[i, outer] = w.bend[i, outer] = 0.0
    for back in range(outer):
        joint = outer - back
        d, turn = queue.reach[joint - 1], queue.turn[joint - 1]
        if chain.prismatic[joint - 1]:
            total += d
            bend += 0.5 * turn
        elif d > 0.0:
            along, square = 0.0, 0.0
            for k in range(3):
                x = w.centre[i, k] - w.p[joint, k]
                along += x * w.R[joint, k, 2]
                square += x * x
            r = math.sqrt(max(square - along * along, 0.0)) + bodies.bound[i] + total
            bend += d * total + 0.5 * (d * d + turn) * r
            total += d * r
        w.motion[i, joint - 1], w.bend[i, joint - 1] = total, bend


@leaf_kernel
def sweep_pair(bodies: Bodies, i: int, j: int, w: Scratch) -> None:
    """Write how piece j moves against the carrier of i, for :func:`gap_between`."""
    a, b = bodies.carrier[i], bodies.carrier[j]
    sx, sy, sz = (
        w.spin[b, 0] - w.spin[a, 0],
        w.spin[b, 1] - w.spin[a, 1],
        w.spin[b, 2] - w.spin[a, 2],
    )
    x, y, z = w.centre[j, 0], w.centre[j, 1], w.centre[j, 2]
    sweep = w.sweep
    sweep[0] = sy * z - sz * y - (w.moment[b, 0] - w.moment[a, 0])
    sweep[1] = sz * x - sx * z - (w.moment[b, 1] - w.moment[a, 1])
    sweep[2] = sx * y - sy * x - (w.moment[b, 2] - w.moment[a, 2])
    sweep[3], sweep[4], sweep[5] = sx, sy, sz
    sweep[6] = bodies.bound[j]
    sweep[7], sweep[8] = w.bend[j, a], w.motion[j, a]


@leaf_kernel
def spheres_moved(i: int, j: int, w: Scratch) -> float:
    """Return the most that the sphere about a swept piece j moves towards that about i [m]."""
    sweep = w.sweep
    towards, square = 0.0, 0.0
    for k in range(3):
        x = w.centre[j, k] - w.centre[i, k]
        towards += x * sweep[k]
        square += x * x
    return float(min(abs(towards) / math.sqrt(square) + sweep[7], sweep[8]))


@leaf_kernel
def _box_gap(
    x: float, y: float, z: float, box: Array, half: Array, about: float, need: float, sweep: Array,
    dx: float, dy: float, dz: float,
) -> tuple[float, bool]:  # fmt: skip
    """Return the gap of a sphere and a box [m], and whether it is larger than needed throughout.

    The centre of the sphere is at (dx, dy, dz) from that of the swept piece.
    """
    ex, ey, ez = x - box[9], y - box[10], z - box[11]
    square, nx, ny, nz = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        at = ex * box[3 * k] + ey * box[3 * k + 1] + ez * box[3 * k + 2]
        beyond = abs(at) - half[k]
        if beyond > 0.0:
            square += beyond * beyond
            side = beyond if at > 0.0 else -beyond
            nx += side * box[3 * k]
            ny += side * box[3 * k + 1]
            nz += side * box[3 * k + 2]
    distance = math.sqrt(square)
    gap = distance - about
    if not gap > need:
        return gap, False
    if gap > need + sweep[8]:
        return gap, True
    vx = sweep[0] + sweep[4] * dz - sweep[5] * dy
    vy = sweep[1] + sweep[5] * dx - sweep[3] * dz
    vz = sweep[2] + sweep[3] * dy - sweep[4] * dx
    towards = abs(vx * nx + vy * ny + vz * nz) / distance
    return gap, gap > need + towards + sweep[7]


@inlined_kernel
def cover_proven(bodies: Bodies, i: int, j: int, need: float, w: Scratch) -> tuple[float, bool]:
    """Bound the gap of two pieces whose spheres meet, without their hulls.

    What covers the swept piece j is its sphere, its capsule where i moves too, or its covering
    spheres; about i there are a box and a capsule.

    Returns:
        A lower bound of the gap in the middle [m], and whether the gap is larger than ``need``
        throughout the interval.
    """
    best, sweep = -math.inf, w.sweep
    place_rest(bodies, i, w)
    cx, cy, cz = w.centre[j, 0], w.centre[j, 1], w.centre[j, 2]
    if bodies.carrier[i] == 0:
        about = bodies.bound[j] + bodies.radius[i]
        best, proven = _box_gap(
            cx, cy, cz, w.box[i], bodies.half[i], about, need, sweep, 0.0, 0.0, 0.0
        )
        if proven:
            return best, True
        place_rest(bodies, j, w)
    else:
        place_rest(bodies, j, w)
        best = segment_distance(w.ends, i, j) - bodies.around[i] - bodies.around[j]
        if best > need + sweep[8]:
            return best, True
    least, all_proven = math.inf, True
    for s in range(bodies.first_sphere[j], bodies.first_sphere[j + 1]):
        x, y, z = w.spheres[s, 0], w.spheres[s, 1], w.spheres[s, 2]
        about = bodies.spheres[s, 3] + bodies.radius[i]
        gap, proven = _box_gap(
            x, y, z, w.box[i], bodies.half[i], about, need, sweep, x - cx, y - cy, z - cz
        )
        all_proven = all_proven and proven
        if gap < least:
            least = gap
            if not all_proven and least <= best:
                return best, False
    return float(max(best, least)), all_proven
