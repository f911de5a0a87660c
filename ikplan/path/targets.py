"""From the waypoints of a request to targets in the robot's base."""

from __future__ import annotations

import numpy as np

from ikplan.kinematics.target import Target, pose_target
from ikplan.path.rotation import rotation_of
from ikplan.request import PathRequest

__all__ = ["targets_of"]


def targets_of(path: PathRequest) -> list[Target]:
    """Return the target of each waypoint: the tool pose wanted in the robot's base.

    Args:
        path: The path, its waypoints given in the path frame.
    """
    R_base_path = rotation_of(path.frame.quaternion_xyzw)
    p_base_path = np.array(path.frame.position)
    targets = []
    for waypoint in path.waypoints or ():
        position = p_base_path + R_base_path @ np.array(waypoint.position)
        rotation = None
        if waypoint.quaternion_xyzw is not None:
            rotation = R_base_path @ rotation_of(waypoint.quaternion_xyzw)
        targets.append(pose_target(position, rotation))
    return targets
