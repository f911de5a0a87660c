"""Splines through poses, as a request words them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.corners import PathItem
from ikplan.certificate.requested.curves import CubicCurve
from ikplan.certificate.requested.pieces import CurvePiece, line
from ikplan.certificate.requested.poses import SAME_PLACE, RequestedPose
from ikplan.certificate.requested.rotations import exp, quaternions_of, rotation_between
from ikplan.certificate.requested.turning import EvenTurn, QuaternionSpline, Turning

__all__ = ["spline_items"]


def spline_items(poses: Sequence[RequestedPose], rows: Sequence[int], field: str) -> list[PathItem]:
    """Return the items of a spline through poses.

    The curve ends, and a new one begins, where a position is repeated. Poses without an
    orientation before one that has one get one: the tool turns evenly, by the distances of the
    poses, from the last orientation, or stays as it will be. After the last one it is free.

    Args:
        poses: Where it begins, and the poses passed.
        rows: Row of each pose but the first.
        field: The field of the request; empty: that of each waypoint.
    """
    turned, items, first = _with_lead_in(poses), [], 0
    moves = [length_of(b.p - a.p) > SAME_PLACE for a, b in pairwise(turned)]
    for k, on in enumerate([*moves, False]):
        if on:
            continue
        if k > first:
            items += _run(turned[first : k + 1], rows[first:k], field)
        if k < len(moves):
            items.append(_straight(turned[k], turned[k + 1], rows[k], field))
        first = k + 1
    return items


def _with_lead_in(poses: Sequence[RequestedPose]) -> list[RequestedPose]:
    turned = list(poses)
    known = [k for k, pose in enumerate(poses) if pose.R is not None]
    for k in range(known[0] if known else 0):
        turned[k] = RequestedPose(poses[k].p, poses[known[0]].R)
    for a, b in pairwise(known):
        Ra, Rb = poses[a].R, poses[b].R
        if b == a + 1 or Ra is None or Rb is None:
            continue
        turn = rotation_between(Ra, Rb)
        steps = [length_of(q.p - p.p) for p, q in pairwise(poses[a : b + 1])]
        way, whole = 0.0, sum(steps)
        for k in range(a + 1, b):
            way += steps[k - a - 1]
            share = way / whole if whole > SAME_PLACE else 1.0
            turned[k] = RequestedPose(poses[k].p, Ra @ exp(share * turn[None])[0])
    return turned


def _straight(a: RequestedPose, b: RequestedPose, row: int, field: str) -> PathItem:
    turn = None if a.R is None or b.R is None else rotation_between(a.R, b.R)
    piece = line(a.p, b.p, a.R if turn is not None else None, turn)
    return PathItem(piece, field or _waypoint(row), 0.0, [(piece.length, row)])


def _run(poses: Sequence[RequestedPose], rows: Sequence[int], field: str) -> list[PathItem]:
    """One curve through distinct positions, in two parts where the orientation becomes free."""
    if len(poses) == 2:
        return [_straight(poses[0], poses[1], rows[0], field)]
    arc = ArcLength(CubicCurve(np.array([pose.p for pose in poses])))
    s = arc.at(arc.curve.breaks)
    oriented = [pose.R is not None for pose in poses]
    counts = [a and b for a, b in pairwise(oriented)]
    cuts = [0, *(k + 1 for k in range(len(counts) - 1) if counts[k] != counts[k + 1]), len(counts)]
    items = []
    for a, b in pairwise(cuts):
        law = _law(poses[a : b + 1], s[a : b + 1]) if counts[a] else None
        piece = CurvePiece(arc, float(s[a]), float(s[b] - s[a]), law)
        waypoints = [(float(s[k] - s[a]), rows[k - 1]) for k in range(a + 1, b + 1)]
        items.append(PathItem(piece, field or _waypoint(rows[b - 1]), 0.0, waypoints))
    return items


def _law(poses: Sequence[RequestedPose], s: Array) -> Turning:
    R = np.array([pose.R for pose in poses])
    if len(poses) == 2:
        return EvenTurn(float(s[0]), R[0], rotation_between(R[0], R[1]) / (s[1] - s[0]))
    return QuaternionSpline(s, quaternions_of(R))


def _waypoint(row: int) -> str:
    return f"path.waypoints[{row}]"
