"""Reads the path of a request: the order of the waypoints, tool paths, joint motions, moves.

Waypoints are numbered in the order in which they are passed: each of ``path.waypoints``; or
``path.begin``, the end of each segment, each pose of a spline, the first point of each named curve.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.requested.building import PathReader
from ikplan.certificate.requested.motion import (
    JointSegmentRange,
    RequestedMotion,
    RequestedWaypoint,
    ToolLeg,
)
from ikplan.certificate.requested.poses import PathFrame, RequestedPose
from ikplan.documents.curve import CurveSegment
from ikplan.documents.path import PathRequest
from ikplan.documents.segment import (
    ArcSegment,
    JointSegment,
    JointTarget,
    LineSegment,
    MoveSegment,
    MoveTarget,
    SplineSegment,
)
from ikplan.robots import Robot

__all__ = ["read_motion"]


def read_motion(
    robot: Robot, path: PathRequest, q_start: Array | None, order: Sequence[int] | None = None
) -> RequestedMotion:
    """Return what a path asks of a motion.

    Args:
        robot: The robot, with its tool.
        path: The path of the request.
        q_start: Joint values at the start, shape (dof,) [rad or m]; None: any.
        order: Numbers of its waypoints or segments in the order in which they are passed; None:
            as they are written.
    """
    reader = _Reader(robot, path, q_start, order)
    if path.waypoints is not None:
        reader.waypoints()
    else:
        reader.segments()
    return reader.motion()


class _Reader:
    """Goes along a path."""

    def __init__(
        self,
        robot: Robot,
        path: PathRequest,
        q_start: Array | None,
        order: Sequence[int] | None,
    ) -> None:
        self._robot, self._path = robot, path
        parts = path.waypoints or path.segments or ()
        self._order = tuple(range(len(parts)) if order is None else order)
        self._frame = PathFrame(path)
        self._at = None if q_start is None else self._pose_of(q_start)
        self._leaves = q_start is None or path.approach != "path"
        self._rows: list[RequestedWaypoint] = []
        self._legs: list[ToolLeg] = []
        self._joint_segments: list[JointSegmentRange] = []
        self._last_rows: dict[str, int] = {}
        self._open: PathReader | None = None
        self._begin_row: int | None = None
        self._ball = 0.0

    def motion(self) -> RequestedMotion:
        """What has been read."""
        self._close()
        return RequestedMotion(
            tuple(self._rows), tuple(self._legs), tuple(self._joint_segments), self._last_rows
        )

    def waypoints(self) -> None:
        """Read plain waypoints."""
        path = self._path
        poses = [self._frame.pose(w) for w in path.waypoints or ()]
        poses = [poses[k] for k in self._order]
        if path.interpolation == "joint":
            for pose in poses:
                self._joint_to(pose)
            return
        if self._leaves:
            self._go_to(poses.pop(0))
        if path.interpolation == "line":
            if poses:
                self._tool().go_through(poses)
        elif poses:
            self._tool().spline(poses, "")

    def segments(self) -> None:
        """Read segments."""
        path = self._path
        if path.begin is not None:
            begin = self._frame.pose(path.begin)
            if self._leaves:
                self._go_to(begin)
            else:
                self._tool().go_straight(begin, "path.begin")
        segments = path.segments or ()
        for position, k in enumerate(self._order):
            segment, field = segments[k], f"path.segments[{k}]"
            first = self._leaves and position == 0 and path.begin is None
            if isinstance(segment, JointSegment):
                self._joint_segment(segment, field)
            elif isinstance(segment, MoveSegment):
                self._move(segment, field)
            elif isinstance(segment, LineSegment):
                self._tool().line(segment, field)
            elif isinstance(segment, ArcSegment):
                self._tool().arc(segment, field)
            elif isinstance(segment, SplineSegment):
                self._spline(segment, field, first)
            else:
                self._curve(segment, field, first)
            self._last_rows[field] = len(self._rows) - 1

    def _spline(self, segment: SplineSegment, field: str, first: bool) -> None:
        poses = [self._frame.pose(waypoint) for waypoint in segment.through]
        if first:
            self._go_to(poses.pop(0))
        if poses:
            self._tool().spline(poses, field, segment.blend)

    def _curve(self, segment: CurveSegment, field: str, first: bool) -> None:
        if first:
            before = self._at or RequestedPose(np.zeros(3), None)
            self._go_to(self._reader(before).curve_begin(segment))
        self._tool().curve(segment, field, not first)

    def _joint_segment(self, segment: JointSegment, field: str) -> None:
        self._close(joint_after=True)
        begin = len(self._rows) - 1 if self._rows else None
        if segment.q is not None:
            self._end_joints(self._joint_values(segment.q))
        elif segment.to is not None:
            self._joint_to(self._frame.pose(segment.to))
        self._ball = segment.blend or 0.0
        self._joint_segments.append(JointSegmentRange(field, begin, len(self._rows) - 1))

    def _move(self, segment: MoveSegment, field: str) -> None:
        """Read a move: of its way nothing is asked but that it ends at one of its targets."""
        self._close()
        begin = len(self._rows) - 1 if self._rows else None
        targets = segment.any or []
        if segment.q is not None:
            targets = [JointTarget(q=segment.q)]
        elif segment.to is not None:
            targets = [segment.to]
        first, *others = map(self._target, targets)
        self._end_joints(replace(first, others=tuple(others)))
        self._joint_segments.append(JointSegmentRange(field, begin, len(self._rows) - 1))

    def _target(self, target: MoveTarget) -> RequestedWaypoint:
        if isinstance(target, JointTarget):
            return self._joint_values(target.q)
        return _waypoint(self._frame.pose(target))

    def _joint_values(self, q: Sequence[float]) -> RequestedWaypoint:
        inside = np.clip(np.array(q), self._robot.lower, self._robot.upper)
        return replace(_waypoint(self._pose_of(inside)), q=inside)

    def _end_joints(self, waypoint: RequestedWaypoint) -> None:
        """End a joint motion at a waypoint; of several, the planner lets no tool path follow."""
        self._row(waypoint)
        self._at = RequestedPose(waypoint.p, waypoint.R)
        self._begin_row = len(self._rows) - 1

    def _joint_to(self, pose: RequestedPose) -> None:
        self._close()
        self._end_joints(_waypoint(pose))

    def _go_to(self, pose: RequestedPose) -> None:
        """Begin a tool path at a pose: by a joint motion, or there where the start is free."""
        if self._at is None:
            self._at = pose
            self._tool().pass_begin()
        else:
            self._joint_to(pose)

    def _tool(self) -> PathReader:
        """The tool path that is being read."""
        if self._open is None:
            if self._at is None:
                raise TypeError("a tool path begins at a pose: the planner refuses others")
            self._open = self._reader(self._at)
            if self._ball > 0.0 and self._begin_row is not None:
                self._passed_within(self._begin_row, self._ball)
        return self._open

    def _reader(self, begin: RequestedPose) -> PathReader:
        return PathReader(self._frame, begin, self._new_row, self._path.blend or 0.0)

    def _close(self, *, joint_after: bool = False) -> None:
        if self._open is None:
            return
        path, balls = self._open.path()
        for row, radius in balls.items():
            self._passed_within(row, radius)
        end_ball = self._open.last_blend if joint_after else 0.0
        self._legs.append(ToolLeg(path, self._begin_row, self._ball, end_ball))
        self._at, self._open, self._begin_row = self._open.at, None, len(self._rows) - 1
        if end_ball > 0.0:
            self._passed_within(self._begin_row, end_ball)
        self._ball = 0.0

    def _passed_within(self, row: int, radius: float) -> None:
        """Let a waypoint be passed within a ball: its corner is rounded."""
        self._rows[row] = replace(self._rows[row], ball=radius, q=None)

    def _new_row(self, pose: RequestedPose) -> int:
        return self._row(_waypoint(pose))

    def _row(self, waypoint: RequestedWaypoint) -> int:
        self._rows.append(waypoint)
        return len(self._rows) - 1

    def _pose_of(self, q: Array) -> RequestedPose:
        T = self._robot.fk(q)
        free = self._frame.positions_only
        return RequestedPose(T.translation.copy(), None if free else T.rotation.copy())


def _waypoint(pose: RequestedPose) -> RequestedWaypoint:
    return RequestedWaypoint(pose.p, pose.R)
