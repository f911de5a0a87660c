"""Under which id a request's plan is found: known before there is a plan."""

from __future__ import annotations

from ikplan._version import __version__
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.poses import Frame
from ikplan.documents.timing_request import TimingRequest
from ikplan.robots import Robot

__all__ = ["plan_id", "with_tool"]


def with_tool(robot: Robot, tool: Frame) -> Robot:
    """Return the robot with the tool of a request, if that has one."""
    plain = tool.position == [0.0, 0.0, 0.0] and tool.quaternion_xyzw == [0.0, 0.0, 0.0, 1.0]
    return robot if plain else robot.with_tool(tool.position, tool.quaternion_xyzw)


def plan_id(request: PlanRequest | TimingRequest, robot: Robot) -> str:
    """Return the id of a request's plan: a hash of the request, the robot and the version.

    Args:
        request: The request.
        robot: The robot, with the request's tool.

    Returns:
        32 hexadecimal digits.
    """
    return request.content_hash(robot.fingerprint, __version__)
