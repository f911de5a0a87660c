"""Which robot a request is about: with the request's tool, if that has one."""

from __future__ import annotations

from typing import Protocol

from ikplan.documents.poses import Frame
from ikplan.robots import Robot, catalogue_robot

__all__ = ["RobotRequest", "resolve_robot"]

_NO_TOOL = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])


class RobotRequest(Protocol):
    """A request that names a robot and may put a tool on it."""

    @property
    def robot(self) -> str:
        """Name of the robot."""

    @property
    def tool(self) -> Frame:
        """The tool in the tip frame; the identity: the request has none."""


def resolve_robot(request: RobotRequest, robot: Robot | None = None) -> Robot:
    """Return the robot of a request, with its tool.

    Args:
        request: The request.
        robot: The robot, for one that is not in the catalogue; None: load it by name. Its tool
            stands unless the request has one.

    Raises:
        RobotNotFound: The catalogue has no robot of that name.
    """
    if robot is None:
        robot = catalogue_robot(request.robot)
    tool = request.tool
    if (tool.position, tool.quaternion_xyzw) == _NO_TOOL:
        return robot
    return robot.with_tool(tool.position, tool.quaternion_xyzw)
