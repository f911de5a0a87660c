"""From the segments of a request to a tool path, each from where the one before ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.requested.assembly import assembled
from ikplan.certificate.requested.corners import PathItem
from ikplan.certificate.requested.named_curves import curve_pieces
from ikplan.certificate.requested.path import RequestedPath
from ikplan.certificate.requested.pieces import BendPiece, Piece, helix, line
from ikplan.certificate.requested.poses import SAME_PLACE, PathFrame, RequestedPose
from ikplan.certificate.requested.rotations import angle_between, exp, log, rotation_between, unit
from ikplan.certificate.requested.spline import spline_items
from ikplan.documents.curve import CurveSegment
from ikplan.documents.segment import (
    UPWARDS,
    ArcSegment,
    EndOrientation,
    LineSegment,
    OrientationRule,
)

__all__ = ["PathReader"]

NewRow = Callable[[RequestedPose], int]


class PathReader:
    """Appends what segments ask for to a tool path.

    Args:
        frame: The path frame.
        begin: Where the path begins.
        new_row: Notes a waypoint and returns its row.
        blend: Radius of the corners whose segment names none [m].
    """

    def __init__(
        self, frame: PathFrame, begin: RequestedPose, new_row: NewRow, blend: float
    ) -> None:
        self._frame, self._begin, self._blend = frame, begin, blend
        self.at = begin
        self._new_row = new_row
        self._items: list[PathItem] = []
        self._first: list[int] = []
        self._poses: dict[int, RequestedPose] = {}

    def _row(self, pose: RequestedPose) -> int:
        row = self._new_row(pose)
        self._poses[row] = pose
        return row

    def pass_begin(self) -> None:
        """Count the begin of the path as a waypoint."""
        self._first.append(self._row(self._begin))

    def go_straight(
        self,
        to: RequestedPose,
        field: str | None,
        turn_axis: Array | None = None,
        blend: float | None = None,
    ) -> None:
        """Append a straight line; a field of None is that of the waypoint it leads to."""
        end = to.passed_from(self.at)
        turn = self._turn(end.R, turn_axis)
        piece = line(self.at.p, end.p, None if turn is None else self.at.R, turn)
        self._append(piece, to, field, blend)
        self.at = end

    def go_through(self, poses: Sequence[RequestedPose]) -> None:
        """Append straight lines through poses; the field of each is that of its waypoint."""
        rotations = [self.at.R, *(pose.R for pose in poses)]
        oriented = [A is not None and B is not None for A, B in pairwise(rotations)]
        turns = log(
            np.array(
                [np.eye(3) if A is None or B is None else A.T @ B for A, B in pairwise(rotations)]
            )
        )
        for pose, known, turn in zip(poses, oriented, turns, strict=True):
            end = pose.passed_from(self.at)
            if end is not pose:
                self.go_straight(pose, None)
                continue
            piece = line(self.at.p, end.p, self.at.R if known else None, turn if known else None)
            self._append(piece, pose, None, None)

    def line(self, segment: LineSegment, field: str) -> None:
        """Append a line of the request."""
        to = self._frame.pose(segment.to)
        self.go_straight(to, field, self._axis(segment.turn_axis), segment.blend)

    def arc(self, segment: ArcSegment, field: str) -> None:
        """Append an arc of the request, through a point or about a centre."""
        axis = self._axis(segment.turn_axis)
        if segment.centre is not None and segment.angle is not None:
            centre = self._frame.point(segment.centre)
            z = self._frame.direction(segment.axis or UPWARDS)
            spoke = self.at.p - centre
            spoke = spoke - float(spoke @ z) * z
            piece = helix(self.at.p, spoke, z, segment.angle, 0.0)
            self._turned([piece], segment.orientation, z, field, segment.blend, axis)
            return
        if segment.to is None:
            raise TypeError("an arc without points: the document does not allow it")
        to = self._frame.pose(segment.to)
        if segment.via is not None:
            piece = _through(self.at.p, self._frame.point(segment.via), to.p)
        elif segment.centre is not None:
            about = None if segment.axis is None else self._frame.direction(segment.axis)
            piece = _around(self.at.p, self._frame.point(segment.centre), to.p, about)
        else:
            raise TypeError("an arc without points: the document does not allow it")
        turn = self._turn(to.R, axis)
        if turn is not None and self.at.R is not None:
            piece = piece.turning(self.at.R, turn / piece.length)
        self._append(piece, to, field, segment.blend)

    def spline(
        self, poses: Sequence[RequestedPose], field: str, blend: float | None = None
    ) -> None:
        """Append a spline through poses; an empty field is that of each waypoint."""
        rows = [self._row(pose) for pose in poses]
        passed = [self.at]
        for pose in poses:
            passed.append(pose.passed_from(passed[-1]))
        items = spline_items(passed, rows, field)
        items[-1].blend = blend
        self._items += items
        self.at = passed[-1]

    def curve(self, segment: CurveSegment, field: str, first_is_waypoint: bool) -> None:
        """Append a named curve, joined by a line to where the path has got to."""
        R, origin = self._frame.frame(segment.frame)
        pieces = curve_pieces(segment, R, origin)
        first = self.curve_begin(segment)
        gap = float(np.linalg.norm(first.p - self.at.p))
        turn = 0.0
        if first.R is not None and self.at.R is not None:
            turn = angle_between(self.at.R, first.R)
        lacks = first.R is not None and self.at.R is None
        if gap > SAME_PLACE or turn > SAME_PLACE or lacks:
            self.go_straight(first, field, None, segment.blend)
        elif first_is_waypoint and self._items:
            last = self._items[-1]
            last.waypoints.append((last.piece.length, self._row(first)))
        elif first_is_waypoint:
            self._first.append(self._row(first))
        if first.R is not None:
            self.at = RequestedPose(self.at.p, first.R)
        self._turned(pieces, segment.orientation, R[:, 2], field, segment.blend, None)

    def curve_begin(self, segment: CurveSegment) -> RequestedPose:
        """Return the pose at the first point of a curve that comes next."""
        R = self._frame.rotation(segment.quaternion_xyzw)
        if R is None and segment.orientation != "free":
            R = self.at.R
        return RequestedPose(
            curve_pieces(segment, *self._frame.frame(segment.frame))[0].end(0.0).p, R
        )

    @property
    def last_blend(self) -> float:
        """Radius that the last segment asks for at its end [m]; 0: it names none."""
        return (self._items[-1].blend or 0.0) if self._items else 0.0

    def path(self) -> tuple[RequestedPath, dict[int, float]]:
        """Return the path, and by row the radius of each rounded waypoint [m]."""
        items = _with_lead_in(self._items, self._begin.R, self._poses)
        return assembled(self._begin, self._first, items, self._blend)

    def _axis(self, turn_axis: Sequence[float] | None) -> Array | None:
        return None if turn_axis is None else self._frame.direction(turn_axis)

    def _turn(self, R1: Array | None, turn_axis: Array | None) -> Array | None:
        """The turn to R1 in the tool's frame: the shortest, or about the axis asked for."""
        R0 = self.at.R
        if R0 is None or R1 is None:
            return None
        turn = rotation_between(R0, R1)
        angle = float(np.linalg.norm(turn))
        if turn_axis is not None and angle > 0.0 and float((R0 @ turn) @ turn_axis) < 0.0:
            turn = turn * (1.0 - 2.0 * math.pi / angle)
        return turn

    def _append(
        self, piece: Piece, to: RequestedPose, field: str | None, blend: float | None
    ) -> None:
        row = self._row(to)
        field = f"path.waypoints[{row}]" if field is None else field
        self._items.append(PathItem(piece, field, blend, [(piece.length, row)]))
        self.at = to

    def _turned(
        self,
        pieces: Sequence[Piece],
        rule: OrientationRule,
        z: Array,
        field: str,
        blend: float | None,
        turn_axis: Array | None,
    ) -> None:
        """Append the pieces of one curve, turning by the rule of its segment."""
        R0, R1 = self.at.R, self.at.R
        p = pieces[-1].end(pieces[-1].length).p
        if rule == "free" or self._frame.positions_only:
            R0 = R1 = None
        elif isinstance(rule, EndOrientation):
            R1 = self._frame.rotation(rule.quaternion_xyzw)
        if R0 is not None and rule == "follow":
            pieces = [piece.following(R0, z) for piece in pieces]
            R1 = pieces[-1].end(pieces[-1].length).R
        elif R0 is not None:
            turn = self._turn(R1, turn_axis)
            pieces = _evenly(pieces, R0, np.zeros(3) if turn is None else turn)
        self._items += [PathItem(piece, field, blend) for piece in pieces]
        self.at = RequestedPose(p, R1)
        self._items[-1].waypoints.append((pieces[-1].length, self._row(self.at)))


