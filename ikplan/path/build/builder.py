"""Tool paths built up segment by segment."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.curve import CurveSegment
from ikplan.documents.segment import (
    UPWARDS,
    ArcSegment,
    EndOrientation,
    LineSegment,
    OrientationRule,
)
from ikplan.errors import InvalidRequest
from ikplan.path.build.assembly import assemble
from ikplan.path.build.found_corners import FoundCorners
from ikplan.path.build.items import ItemWaypoint, PathItem
from ikplan.path.build.orientation_lead_in import lead_in_orientations
from ikplan.path.build.path_frame import PathFrame
from ikplan.path.build.spline_items import spline_items
from ikplan.path.build.tolerance_corners import CornerTolerance
from ikplan.path.coincidence import COINCIDENT, joined
from ikplan.path.curves.arcs import arc_about, arc_around, arc_between, arc_through
from ikplan.path.curves.named_curves import curve_pieces
from ikplan.path.pieces.piece import Piece, Pose
from ikplan.path.pieces.steady import line
from ikplan.path.rotation.geodesic import shortest_turn
from ikplan.path.rotation.so3 import angle_between, exp, log
from ikplan.path.tool_path import ToolPath

__all__ = ["PathBuilder"]


_UNTURNED = np.eye(3)
_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}


class PathBuilder:
    """Appends segments to a tool path, each from where the one before ended.

    Args:
        frame: The path frame.
        begin: Where the path begins.
        name: What the request calls that pose.
        row: Gives each waypoint its row among those of the request.
        free_axis: "tool_x", ...: the axis of the tool about which it may turn; None: none.
        blend: Radius of the corners that have none of their own [m].
        rounding: How much those corners may be rounded instead; None: not at all.
        stops: Rows of the waypoints at which corners are exact all the same.
        found: Corners rounded before, in another variant of the path; None: there are none.
    """

    def __init__(
        self,
        frame: PathFrame,
        begin: Pose,
        name: str,
        row: Callable[[], int],
        free_axis: str | None = None,
        blend: float = 0.0,
        rounding: CornerTolerance | None = None,
        stops: Container[int] = (),
        found: FoundCorners | None = None,
    ) -> None:
        self._frame = frame
        self._begin = self._at = begin
        self._name = self._first_name = name
        self._row = row
        self._free_axis = None if free_axis is None else _AXES[free_axis]
        self._blend = blend
        self._rounding = rounding
        self._stops = stops
        self._found = found
        self._items: list[PathItem] = []
        self._first: list[ItemWaypoint] = []

    @property
    def end(self) -> Pose:
        """Pose at the end of what has been built."""
        return self._at

    @property
    def empty(self) -> bool:
        """Whether nothing has been appended."""
        return not self._items

    def add_begin_waypoint(self) -> None:
        """Count the begin of the path as a waypoint."""
        self._first.append(ItemWaypoint(0.0, self._row(), self._name, self._begin))

    def add_line(
        self,
        to: Pose,
        name: str,
        *,
        field: str = "",
        turn_axis: Array | None = None,
        blend: float | None = None,
    ) -> None:
        """Append a line to a pose; the orientation counts if both its ends have one."""
        _, end = joined([self._at, to])
        turn = self._turn_to(end.R, name, field or name, turn_axis)
        R0 = None if turn is None else self._at.R
        self._append(line(self._at.p, end.p, R0, turn), to, name, field, blend)
        self._at = end

    def add_lines(self, poses: Sequence[Pose], names: Sequence[str]) -> None:
        """Append lines through poses; their turns are computed all at once."""
        rotations = [self._at.R, *(pose.R for pose in poses)]
        told = [
            (A, B) if A is not None and B is not None else (_UNTURNED, _UNTURNED)
            for A, B in pairwise(rotations)
        ]
        turns = log(np.array([A.T @ B for A, B in told]))
        for pose, name, (A, _), turn in zip(poses, names, told, turns, strict=True):
            before = self._at
            _, end = joined([before, pose])
            # Where poses are joined, the orientation before may be another one.
            if end is not pose or before.R is not A or end.R is None:
                self.add_line(pose, name)
                continue
            between = (self._name, name)
            checked = shortest_turn(
                A, end.R, between, free_axis=self._free_axis, field=name, turn=turn
            )
            self._append(line(before.p, end.p, A, checked), pose, name, "", None)
            self._at = end

    def add_line_segment(self, segment: LineSegment, field: str) -> None:
        """Append the line of a request."""
        axis = None
        if segment.turn_axis is not None:
            axis = self._frame.direction(segment.turn_axis)
        to = self._frame.pose(segment.to)
        self.add_line(to, f"{field}.to", field=field, turn_axis=axis, blend=segment.blend)

    def add_arc(self, segment: ArcSegment, field: str) -> None:
        """Append an arc.

        Raises:
            InvalidRequest: The points do not make one arc, or the orientation is undefined.
        """
        frame, axis = self._frame, None
        if segment.turn_axis is not None:
            axis = frame.direction(segment.turn_axis)
        try:
            if segment.via is not None and segment.to is not None:
                to, name = frame.pose(segment.to), f"{field}.to"
                piece: Piece = arc_through(self._at.p, frame.point(segment.via), to.p)
            elif segment.centre is not None and segment.to is not None:
                to, name = frame.pose(segment.to), f"{field}.to"
                centre = frame.point(segment.centre)
                if segment.axis is None:
                    piece = arc_around(self._at.p, centre, to.p)
                else:
                    piece = arc_between(self._at.p, centre, to.p, frame.direction(segment.axis))
            elif segment.centre is not None and segment.angle is not None:
                centre, z = frame.point(segment.centre), frame.direction(segment.axis or UPWARDS)
                piece = arc_about(self._at.p, centre, z, segment.angle)
                rule, blend = segment.orientation, segment.blend
                self._append_oriented([piece], rule, z, field, blend, axis)
                return
            else:
                raise TypeError("an arc without points; the request model does not let it pass")
        except ValueError as error:
            raise InvalidRequest(
                f"{field}: this makes no arc: {error}",
                field=field,
                allowed="points that make one arc",
            ) from error
        turn = self._turn_to(to.R, name, field, axis)
        if turn is not None and self._at.R is not None:
            piece = piece.with_turning(self._at.R, turn / piece.length)
        self._append(piece, to, name, field, segment.blend)

    def add_spline(
        self,
        poses: Sequence[Pose],
        names: Sequence[str],
        field: str = "",
        blend: float | None = None,
    ) -> None:
        """Append a C2 curve through poses, one or more, after the end of what has been built."""
        asked = zip(names, poses, strict=True)
        waypoints = [ItemWaypoint(0.0, self._row(), name, pose) for name, pose in asked]
        passed = joined([self._at, *poses])
        items = spline_items(passed, [self._name, *names], waypoints)
        for item in items:
            item.field = field or item.field
        items[-1].blend = blend
        self._items += items
        self._at, self._name = passed[-1], names[-1]

    def add_curve(
        self, segment: CurveSegment, field: str, *, first_is_waypoint: bool = True
    ) -> None:
        """Append a named curve, joined by a line to where the path has got to.

        Raises:
            InvalidRequest: It has no length, there is a gap and connect is false, or the
                orientation is undefined.
        """
        R, origin = self._frame.frame(segment.frame)
        pieces = curve_pieces(segment, R, origin)
        if sum(piece.length for piece in pieces) <= COINCIDENT:
            raise InvalidRequest(
                f"{field}: the curve is no longer than {COINCIDENT:g} m: a point, not a path",
                field=field,
                allowed=f"a curve of more than {COINCIDENT:g} m",
            )
        first = self.curve_begin(segment, pieces)
        gap = float(np.linalg.norm(first.p - self._at.p))
        turn = 0.0
        if first.R is not None and self._at.R is not None:
            turn = float(angle_between(self._at.R, first.R))
        lacks = first.R is not None and self._at.R is None
        name = f"the first point of {field}"
        if gap <= COINCIDENT and turn <= COINCIDENT and not lacks:
            if first_is_waypoint:
                waypoints = self._items[-1].waypoints if self._items else self._first
                at = self._items[-1].piece.length if self._items else 0.0
                waypoints.append(ItemWaypoint(at, self._row(), name, first))
        elif not segment.connect and (gap > COINCIDENT or turn > COINCIDENT):
            raise InvalidRequest(
                f"{field}: the curve begins {1e3 * gap:.6g} mm and {turn:.6g} rad from where the "
                "path has got to, and connect is false",
                field=f"{field}.connect",
                allowed="true, or a curve that begins at the end of the segment before",
            )
        else:
            self.add_line(first, name, field=field, blend=segment.blend)
        if first.R is not None:
            self._at = Pose(first.R, self._at.p)
        rule = segment.orientation
        self._append_oriented(pieces, rule, R[:, 2], field, segment.blend, None)

    def curve_begin(self, segment: CurveSegment, pieces: Sequence[Piece] | None = None) -> Pose:
        """Return the pose at the first point of a curve that comes next."""
        if pieces is None:
            pieces = curve_pieces(segment, *self._frame.frame(segment.frame))
        R = self._frame.rotation(segment.quaternion_xyzw)
        if R is None and segment.orientation != "free":
            R = self._at.R
        return Pose(R, pieces[0].evaluate(np.zeros(1)).p[0])

    @property
    def last_blend(self) -> float | None:
        """Radius that the last segment asks for at its end [m]; None: it names none."""
        return self._items[-1].blend if self._items else None

    def finish(self, *, joint_after: bool = False) -> ToolPath:
        """Return the path.

        Args:
            joint_after: Whether a joint motion follows, so that there is a corner at its end.

        Raises:
            InvalidRequest: A corner cannot be blended, or a free part leads to an orientation
                180 degrees away.
        """
        items = lead_in_orientations(self._items, self._begin, self._first_name, self._free_axis)
        return assemble(
            self._begin,
            self._first,
            items,
            self._blend,
            self._rounding,
            joint_after=joint_after,
            stops=self._stops,
            found=self._found,
        )

    def _turn_to(
        self, R1: Array | None, name: str, field: str, turn_axis: Array | None
    ) -> Array | None:
        if self._at.R is None or R1 is None:
            return None
        return shortest_turn(
            self._at.R,
            R1,
            (self._name, name),
            turn_axis=turn_axis,
            free_axis=self._free_axis,
            field=field,
        )

    def _append(self, piece: Piece, to: Pose, name: str, field: str, blend: float | None) -> None:
        waypoint = ItemWaypoint(piece.length, self._row(), name, to)
        self._items.append(PathItem(piece, [waypoint], field or name, blend))
        self._at, self._name = to, name

    def _append_oriented(
        self,
        pieces: Sequence[Piece],
        rule: OrientationRule,
        z: Array,
        field: str,
        blend: float | None,
        turn_axis: Array | None,
    ) -> None:
        """Append pieces of one curve, with the orientation that its rule says."""
        name = f"the end of {field}"
        R, last = self._at.R, pieces[-1]
        p = last.evaluate(np.array([last.length])).p[0]
        if rule == "free" or self._frame.positions_only:
            R, R_end = None, None
        elif isinstance(rule, EndOrientation):
            R_end = self._frame.rotation(rule.quaternion_xyzw)
        elif R is None:
            raise InvalidRequest(
                f"{field}: there is no orientation to keep: the pose before has none",
                field=f"{field}.orientation",
                allowed='"free", or an orientation of the pose before'
                + (" or of the curve's first point (quaternion_xyzw)" if turn_axis is None else ""),
            )
        else:
            R_end = R
        if R is not None and rule == "follow":
            pieces = [piece.following(R, z) for piece in pieces]
            R_end = pieces[-1].pose(1.0)[0]
        elif R is not None:
            turn = self._turn_to(R_end, name, f"{field}.orientation", turn_axis)
            assert turn is not None
            rate, so_far, oriented = turn / sum(piece.length for piece in pieces), 0.0, []
            for piece in pieces:
                oriented.append(piece.with_turning(R @ exp(so_far * rate), rate))
                so_far += piece.length
            pieces = oriented
        for piece in pieces:
            self._items.append(PathItem(piece, [], field, blend))
        waypoint = ItemWaypoint(pieces[-1].length, self._row(), name, Pose(R_end, p))
        self._items[-1].waypoints.append(waypoint)
        self._at, self._name = Pose(R_end, p), name
