"""Frames fixed to a robot's base: what its controller calls base may be another link."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from ikplan.errors import InvalidRequest, near_names

if TYPE_CHECKING:
    from ikplan.robots.robot import Robot

__all__ = ["CONTROLLER", "base_links", "frame_in_base"]

CONTROLLER = "controller"
"""The frame that the robot's controller calls its base, where the description has it."""


def base_links(robot: Robot) -> list[str]:
    """Return the links that do not move against the robot's base."""
    frames = robot.model.frames
    return [
        frame.name
        for frame in frames
        if frame.parentJoint == 0 and frame.type == pin.FrameType.BODY and frame.name != "universe"
    ]


def frame_in_base(
    robot: Robot, name: str, inside: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Return a frame fixed to the base as a request has it.

    Args:
        robot: The robot.
        name: A link that does not move against the base, or ``"controller"``.
        inside: A frame given in that frame; None: the frame itself.

    Returns:
        Position [m] and unit quaternion (x, y, z, w) in the robot's base.

    Raises:
        InvalidRequest: No such frame; lists those there are.
    """
    T = _placement(robot, name)
    if inside is not None:
        quaternion = inside.get("quaternion_xyzw", [0.0, 0.0, 0.0, 1.0])
        T = T * pin.XYZQUATToSE3(np.array([*inside["position"], *quaternion], dtype=np.float64))
    xyzquat = pin.SE3ToXYZQUAT(T)
    # Adding zero turns -0.0 into 0.0.
    return {
        "position": (xyzquat[:3] + 0.0).tolist(),
        "quaternion_xyzw": (xyzquat[3:] + 0.0).tolist(),
    }


def _placement(robot: Robot, name: str) -> pin.SE3:
    links = base_links(robot)
    if name == CONTROLLER:
        controller = getattr(robot.info(), "controller", None)
        frame = getattr(controller, "base_frame", None)
        if frame is not None:
            return pin.XYZQUATToSE3(np.array([*frame.position, *frame.quaternion_xyzw]))
    if name in links:
        frame_id = robot.model.getFrameId(name, pin.FrameType.BODY)
        return robot.T_universe_base.inverse() * robot.model.frames[frame_id].placement
    near = near_names(name, links)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    why = "its controller's base is not known" if name == CONTROLLER else "no such link"
    raise InvalidRequest(
        f"base_frame: {robot.name}: {why}{hint}; fixed to its base are {', '.join(links)}",
        field="base_frame",
        allowed=links,
    )