def _through(p0: Array, via: Array, p1: Array) -> BendPiece:
    """The arc from p0 through ``via`` to p1; by the inscribed angle, a line where there is none.

    The angle at ``via`` between the way on and the way there is half of what the arc turns.
    """
    there, on, chord = via - p0, p1 - via, p1 - p0
    half = math.atan2(float(np.linalg.norm(np.cross(there, on))), float(there @ on))
    along = unit(chord)
    aside = there - float(there @ along) * along
    if np.linalg.norm(aside) < SAME_PLACE:
        return line(p0, p1)
    aside = unit(aside)
    length = float(np.linalg.norm(chord)) * half / math.sin(half)
    t = math.cos(half) * along + math.sin(half) * aside
    n = math.sin(half) * along - math.cos(half) * aside
    zero = np.zeros(3)
    return BendPiece(p0, t, n, zero, 1.0, 2.0 * half / length, length, None, zero)


def _evenly(pieces: Sequence[Piece], R0: Array, turn: Array) -> list[Piece]:
    """Pieces that turn by ``turn`` from R0, evenly over their whole length."""
    whole, way, turned = sum(piece.length for piece in pieces), 0.0, []
    for piece in pieces:
        turned.append(piece.turning(R0 @ exp((way / whole) * turn[None])[0], turn / whole))
        way += piece.length
    return turned


