"""What a request leaves free at its targets, as the kernels see it."""

from __future__ import annotations

import numpy as np

from ikplan.documents.path import PathRequest
from ikplan.kinematics.target import Freedom, Target, no_freedom, pose_target
from ikplan.path import Pose, rotation_of

__all__ = ["counts_orientation", "freedom_of", "target_of"]

_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}


def counts_orientation(path: PathRequest) -> bool:
    """Whether the orientations of a path count at all."""
    return path.orientation_free != "all"


def target_of(path: PathRequest, pose: Pose, freedom: Freedom | None = None) -> Target:
    """Return the target that a pose of a path is: what counts of it, and what is left free.

    Args:
        path: The path.
        pose: The pose.
        freedom: What the path leaves free, where that is known already.
    """
    R = pose.R if counts_orientation(path) else None
    return pose_target(pose.p, R, freedom=freedom or freedom_of(path))


def freedom_of(path: PathRequest) -> Freedom:
    """Return what a path leaves free at each of its targets."""
    freedom = no_freedom()
    free = path.orientation_free
    if free is not None and free != "all":
        freedom = freedom._replace(axis=_AXES[free.about], cone=float(free.cone or 0.0))
    box = path.tolerance.box
    if box is not None:
        freedom = freedom._replace(
            boxed=True,
            box=np.array([*box.position, *box.orientation], dtype=np.float64),
            in_tool=box.frame == "tool",
            R_box=np.ascontiguousarray(rotation_of(path.frame.quaternion_xyzw)),
        )
    return freedom
