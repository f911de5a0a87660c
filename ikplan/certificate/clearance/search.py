"""The proof: intervals of a motion, halved until every pair is proven to stay apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel, leaf_kernel
from ikplan.certificate.clearance.bounds import joint_ranges, joint_values, motion_bounds
from ikplan.certificate.clearance.chain import JointChain, place_joints
from ikplan.certificate.clearance.gjk import Scratch, piece_distance
from ikplan.certificate.clearance.shapes import PieceArrays, PiecePairs

__all__ = ["GROUPS", "Curve", "Findings", "Settings", "findings", "search"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

GROUPS = 2
_LEVELS = 100
_ROUNDING = 1e-9
"""Taken off every bound [m]: rounding of distances, placements and motion bounds."""


class Curve(NamedTuple):
    """The serial joints' cubics: control values and their least and greatest of each piece."""

    controls: Array
    low: Array
    high: Array


class Settings(NamedTuple):
    """What is asked for.

    Attributes:
        clearance: Least distance asked for [m].
        tolerance: Most between the nearest place found and the bound proven [m].
        resolution: Intervals in which nothing moves by more are not halved [m].
        parts: Into how many intervals the motion is cut at first.
        most: Most configurations.
    """

    clearance: float
    tolerance: float
    resolution: float
    parts: int
    most: int


class Findings(NamedTuple):
    """What the search found of each group.

    Attributes:
        found: Smallest distance seen, shape (2,) [m]; negative where radii overlap.
        least: Distance proven, shape (2,) [m].
        at: Parameter of ``found``, shape (2,).
        pair: Pair of pieces of ``found``, shape (2,); -1: none.
        points: Its points on the hulls, radii left out, shape (2, 2, 3) [m], base frame.
        undecided: Intervals at the resolution, or beyond ``most``, that no proof holds for.
        counts: Configurations and distance queries.
    """

    found: Array
    least: Array
    at: Array
    pair: Ints
    points: Array
    undecided: Ints
    counts: Ints


def findings() -> Findings:
    """Return findings of nothing."""
    return Findings(
        np.full(GROUPS, np.inf),
        np.full(GROUPS, np.inf),
        np.zeros(GROUPS),
        np.full(GROUPS, -1, dtype=np.int64),
        np.zeros((GROUPS, 2, 3)),
        np.zeros(GROUPS, dtype=np.int64),
        np.zeros(2, dtype=np.int64),
    )


@leaf_kernel
def _threshold(found: float, undecided: int, clearance: float, tolerance: float) -> float:
    """Return which bound is enough: near to the nearest place, and above the clearance."""
    near = found - tolerance
    return clearance if near < clearance < found and undecided == 0 else near


@leaf_kernel
def _place_centres(shapes: PieceArrays, R: Array, p: Array, centre: Array) -> None:
    for i in range(shapes.carrier.shape[0]):
        c = shapes.carrier[i]
        x, y, z = shapes.centre[i, 0], shapes.centre[i, 1], shapes.centre[i, 2]
        for r in range(3):
            centre[i, r] = R[c, r, 0] * x + R[c, r, 1] * y + R[c, r, 2] * z + p[c, r]


@leaf_kernel
def _note(out: Findings, g: int, gap: float, u: float, k: int, first: Array, second: Array) -> None:
    out.found[g], out.at[g], out.pair[g] = gap, u, k
    for r in range(3):
        out.points[g, 0, r], out.points[g, 1, r] = first[r], second[r]


