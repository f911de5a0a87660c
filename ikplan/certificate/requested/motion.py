"""What a request asks of a motion: waypoints, tool paths, segments with limits of their own."""

from __future__ import annotations

from dataclasses import dataclass

from ikplan.arrays import Array
from ikplan.certificate.requested.path import RequestedPath

__all__ = ["JointSegmentRange", "RequestedMotion", "RequestedWaypoint", "ToolLeg"]


@dataclass(frozen=True, eq=False)
class RequestedWaypoint:
    """A waypoint of a request.

    Attributes:
        p: Position of the tool in the base, shape (3,) [m].
        R: Rotation of the tool in the base, shape (3, 3); None: free.
        q: Joint values, shape (dof,) [rad or m]; None: the pose is asked for.
        ball: Radius of the ball about it that the rounded path passes through [m]; 0: the tool
            passes the waypoint itself.
        others: Waypoints of which any other may be met instead.
    """

    p: Array
    R: Array | None
    q: Array | None = None
    ball: float = 0.0
    others: tuple[RequestedWaypoint, ...] = ()


@dataclass(frozen=True, eq=False)
class ToolLeg:
    """A tool path within the motion.

    Attributes:
        path: The path.
        begin_row: Waypoint at which it begins; None: the begin of the motion.
        begin_ball: Length of its begin that need not be followed, within the ball of that radius
            about it, since a joint motion goes over into it there [m].
        end_ball: The same of its end.
    """

    path: RequestedPath
    begin_row: int | None
    begin_ball: float = 0.0
    end_ball: float = 0.0


@dataclass(frozen=True)
class JointSegmentRange:
    """A joint segment or a move: the motion from one waypoint to the next.

    Attributes:
        field: The field, such as ``path.segments[3]``.
        begin_row: Waypoint at which it begins; None: the begin of the motion.
        end_row: Waypoint at which it ends.
    """

    field: str
    begin_row: int | None
    end_row: int


@dataclass(frozen=True, eq=False)
class RequestedMotion:
    """A request read from its first word to its last.

    Attributes:
        waypoints: The waypoints, in order.
        legs: The tool paths, in order.
        joint_segments: The joint segments.
        last_rows: Waypoint at which each segment ends, by its field.
    """

    waypoints: tuple[RequestedWaypoint, ...]
    legs: tuple[ToolLeg, ...]
    joint_segments: tuple[JointSegmentRange, ...]
    last_rows: dict[str, int]
