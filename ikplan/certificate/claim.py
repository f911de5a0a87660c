"""What is to be certified: a timed trajectory, and the request that it answers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.limits import SegmentLimits
from ikplan.documents.path import PathRequest
from ikplan.documents.timing_request import PathNearness
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot

__all__ = ["Claim", "RequestedSegment"]


@dataclass(frozen=True)
class RequestedSegment:
    """Limits that a request asks for between two waypoints of a joint path.

    Attributes:
        field: The field of the request, such as ``segments[0]``.
        first: Waypoint at which they begin.
        last: Waypoint at which they end.
        limits: The limits, on top of those of the whole motion.
    """

    field: str
    first: int
    last: int
    limits: SegmentLimits


@dataclass(frozen=True, eq=False)
class Claim:
    """A timed trajectory and the request that it answers.

    The trajectory, and when it passes which waypoint, are all that the certificate takes from the
    planner: where the waypoints and the path are, it reads from the request.

    Attributes:
        robot: The robot, with its tool.
        path: The path asked for; None: the waypoints are joint values.
        q_start: Start that was asked for, shape (dof,); None: any.
        waypoint_q: Joint values at the waypoints, shape (n, dof) [rad or m].
        waypoint_time: When each waypoint is passed, shape (n,) [s].
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof) [rad/s or m/s].
        ddq: Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].
        limits: The limits of the whole motion.
        segments: Parts of a joint path with limits of their own; those of a path are read from it.
        stop_time: When the motion is said to rest between its ends, shape (k,) [s].
        joint_waypoints: Joint values that a timing asks for, shape (n, dof); None: a path is.
        joint_tolerance: How far from the polyline through them the motion may be; None: it is
            measured only.
        start_velocity: Joint velocities asked for at the start, shape (dof,); None: rest.
        end_velocity: Those asked for at the end; None: rest.
        duration: Time that the motion is to take [s]; None: any.
        times: When the waypoints are to be passed [s], None: whenever; None: as soon as possible.
        dwells: Rows of waypoints at which it is to stand, and how long [s].
        order: Numbers of the parts of the path in the order in which they are said to be passed,
            which is that of the waypoints too; None: as it is written.
    """

    robot: Robot
    path: PathRequest | None
    q_start: Array | None
    waypoint_q: Array
    waypoint_time: Array
    time: Array
    q: Array
    dq: Array
    ddq: Array
    limits: MotionLimits
    segments: tuple[RequestedSegment, ...] = ()
    stop_time: Array = field(default_factory=lambda: np.zeros(0))
    joint_waypoints: Array | None = None
    joint_tolerance: PathNearness | None = None
    order: tuple[int, ...] | None = None
    start_velocity: Array | None = None
    end_velocity: Array | None = None
    duration: float | None = None
    times: tuple[float | None, ...] | None = None
    dwells: tuple[tuple[int, float], ...] = ()