def _with_lead_in(
    items: Sequence[PathItem], R0: Array | None, poses: dict[int, RequestedPose]
) -> list[PathItem]:
    """Give an orientation to parts without one that lead to a pose that has one.

    The tool turns evenly over the length, from the last orientation; before the first one, it is
    turned as there. What no orientation follows stays free.
    """
    turned_items: list[PathItem] = []
    free: list[PathItem] = []
    before: Piece | None = None  # what gave the last orientation, where R0 does not

    def lead(R1: Array) -> None:
        last = R0 if before is None else before.end(before.length).R
        start = R1 if last is None else last
        turned_items.extend(_turned_free(free, start, rotation_between(start, R1)))
        free.clear()

    for item in items:
        piece = item.piece
        if piece.oriented:
            if free:
                R1 = piece.end(0.0).R
                if R1 is not None:
                    lead(R1)
            turned_items.append(item)
            before = piece
            continue
        free.append(item)
        R1 = poses[item.waypoints[-1][1]].R if item.waypoints else None
        if R1 is not None:
            lead(R1)
            R0, before = R1, None
    return turned_items + free


def _turned_free(items: Sequence[PathItem], R0: Array, turn: Array) -> list[PathItem]:
    if sum(item.piece.length for item in items) > SAME_PLACE:
        pieces = _evenly([item.piece for item in items], R0, turn)
    else:  # no way to turn on: it turns on the spot, then stays
        p, still = items[0].piece.end(0.0).p, np.zeros(3)
        R1 = R0 @ exp(turn[None])[0]
        pieces = [line(p, p, R0, turn), *(item.piece.turning(R1, still) for item in items[1:])]
    return [
        PathItem(piece, item.field, item.blend, _at_end(item, piece))
        for item, piece in zip(items, pieces, strict=True)
    ]


def _at_end(item: PathItem, piece: Piece) -> list[tuple[float, int]]:
    """The waypoints of an item on a piece that stands for it."""
    if piece.length == item.piece.length:
        return item.waypoints
    return [(piece.length, row) for _, row in item.waypoints]


def _around(p0: Array, centre: Array, p1: Array, z: Array | None) -> BendPiece:
    """The arc around a centre, less than half a turn, about the axis across both its spokes.

    The centre is moved along the chord until both ends are as far from it. About an axis z the
    arc turns right-handed, by as much as it takes.
    """
    chord = p1 - p0
    centre = centre + chord * float((0.5 * (p0 + p1) - centre) @ chord) / float(chord @ chord)
    if z is not None:
        z = z - chord * float(z @ chord) / float(chord @ chord)
        z = z / np.linalg.norm(z)
        centre = centre + z * float((p0 - centre) @ z)
        # The chord is seen from the centre under half the angle.
        left = float((centre - p0) @ np.cross(z, chord)) / float(np.linalg.norm(chord))
        about = 2.0 * float(np.arctan2(0.5 * np.linalg.norm(chord), left))
        return helix(p0, p0 - centre, z, about, 0.0)
    a, b = p0 - centre, p1 - centre
    across = np.cross(a, b)
    angle = float(np.arctan2(np.linalg.norm(across), a @ b))
    return helix(p0, a, across / np.linalg.norm(across), angle, 0.0)
