"""Runs of short lines with slight corners, as in recorded paths: one smooth curve within tolerance.

Rounded one by one, each of their corners would have the room of half a step, and noise of the
points would stay in the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, lengths_of, steps_of
from ikplan.path.build.corners import Junctions
from ikplan.path.build.items import ItemWaypoint, PathItem
from ikplan.path.build.run_curve import RunCurve, RunPoints, curve_past, points_of
from ikplan.path.build.tolerance_corners import MIDDLE, CornerTolerance
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.shapes import FittedShape
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.steady import SteadyPiece
from ikplan.path.pieces.turning import FittedTurning, Turning
from ikplan.path.tolerance_shares import SMOOTHING

__all__ = ["SmoothRuns", "smooth_runs"]


_LEAST_RUN = 3
"""Fewest lines that are taken as one curve."""
_TURNING = 0.07
"""A rounded corner leaves the turning of its sides by this share of ``reach |change of rate|``."""
_FASTER = 0.995
"""Points are noisy where more of the tolerance leaves less than this share of the time."""


class SmoothRuns(NamedTuple):
    """The items of a path with runs of lines replaced by parts of smooth curves.

    Attributes:
        items: The items.
        noisy: Whether a curve within more of the tolerance is passed in less time.
    """

    items: list[PathItem]
    noisy: bool


def smooth_runs(
    items: Sequence[PathItem], junctions: Junctions, allowed: CornerTolerance
) -> SmoothRuns:
    """Replace each run of crowded lines by parts of a smooth curve.

    Args:
        items: The items of the path.
        junctions: The junctions between them.
        allowed: How far from the lines the tool may be.
    """
    if len(items) < _LEAST_RUN:
        return SmoothRuns(list(items), False)
    joined, crowded = _crowded(items, junctions, allowed)
    found: list[PathItem] = []
    noisy = False
    k = 0
    while k < len(items):
        end = k
        while end + 1 < len(items) and crowded[k] and crowded[end + 1] and joined[end]:
            end += 1
        run = items[k : end + 1]
        parts: Sequence[PathItem] | None = None
        if len(run) >= _LEAST_RUN:
            oriented = run[0].piece.oriented
            points = points_of(run, allowed)
            curve = curve_past(points, allowed, oriented=oriented)
            noisy = noisy or _is_noisy(points, curve, allowed, oriented=oriented)
            parts = None if curve is None else _smoothed(run, points, curve)
        found += run if parts is None else parts
        k = end + 1
    return SmoothRuns(found, noisy)


def _is_noisy(
    points: RunPoints, curve: RunCurve | None, allowed: CornerTolerance, *, oriented: bool
) -> bool:
    """Whether a curve within the share of smoothing is passed in less time than another curve."""
    if allowed.share >= SMOOTHING or allowed.slight_only:
        return False
    wider = curve_past(points, allowed.scaled(SMOOTHING), oriented=oriented)
    if curve is None or wider is None:
        return wider is not None
    # What a motion from rest to rest along a line as long takes, in the same unit.
    length = float(lengths_of(steps_of(points.p)).sum())
    straight = 2.0 * length**0.5
    return bool(wider.effort + straight < _FASTER * (curve.effort + straight))


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
    bend = lengths_of(steps_of(v))
    turn = lengths_of(steps_of(w))
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


def _smoothed(run: Sequence[PathItem], points: RunPoints, found: RunCurve) -> list[PathItem] | None:
    """Return parts of a curve in place of a run; None: the curve turns back."""
    curve = ArcLength(FittedShape(found.spline))
    if curve.folds:
        return None
    turning: Turning | None = None
    if run[0].piece.oriented:
        turning = FittedTurning(found.spline, points.q[0], turns=found.turns)
    clusters = found.clusters
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
