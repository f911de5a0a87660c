"""Splines through poses, as items of a path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.errors import InvalidRequest
from ikplan.path.build.items import ItemWaypoint, PathItem
from ikplan.path.coincidence import COINCIDENT, joined
from ikplan.path.curves.arc_length import ArcLength
from ikplan.path.curves.shapes import CubicShape
from ikplan.path.pieces.curved import CurvedPiece
from ikplan.path.pieces.piece import Pose
from ikplan.path.pieces.spline_turning import SplineTurning
from ikplan.path.pieces.steady import line
from ikplan.path.pieces.turning import SteadyTurning, Turning
from ikplan.path.rotation.geodesic import AMBIGUOUS, refuse_half_turn, shortest_turn
from ikplan.path.rotation.so3 import exp, quaternion_of

__all__ = ["spline_items"]


_OFF_SPHERE = 0.7
"""Quaternions farther than this from unit length turn back and forth when they are brought back."""


def spline_items(
    poses: Sequence[Pose], names: Sequence[str], waypoints: Sequence[ItemWaypoint]
) -> list[PathItem]:
    """Return the items of a C2 curve through poses.

    Args:
        poses: The begin and the poses passed, two or more, joined where they coincide.
        names: What the request calls them.
        waypoints: The waypoint of each pose but the first, wherever on its item.

    Raises:
        InvalidRequest: Two neighbouring orientations are 180 degrees apart, or the orientations
            turn too fast to be turned through.
    """
    steps = [length_of(b.p - a.p) > COINCIDENT for a, b in pairwise(poses)]
    poses = _with_lead_in(poses, names)
    items: list[PathItem] = []
    first = 0
    for k, moves in enumerate([*steps, False]):
        if moves:
            continue
        if k > first:
            items += _run(poses[first : k + 1], names[first : k + 1], waypoints[first:k])
        if k < len(steps):
            items.append(_on_the_spot(poses[k : k + 2], names[k : k + 2], waypoints[k]))
        first = k + 1
    return items


def _with_lead_in(poses: Sequence[Pose], names: Sequence[str]) -> list[Pose]:
    """Give each pose before one with an orientation one too, turning evenly from the last.

    The curve arrives turned as asked without a jump of the angular rate; the poses after the last
    orientation stay free.
    """
    turned = list(poses)
    known = [k for k, pose in enumerate(poses) if pose.R is not None]
    for k in range(known[0] if known else 0):
        turned[k] = Pose(poses[known[0]].R, poses[k].p)
    for a, b in pairwise(known):
        Ra, Rb = poses[a].R, poses[b].R
        assert Ra is not None
        assert Rb is not None
        if b == a + 1:
            continue
        turn = shortest_turn(Ra, Rb, (names[a], names[b]), field=names[b])
        way = np.cumsum([length_of(q.p - p.p) for p, q in pairwise(poses[a : b + 1])])
        for k in range(a + 1, b):
            share = way[k - a - 1] / way[-1] if way[-1] > COINCIDENT else 1.0
            turned[k] = Pose(Ra @ exp(share * turn), poses[k].p)
    return turned


def _on_the_spot(poses: Sequence[Pose], names: Sequence[str], waypoint: ItemWaypoint) -> PathItem:
    begin, end = joined(poses)
    turn = None
    if begin.R is not None and end.R is not None:
        turn = shortest_turn(begin.R, end.R, (names[0], names[1]), field=names[1])
    piece = line(begin.p, end.p, begin.R if turn is not None else None, turn)
    return PathItem(piece, [replace(waypoint, s=piece.length)], names[1], 0.0)


def _run(
    poses: Sequence[Pose], names: Sequence[str], waypoints: Sequence[ItemWaypoint]
) -> list[PathItem]:
    """One curve through distinct positions, cut where the orientation begins or ends to count."""
    oriented = np.array([pose.R is not None for pose in poses])
    for k in np.flatnonzero(oriented[1:] & oriented[:-1]).tolist():
        _check_turn(poses[k], poses[k + 1], (names[k], names[k + 1]))
    if len(poses) == 2:
        turn = None
        if oriented.all():
            R0, R1 = poses[0].R, poses[1].R
            assert R0 is not None
            assert R1 is not None
            turn = shortest_turn(R0, R1, (names[0], names[1]), field=names[1])
        straight = line(poses[0].p, poses[1].p, None if turn is None else poses[0].R, turn)
        return [PathItem(straight, [replace(waypoints[0], s=straight.length)], names[1], 0.0)]
    curve = ArcLength(CubicShape(np.array([pose.p for pose in poses])))
    s = np.array([curve.at_break(k) for k in range(len(poses))])
    counts = oriented[1:] & oriented[:-1]
    cuts = [0, *(np.flatnonzero(np.diff(counts)) + 1).tolist(), len(poses) - 1]
    items = []
    for a, b in pairwise(cuts):
        turning = _turning(poses[a : b + 1], s[a : b + 1], names[a : b + 1]) if counts[a] else None
        piece = CurvedPiece(curve, float(s[a]), float(s[b] - s[a]), turning)
        inside = [replace(waypoints[k - 1], s=float(s[k] - s[a])) for k in range(a + 1, b + 1)]
        items.append(PathItem(piece, inside, names[b], 0.0))
    return items


def _check_turn(a: Pose, b: Pose, names: tuple[str, str]) -> None:
    assert a.R is not None
    assert b.R is not None
    # The real part of the quaternion from a to b is the cosine of half the angle.
    if quaternion_of(a.R.T @ b.R)[3] < np.sin(0.5 * AMBIGUOUS):
        refuse_half_turn(names, names[1])


def _turning(poses: Sequence[Pose], s: Array, names: Sequence[str]) -> Turning:
    R = np.array([pose.R for pose in poses])
    if len(poses) == 2:
        turn = shortest_turn(R[0], R[1], (names[0], names[1]), field=names[1])
        return SteadyTurning(float(s[0]), R[0], turn / (s[1] - s[0]))
    turning = SplineTurning(s, quaternion_of(R))
    if turning.off_sphere > _OFF_SPHERE:
        a, b = names[turning.worst_span : turning.worst_span + 2]
        raise InvalidRequest(
            f"{b}: from {a} the tool turns so far on so short a way, against its neighbours, that "
            "no smooth curve leads through the orientations without swinging; put poses between, "
            "space them more evenly, or use lines",
            field=b,
            allowed="turns in proportion to the distances of the poses",
        )
    return turning
