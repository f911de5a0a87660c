"""Runs of short lines with slight corners, as in recorded paths: one smooth curve within tolerance.

Rounded one by one, each of their corners would have the room of half a step, and noise of the
points would stay in the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.path.build.corners import Junctions
from ikplan.path.build.items import ItemWaypoint, PathItem
from ikplan.path.build.tolerance_corners import MIDDLE, CornerTolerance
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.shapes import FittedShape
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.steady import SteadyPiece
from ikplan.path.pieces.turning import FittedTurning, Turning
from ikplan.path.rotation.so3 import quaternion_of
from ikplan.smoothing import clusters_of, fit_within

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = ["smooth_runs"]


_LEAST_RUN = 3
"""Fewest lines that are taken as one curve."""
_TURNING = 0.07
"""A rounded corner leaves the turning of its sides by this share of ``reach |change of rate|``."""
_BULGE = 0.1
"""Of a line whose middle is farther than this share of what is allowed from the arc over it, the
quarters are points too."""
_BOX = (1.0 / 3.0**0.5, 0.25)
"""Half widths of the boxes, of positions and of unit quaternions, as shares of what is allowed:
their corners are within it."""
_BETWEEN = (0.25, 0.5, 0.75)


def smooth_runs(
    items: Sequence[PathItem], junctions: Junctions, allowed: CornerTolerance
) -> list[PathItem]:
    """Return the items with each run of crowded lines replaced by parts of a smooth curve.

    Args:
        items: The items of the path.
        junctions: The junctions between them.
        allowed: How far from the lines the tool may be.
    """
    if len(items) < _LEAST_RUN:
        return list(items)
    joined, crowded = _crowded(items, junctions, allowed)
    found: list[PathItem] = []
    k = 0
    while k < len(items):
        end = k
        while end + 1 < len(items) and crowded[k] and crowded[end + 1] and joined[end]:
            end += 1
        run = items[k : end + 1]
        smooth = _smoothed(run, allowed) if len(run) >= _LEAST_RUN else None
        found += run if smooth is None else smooth
        k = end + 1
    return found


def _crowded(
    items: Sequence[PathItem], junctions: Junctions, allowed: CornerTolerance
) -> tuple[Flags, Flags]:
    """Which junctions may be within a run, and which items are lines without room for corners."""
    lines = np.array(
        [isinstance(i.piece, SteadyPiece) and i.piece.k == 0.0 and not i.piece.turns for i in items]
    )
    lines &= np.array([all(w.s in (0.0, i.piece.length) for w in i.waypoints) for i in items])
    oriented = np.array([item.piece.oriented for item in items])
    length = np.array([item.piece.length for item in items])
    own = np.array([item.blend is not None for item in items])
    v, w = np.zeros((len(items), 3)), np.zeros((len(items), 3))
    for k, item in enumerate(items):
        if lines[k]:
            here = item.piece.evaluate(np.array([0.5 * item.piece.length]))
            v[k], w[k] = here.v[0], here.w[0]
    bend = np.linalg.norm(np.diff(v, axis=0), axis=1)
    turn = np.linalg.norm(np.diff(w, axis=0), axis=1)
    reach = np.minimum(
        allowed.position / np.maximum(MIDDLE * bend, 1e-12),
        allowed.orientation / np.maximum(_TURNING * turn, 1e-12),
    )
    joined = lines[1:] & lines[:-1] & ~own[:-1] & (oriented[1:] == oriented[:-1])
    tiny = np.minimum(length[1:], length[:-1]) <= allowed.position
    joined &= ~junctions.spot & (~junctions.back | tiny)
    if allowed.slight_only:
        joined &= ~junctions.sharp | tiny
    ends = np.where(joined, reach, 0.0)
    most = np.maximum(np.append(ends, 0.0), np.append(0.0, ends))
    return joined, lines & ((0.5 * length < most) | (length <= allowed.position))


@dataclass(frozen=True, eq=False)
class _Points:
    """Points of a run: the ends of its lines, and where lines are long, points between.

    Attributes:
        p: Positions, shape (n, 3) [m].
        q: Unit quaternions, each on the side of the one before, shape (n, 4).
        ends: Index of the point at the begin and at the end of each line, shape (lines + 1,).
    """

    p: Array
    q: Array
    ends: Indices


def _points(run: Sequence[PathItem], allowed: CornerTolerance) -> _Points:
    p, q, ends = [], [], [0]
    before = None
    for item in run:
        piece = item.piece
        assert isinstance(piece, SteadyPiece)
        bend = 0.0 if before is None else float(np.linalg.norm(piece.t - before.t))
        shares = [0.0]
        if piece.length * bend / 8.0 > _BULGE * allowed.position or before is None:
            shares = [0.0, 0.25, 0.5, 0.75]
        here = piece.evaluate(np.array(shares) * piece.length)
        p += list(here.p)
        q += list(quaternion_of(here.R))
        ends.append(len(p))
        before = piece
    last = run[-1].piece.evaluate(np.array([run[-1].piece.length]))
    p.append(last.p[0])
    q.append(quaternion_of(last.R)[0])
    quaternions = np.array(q)
    dots = (quaternions[1:] * quaternions[:-1]).sum(axis=1)
    quaternions[1:] *= np.cumprod(np.where(dots < 0.0, -1.0, 1.0))[:, None]
    return _Points(np.array(p), quaternions, np.array(ends))


def _smoothed(run: Sequence[PathItem], allowed: CornerTolerance) -> list[PathItem] | None:
    """Return parts of one curve in place of a run; None: none was found within the tolerance."""
    points = _points(run, allowed)
    oriented = run[0].piece.oriented
    turns = oriented and bool(np.abs(np.diff(points.q, axis=0)).max() > 1e-12)
    rows, half = points.p, np.full(3, _BOX[0] * allowed.position)
    if turns:
        angle = min(allowed.orientation, allowed.position / max(allowed.lever, 1e-12))
        rows = np.hstack([points.p, points.q])
        half = np.append(half, np.full(4, _BOX[1] * angle))
        half[:3] *= 0.5 if allowed.lever else 1.0
        half[3:] *= 0.5 if allowed.lever else 1.0
    clusters = clusters_of(rows, half)
    if len(clusters.u) < _LEAST_RUN:
        return None
    spline = fit_within(clusters.u, clusters.middle, clusters.half_width)
    if _off(spline, points, clusters.u, clusters.of_point, allowed, turns) > 1.0:
        return None
    curve = ArcLength(FittedShape(spline))
    if curve.folds:
        return None
    turning: Turning | None = None
    if oriented:
        turning = FittedTurning(spline, points.q[0], turns=turns)
    ends = clusters.of_point[points.ends]
    s = np.array([curve.length_at(u) for u in clusters.u[ends]])
    # Lines within the first or the last cluster are points of the curve, not a rounding long.
    s[ends == ends[0]], s[ends == ends[-1]] = 0.0, curve.length
    return _parts(run, CurvedPiece(curve, 0.0, curve.length, turning), s)


def _parts(run: Sequence[PathItem], whole: CurvedPiece, s: Array) -> list[PathItem]:
    """The curve divided at arc lengths s, shape (lines + 1,), where each item of a run ends."""
    found: list[PathItem] = []
    early: list[ItemWaypoint] = []
    fields: list[str] = []
    for k, item in enumerate(run):
        length = float(s[k + 1] - s[k])
        if length <= 0.0:
            if found:
                last = found[-1]
                at = last.piece.length
                last.waypoints += [replace(w, s=at, exact=False) for w in item.waypoints]
                last.blend = item.blend
                last.empty += [item.field, *item.empty]
            else:
                early += [replace(w, s=0.0, exact=False) for w in item.waypoints]
                fields += [item.field, *item.empty]
            continue
        piece = whole.trimmed(float(s[k]), float(s[k + 1]))
        exact = k == len(run) - 1
        waypoints = [
            replace(w, s=0.0 if w.s == 0.0 else piece.length, exact=exact) for w in item.waypoints
        ]
        found.append(PathItem(piece, [*early, *waypoints], item.field, item.blend, [*item.empty]))
        early = []
    return found


def _off(
    spline: BSpline,
    points: _Points,
    u: Array,
    of_point: Indices,
    allowed: CornerTolerance,
    turns: bool,
) -> float:
    """How far a curve is from its lines, as a ratio of what is allowed."""
    starts = np.flatnonzero(np.append(True, np.diff(of_point) > 0))
    lasts = np.append(starts[1:], len(of_point)) - 1
    a, b = points.p[lasts[:-1]], points.p[starts[1:]]
    along = b - a
    square = np.maximum((along * along).sum(axis=1), 1e-300)
    worst = 0.0
    checks = [(u[:-1] + share * np.diff(u), lasts[:-1], starts[1:]) for share in _BETWEEN]
    for at, before, after in checks:
        y = spline(at)
        share = np.clip(((y[:, :3] - a) * along).sum(axis=1) / square, 0.0, 1.0)[:, None]
        distance = np.linalg.norm(y[:, :3] - a - share * along, axis=1)
        angle = np.zeros(len(at))
        if turns:
            q = points.q[before] + share * (points.q[after] - points.q[before])
            angle = _angle(y[:, 3:], q)
        worst = max(worst, allowed.ratio(distance, angle))
    y = spline(u[of_point])
    distance = np.linalg.norm(y[:, :3] - points.p, axis=1)
    angle = _angle(y[:, 3:], points.q) if turns else np.zeros(len(distance))
    return max(worst, allowed.ratio(distance, angle))


def _angle(a: Array, b: Array) -> Array:
    """Angles between the rotations of quaternions of about unit length, shape (m,) [rad]."""
    a = a / np.linalg.norm(a, axis=1)[:, None]
    b = b / np.linalg.norm(b, axis=1)[:, None]
    chord = np.minimum(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
    return np.asarray(4.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))
