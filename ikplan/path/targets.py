"""From the waypoints of a request to targets in the robot's base."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ikplan.kinematics.target import Target, pose_target
from ikplan.request import PathRequest

__all__ = ["rotation_of", "targets_of"]

Array = NDArray[np.float64]


def rotation_of(quaternion_xyzw: Sequence[float]) -> Array:
    """Return the rotation matrix of a unit quaternion (x, y, z, w), shape (3, 3)."""
    x, y, z, w = quaternion_xyzw
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def targets_of(path: PathRequest) -> list[Target]:
    """Return the target of each waypoint: the tool pose wanted in the robot's base.

    Args:
        path: The path, its waypoints given in the path frame.
    """
    R_base_path = rotation_of(path.frame.quaternion_xyzw)
    p_base_path = np.array(path.frame.position)
    targets = []
    for waypoint in path.waypoints:
        position = p_base_path + R_base_path @ np.array(waypoint.position)
        rotation = None
        if waypoint.quaternion_xyzw is not None:
            rotation = R_base_path @ rotation_of(waypoint.quaternion_xyzw)
        targets.append(pose_target(position, rotation))
    return targets
