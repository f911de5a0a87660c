"""From the path of a request to legs: tool paths, and joint motions and moves between them."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.curve import CurveSegment
from ikplan.documents.path import PathRequest
from ikplan.documents.segment import (
    ArcSegment,
    JointSegment,
    JointTarget,
    LineSegment,
    MoveRegion,
    MoveSegment,
    MoveTarget,
    SplineSegment,
)
from ikplan.errors import InvalidRequest
from ikplan.path.build.builder import PathBuilder
from ikplan.path.build.found_corners import FoundCorners
from ikplan.path.build.passed_order import RowCounter, first_rows
from ikplan.path.build.path_frame import PathFrame
from ikplan.path.build.tolerance_corners import CornerTolerance
from ikplan.path.pieces.piece import Pose
from ikplan.path.tolerance_shares import Rounding
from ikplan.path.tool_path import ToolPath

__all__ = ["JointLeg", "JointWaypoint", "Leg", "MoveLeg", "ToolLeg", "legs_of"]

ForwardKinematics = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class JointWaypoint:
    """What a joint motion goes to: joint values or a tool pose.

    Attributes:
        row: Its row among the waypoints of the request.
        name: Where the request asks for it.
        q: Joint values, shape (dof,) [rad or m]; None: a pose is asked for.
        pose: The tool pose in the base; None: joint values are asked for.
        field: The joint segment that ends there; empty: none.
    """

    row: int
    name: str
    q: Array | None = None
    pose: Pose | None = None
    field: str = ""


@dataclass(frozen=True)
class JointLeg:
    """A joint spline through waypoints, from where the leg before ended."""

    waypoints: tuple[JointWaypoint, ...]


@dataclass(frozen=True)
class MoveLeg:
    """A joint motion around what is in the way, to any of some targets, all of one row.

    Attributes:
        targets: Where it may go to, at least one.
        name: Where the request asks for it.
        within: Where the tool stays on the way; None: anywhere.
    """

    targets: tuple[JointWaypoint, ...]
    name: str
    within: MoveRegion | None = None


@dataclass(frozen=True)
class ToolLeg:
    """A tool path, from where the leg before ended.

    Attributes:
        path: The path.
        begin_blend: Radius of the ball within which the corner from the joint motion before may be
            rounded [m]; 0: the motion stops there.
        end_blend: The same of the corner to the joint motion after.
    """

    path: ToolPath
    begin_blend: float = 0.0
    end_blend: float = 0.0


Leg = JointLeg | MoveLeg | ToolLeg


def legs_of(
    path: PathRequest,
    start: Pose | None,
    fk: ForwardKinematics,
    rounding: Rounding = "all",
    order: Sequence[int] | None = None,
    stops: Container[int] = (),
    found: FoundCorners | None = None,
) -> list[Leg]:
    """Return the legs of a path, in order.

    The waypoints are numbered through all legs in the order in which the path is written. Rows are:
    each of ``path.waypoints``; ``path.begin``; the end of each segment; each pose of a spline; the
    first point of each named curve.

    Args:
        path: The path of a request.
        start: The tool's pose in the base at the start; None: the start is free.
        fk: Returns rotation (3, 3) and position (3,) [m] of the tool in the base for joint values
            of shape (dof,); asked for what comes after a joint segment to ``q``.
        rounding: Which corners are rounded within the tolerance, if the path asks for it.
        order: Numbers of the waypoints or segments in the order in which they are passed; None:
            as they are written.
        stops: Rows of the waypoints at which corners of tool paths are exact all the same.
        found: Corners rounded before, in another variant of the path; None: there are none.

    Raises:
        InvalidRequest: The path makes no sense; names the field.
    """
    walk = _Walk(path, start, fk, rounding, order, stops, found)
    if path.waypoints is not None:
        walk.waypoints()
    else:
        walk.segments()
    return walk.legs


class _Walk:
    """Goes along a request and collects legs."""

    def __init__(
        self,
        path: PathRequest,
        start: Pose | None,
        fk: ForwardKinematics,
        rounding: Rounding,
        order: Sequence[int] | None,
        stops: Container[int],
        found: FoundCorners | None,
    ) -> None:
        self._path = path
        parts = path.segments if path.waypoints is None else path.waypoints
        self._order = range(len(parts or ())) if order is None else order
        self._first_rows = first_rows(path)
        self._rounding = CornerTolerance.of(path, rounding)
        self._stops = stops
        self._found = found
        self._frame = PathFrame(path)
        self._fk = fk
        self._row = RowCounter()
        self._at = start if start is None else self._stripped(*start)
        self._name = "the start"
        self._builder: PathBuilder | None = None
        self._joint_waypoints: list[JointWaypoint] = []
        self._undecided = ""
        self._blend = self._begin_blend = 0.0
        self._blend_field = self._begin_field = ""
        self.legs: list[Leg] = []

    def waypoints(self) -> None:
        """Walk along plain waypoints."""
        path = self._path
        poses = self._frame.poses(path.waypoints or ())
        names = [f"path.waypoints[{k}]" for k in range(len(poses))]
        if path.interpolation == "joint":
            for position, k in enumerate(self._order):
                self._row.at = k
                if position == 0 and path.approach == "move" and self._at is not None:
                    self._go_to(poses[k], names[k])
                else:
                    self._joint_to(names[k], pose=poses[k])
        elif self._at is None or path.approach != "path":
            self._go_to(poses.pop(0), names.pop(0))
        if path.interpolation == "line":
            if poses:
                self._tool().add_lines(poses, names)
        elif path.interpolation == "spline" and poses:
            self._tool().add_spline(poses, names)
        self._close()

    def segments(self) -> None:
        """Walk along segments."""
        path, segments = self._path, self._path.segments or []
        leaves = self._at is None or path.approach != "path"
        if path.begin is not None:
            pose = self._frame.pose(path.begin)
            if leaves:
                self._go_to(pose, "path.begin")
            else:
                self._tool().add_line(pose, "path.begin")
        elif leaves and isinstance(segments[0], LineSegment | ArcSegment):
            raise InvalidRequest(
                f"path.segments[0]: where does this {segments[0].type} begin? With a free start "
                "or a joint approach, path.begin must say",
                field="path.begin",
                allowed="the pose at which the first segment begins",
            )
        for position, k in enumerate(self._order):
            segment, field = segments[k], f"path.segments[{k}]"
            self._row.at = self._first_rows[k]
            first = leaves and position == 0 and path.begin is None
            if isinstance(segment, MoveSegment):
                self._refuse_blend("a move begins at rest")
            if isinstance(segment, JointSegment):
                self._joint_segment(segment, field)
            elif isinstance(segment, MoveSegment):
                self._move_segment(segment, field)
            elif isinstance(segment, LineSegment):
                self._tool().add_line_segment(segment, field)
            elif isinstance(segment, ArcSegment):
                self._tool().add_arc(segment, field)
            elif isinstance(segment, SplineSegment):
                self._spline(segment, field, first)
            else:
                self._curve(segment, field, first)
        self._refuse_blend("the motion ends there")
        self._close()

    def _refuse_blend(self, why: str) -> None:
        """Refuse the blend of a joint segment without a corner at its end."""
        if self._blend > 0.0:
            raise InvalidRequest(
                f"{self._blend_field}.blend: there is no corner: {why}",
                field=f"{self._blend_field}.blend",
                allowed="0 or null",
            )

    def _spline(self, segment: SplineSegment, field: str, first: bool) -> None:
        poses = [self._frame.pose(waypoint) for waypoint in segment.through]
        names = [f"{field}.through[{k}]" for k in range(len(poses))]
        if first:
            self._go_to(poses.pop(0), names.pop(0))
        if poses:
            self._tool().add_spline(poses, names, field, segment.blend)

    def _curve(self, segment: CurveSegment, field: str, first: bool) -> None:
        if first:
            before = self._at or Pose(None, np.zeros(3))
            begin = self._new_builder(before).curve_begin(segment)
            self._go_to(begin, f"the first point of {field}")
        self._tool().add_curve(segment, field, first_is_waypoint=not first)

    def _joint_segment(self, segment: JointSegment, field: str) -> None:
        self._close_tool(joint_after=True)
        if segment.q is not None:
            self._joint_to(f"{field}.q", q=np.array(segment.q), field=field)
        elif segment.to is not None:
            self._joint_to(f"{field}.to", pose=self._frame.pose(segment.to), field=field)
        self._blend, self._blend_field = segment.blend or 0.0, field

    def _go_to(self, pose: Pose, name: str) -> None:
        """Begin the tool path at a pose: by a joint motion, or there if the start is free."""
        if self._at is None:
            self._at, self._name = pose, name
            self._tool().add_begin_waypoint()
        elif self._path.approach == "move" and not self.legs and not self._joint_waypoints:
            self._move_to([JointWaypoint(self._row(), name, pose=pose)], name)
        else:
            self._joint_to(name, pose=pose)

    def _move_segment(self, segment: MoveSegment, field: str) -> None:
        row = self._row()
        if segment.q is not None:
            targets = [JointWaypoint(row, f"{field}.q", np.array(segment.q), None, field)]
        elif segment.to is not None:
            pose = self._frame.pose(segment.to)
            targets = [JointWaypoint(row, f"{field}.to", None, pose, field)]
        else:
            targets = [
                self._any_target(target, row, f"{field}.any[{k}]", field)
                for k, target in enumerate(segment.any or ())
            ]
        self._move_to(targets, field, segment.within)

    def _any_target(self, target: MoveTarget, row: int, name: str, field: str) -> JointWaypoint:
        if isinstance(target, JointTarget):
            return JointWaypoint(row, f"{name}.q", np.array(target.q), None, field)
        return JointWaypoint(row, name, None, self._frame.pose(target), field)

    def _move_to(
        self, targets: list[JointWaypoint], name: str, within: MoveRegion | None = None
    ) -> None:
        self._close()
        self.legs.append(MoveLeg(tuple(targets), name, within))
        self._name = name
        self._end_at(targets[0])
        self._undecided = name if len(targets) > 1 else ""

    def _joint_to(
        self, name: str, q: Array | None = None, pose: Pose | None = None, field: str = ""
    ) -> None:
        self._close_tool()
        self._undecided = ""
        self._joint_waypoints.append(JointWaypoint(self._row(), name, q, pose, field))
        self._name = name

    def _tool(self) -> PathBuilder:
        """The builder of the tool path that is being built."""
        self._close_joint()
        if self._undecided:
            raise InvalidRequest(
                f"{self._undecided}.any: a tool path cannot follow, since it would not know where "
                "it begins",
                field=f"{self._undecided}.any",
                allowed="a move to q or to a pose before a tool path",
            )
        if self._builder is None:
            if self._at is None:
                raise TypeError("a tool path needs a pose to begin at")
            self._builder = self._new_builder(self._at)
            self._begin_blend, self._begin_field = self._blend, self._blend_field
            self._blend = 0.0
        return self._builder

    def _new_builder(self, begin: Pose) -> PathBuilder:
        free = self._path.orientation_free
        axis = None if free is None or free == "all" else free.about
        blend = self._path.blend or 0.0
        return PathBuilder(
            self._frame,
            begin,
            self._name,
            self._row,
            axis,
            blend,
            self._rounding,
            self._stops,
            self._found,
        )

    def _close(self) -> None:
        self._close_tool()
        self._close_joint()

    def _close_tool(self, *, joint_after: bool = False) -> None:
        if self._builder is not None:
            path = self._builder.finish(joint_after=joint_after)
            end = (self._builder.last_blend or 0.0) if joint_after else 0.0
            if self._begin_blend > 0.0 or end > 0.0:
                self._refuse_radii(path, self._begin_blend, end)
            self.legs.append(ToolLeg(path, self._begin_blend, end))
            self._at, self._builder = self._builder.end, None

    def _refuse_radii(self, path: ToolPath, begin: float, end: float) -> None:
        """Refuse blends to joint motions that do not fit on the part of the path at their corner.

        Raises:
            InvalidRequest: One does not; the largest that does.
        """
        stops = sorted({0.0, *path.waypoint_s.tolist(), *path.corners.tolist(), path.length})
        stops = [s for s in stops if s <= 0.0 or s >= path.length or s > 1e-12]
        rooms = stops[1] - stops[0], stops[-1] - stops[-2]
        shared = 0.5 if len(stops) == 2 and begin > 0.0 and end > 0.0 else 1.0
        last = path.segments[-1].field if path.segments else self._name
        for radius, room, field in ((begin, rooms[0], self._begin_field), (end, rooms[1], last)):
            if radius > shared * room * (1.0 + 1e-12):
                raise InvalidRequest(
                    f"{field}.blend: {radius:.6g} m does not fit at the corner between the joint "
                    f"motion and the tool's path: the largest radius that fits is "
                    f"{shared * room:.6g} m",
                    field=f"{field}.blend",
                    allowed=f"at most {shared * room:.9g}",
                )

    def _close_joint(self) -> None:
        if not self._joint_waypoints:
            return
        self.legs.append(JointLeg(tuple(self._joint_waypoints)))
        self._end_at(self._joint_waypoints[-1])
        self._joint_waypoints = []

    def _end_at(self, last: JointWaypoint) -> None:
        """Note where a joint motion ends."""
        # Only a tool path needs the pose, and only after joint values it takes kinematics.
        self._at = self._stripped(*self._fk(last.q)) if last.q is not None else last.pose

    def _stripped(self, R: Array | None, p: Array) -> Pose:
        return Pose(None if self._frame.positions_only else R, p)
