"""fk_request(): joint values to a tool pose, without anything of planning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from ikplan.documents import parse
from ikplan.documents.pose_results import FkResult
from ikplan.documents.requests.fk import FkRequest
from ikplan.pipeline.resolve import resolve_robot
from ikplan.robots import Robot

__all__ = ["fk_request"]


def fk_request(request: Mapping[str, Any] | FkRequest, *, robot: Robot | None = None) -> FkResult:
    """Return the tool pose of the joint values of an FK request.

    Args:
        request: The request document.
        robot: The robot, for one that is not in the catalogue; None: load it by name.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
    """
    request = parse(FkRequest, request)
    robot = resolve_robot(request, robot)
    q = np.array(request.q)
    pose = pin.SE3ToXYZQUAT(robot.fk(q))
    return FkResult(position=pose[:3], quaternion_xyzw=pose[3:])
