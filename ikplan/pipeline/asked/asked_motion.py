"""What a request asks of a motion beside its path and its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.timing_request import TimingRequest
from ikplan.errors import InvalidRequest
from ikplan.planning.joint_route import JointRoute
from ikplan.planning.segment_number import segment_number
from ikplan.robots import Robot
from ikplan.timing.moving.moving_ends import MovingEnds

__all__ = ["AskedMotion", "asked_ends", "asked_of_plan"]


@dataclass(frozen=True, eq=False)
class AskedMotion:
    """What a request asks of a motion beside its path and its limits.

    Attributes:
        ends: Joint rates at the ends; None: it begins and ends at rest.
        bends: Whether the path may be laid anew at its begin and at its end, to be tangent to
            these; a path of the tool may not.
        duration: How long the motion takes [s]; None: as little as it can.
        dwells: Indices of waypoints of the joint path where the motion stands, and how long [s].
    """

    ends: MovingEnds | None = None
    bends: tuple[bool, bool] = (True, True)
    duration: float | None = None
    dwells: tuple[tuple[int, float], ...] = ()

    @property
    def plain(self) -> bool:
        """Whether nothing is asked for."""
        return self.ends is None and self.duration is None and not self.dwells


def asked_ends(request: PlanRequest | TimingRequest, robot: Robot) -> MovingEnds | None:
    """Return the joint rates at the ends of a motion that a request asks for.

    Args:
        request: The request.
        robot: The robot.

    Returns:
        The rates; None: rest at both ends.

    Raises:
        InvalidRequest: A list has another length than the robot joints, or an acceleration is
            asked for at rest.
    """
    start, pull, end = (
        _values(getattr(request, name), name, robot)
        for name in ("start_velocity", "start_acceleration", "end_velocity")
    )
    if pull.any() and not start.any():
        raise InvalidRequest(
            "start_acceleration: a motion from rest begins without acceleration under jerk limits; "
            "give start_velocity too",
            field="start_acceleration",
            allowed="only together with start_velocity",
        )
    ends = MovingEnds(start, pull, end)
    return ends if ends.moving else None


def asked_of_plan(request: PlanRequest, robot: Robot, route: JointRoute) -> AskedMotion:
    """Return what a request for a plan asks of the motion along a route.

    Args:
        request: The request.
        robot: The robot.
        route: The route.
    """
    last = len(route.q) - 1
    free = [(step.first, step.last) for step in route.joint_steps]
    free += [(move.first, move.last) for move in route.moves]
    dwells: dict[int, float] = {}
    for part in route.segments:
        number = segment_number(part.field)
        if number is not None and request.path.segments is not None:
            seconds = request.path.segments[number].dwell
            if seconds > 0.0:
                dwells[number] = seconds
    ends_of = {segment_number(part.field): part.last for part in route.segments}
    return AskedMotion(
        ends=asked_ends(request, robot),
        bends=(any(a == 0 for a, _ in free), any(b == last for _, b in free)),
        duration=request.limits.duration,
        dwells=tuple((ends_of[number], seconds) for number, seconds in dwells.items()),
    )


def _values(values: Sequence[float] | None, field: str, robot: Robot) -> Array:
    if values is None:
        return np.zeros(robot.dof)
    if len(values) != robot.dof:
        raise InvalidRequest(
            f"{field}: {robot.dof} values expected ({', '.join(robot.joint_names)}), "
            f"got {len(values)}",
            field=field,
            allowed=f"{robot.dof} numbers",
        )
    return np.array(values, dtype=np.float64)