@kernel
def search(
    chain: JointChain, shapes: PieceArrays, pairs: PiecePairs, active: Ints, curve: Curve,
    begin: float, end: float, settings: Settings, direction: Array, space: Scratch, out: Findings,
) -> None:  # fmt: skip
    """Prove a distance for pairs over a part of a motion, and find the nearest place.

    First the places at the middles of a few intervals; then each interval, halved until every
    pair is proven in it. A pair is proven where its distance at the middle, less the motion bound
    of the interval, is enough; it is not looked at again inside. What is enough falls with the
    smallest distance found.

    Args:
        chain: The joints.
        shapes: The pieces.
        pairs: Pairs of pieces.
        active: Which of them are looked at.
        curve: The motion.
        begin: Where the part begins, by the curve's parameter.
        end: Where it ends.
        settings: What is asked for.
        direction: Where the distance query of each pair begins, shape (n, 3); 0: unknown.
        space: Space of the distance query.
        out: Findings, added to.
    """
    m = curve.controls.shape[2]
    q, delta = np.zeros(m), np.zeros(m)
    R, p = np.zeros((m + 1, 3, 3)), np.zeros((m + 1, 3))
    count = shapes.carrier.shape[0]
    centre, bound = np.zeros((count, 3)), np.zeros((count, m + 1))
    remaining = np.zeros((_LEVELS + 1, active.shape[0]), dtype=np.int64)
    for k in range(active.shape[0]):  # numba compiles much more for one array into another
        remaining[0, k] = active[k]
    size = np.zeros(_LEVELS + 1, dtype=np.int64)
    size[0] = active.shape[0]
    starts, ends = np.zeros(_LEVELS + settings.parts), np.zeros(_LEVELS + settings.parts)
    levels = np.zeros(_LEVELS + settings.parts, dtype=np.int64)
    step = (end - begin) / settings.parts
    for part in range(settings.parts):
        u = begin + (part + 0.5) * step
        joint_values(curve.controls, u, q)
        place_joints(chain, q, R, p)
        _place_centres(shapes, R, p, centre)
        _visit(shapes, pairs, remaining[0], size[0], remaining[1], u, R, p, centre, bound, False,
               settings, direction, space, out)  # fmt: skip
    # The last part is the first on the stack, so that the motion is searched in its order.
    top = 0
    for part in range(settings.parts - 1, -1, -1):
        starts[top] = begin + part * step
        ends[top] = end if part == settings.parts - 1 else begin + (part + 1) * step
        top += 1
    while top > 0:
        top -= 1
        a, b, level = starts[top], ends[top], levels[top]
        u = 0.5 * (a + b)
        if b - a > 2.0:
            u = np.round(u)
        joint_values(curve.controls, u, q)
        place_joints(chain, q, R, p)
        _place_centres(shapes, R, p, centre)
        joint_ranges(curve.controls, curve.low, curve.high, a, b, q, delta)
        motion_bounds(chain, R, p, delta, shapes.carrier, centre, shapes.size, bound)
        final = level == _LEVELS - 1 or out.counts[0] >= settings.most
        left = _visit(shapes, pairs, remaining[level], size[level], remaining[level + 1], u, R, p,
                      centre, bound, True, settings, direction, space, out)  # fmt: skip
        if final:
            for n in range(left):
                g = pairs.group[remaining[level + 1, n]]
                out.undecided[g] += 1
                out.least[g] = -np.inf
        elif left > 0:
            size[level + 1] = left
            starts[top], ends[top], levels[top] = u, b, level + 1
            starts[top + 1], ends[top + 1], levels[top + 1] = a, u, level + 1
            top += 2


@leaf_kernel
def _visit(
    shapes: PieceArrays, pairs: PiecePairs, todo: Ints, count: int, left: Ints, u: float,
    R: Array, p: Array, centre: Array, bound: Array, moving: bool, settings: Settings,
    direction: Array, space: Scratch, out: Findings,
) -> int:  # fmt: skip
    """Look at pairs at one configuration; return how many are not proven, written to ``left``.

    Where nothing is ``moving``, the places alone are looked at, and nothing is proven.
    """
    out.counts[0] += 1
    open_pairs = 0
    for n in range(count):
        k = todo[n]
        g = pairs.group[k]
        found = out.found[g]
        if moving and found <= 0.0:
            continue  # they touch: no distance is left to prove
        i, j = pairs.first[k], pairs.second[k]
        ci, cj = shapes.carrier[i], shapes.carrier[j]
        radii = shapes.radius[i] + shapes.radius[j]
        moved = _ROUNDING
        enough = found
        if moving:
            moved += bound[j, ci]
            enough = moved + _threshold(
                found, out.undecided[g], settings.clearance, settings.tolerance
            )
        dx = centre[i, 0] - centre[j, 0]
        dy = centre[i, 1] - centre[j, 1]
        dz = centre[i, 2] - centre[j, 2]
        apart = np.sqrt(dx * dx + dy * dy + dz * dz)
        lower = apart - shapes.size[i] - shapes.size[j] - radii
        if lower > enough:
            if moving:
                out.least[g] = min(out.least[g], lower - moved)
            continue
        # The centres are points of the hulls, so that the distance is at most theirs.
        if moving and apart - radii <= enough and moved > settings.resolution:
            left[open_pairs] = k
            open_pairs += 1
            continue
        v = direction[k]
        if v[0] == 0.0 and v[1] == 0.0 and v[2] == 0.0:
            v[0], v[1], v[2] = dx, dy, dz
            if apart == 0.0:
                v[0] = 1.0
        out.counts[1] += 1
        stop = enough + radii if moving and moved > settings.resolution else -1.0
        closer, upper = piece_distance(
            shapes.xyz, shapes.start, i, j, R, p, ci, cj, enough + radii, stop, v, space
        )
        gap = upper - radii
        if closer <= 0.0 and upper <= 1e-9:
            gap = min(gap, 0.0)
        if gap < found:
            _note(out, g, gap, u, k, space.nearest[0], space.nearest[1])
            enough = moved + _threshold(
                gap, out.undecided[g], settings.clearance, settings.tolerance
            )
        if not moving:
            continue
        if closer - radii > enough:
            out.least[g] = min(out.least[g], closer - radii - moved)
        elif moved <= settings.resolution:
            out.undecided[g] += 1
            out.least[g] = min(out.least[g], closer - radii - moved)
        else:
            left[open_pairs] = k
            open_pairs += 1
    return open_pairs
