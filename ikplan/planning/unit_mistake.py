"""Paths whose coordinates are all in another unit than metres."""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.documents.path import PathRequest
from ikplan.documents.poses import Waypoint
from ikplan.errors import Unreachable
from ikplan.path import rotation_of
from ikplan.planning.joint_route import JointPathProblem
from ikplan.robots.reach import MILLIMETRES, unit_hint, with_hint

__all__ = ["in_millimetres", "name_unit_mistake"]


def name_unit_mistake(problem: JointPathProblem, error: Unreachable) -> bool:
    """Say in an error that all coordinates seem to be millimetres, if they do.

    Returns:
        Whether they do.
    """
    path = problem.path
    R, p = rotation_of(path.frame.quaternion_xyzw), np.array(path.frame.position)
    positions = [(p + R @ np.array(pose.position)).tolist() for pose in _poses(path)]
    hint = unit_hint(problem.robot, positions)
    with_hint(error, hint)
    return hint is not None


def _poses(path: PathRequest) -> list[Waypoint]:
    """The poses that a path names."""
    if path.waypoints is not None:
        return list(path.waypoints)
    poses = [path.begin]
    for segment in path.segments or ():
        poses += [getattr(segment, "to", None), *getattr(segment, "through", ())]
    return [pose for pose in poses if pose is not None]


def in_millimetres(path: PathRequest) -> PathRequest | None:
    """Return a path with its coordinates read as millimetres; None: it has other lengths too."""
    if any(s.type not in ("line", "spline", "joint") for s in path.segments or ()):
        return None
    return PathRequest.model_validate(_scaled(path.model_dump(mode="json", exclude_unset=True)))


def _scaled(value: Any) -> Any:
    """A document with every position but that of the path frame in millimetres."""
    if isinstance(value, list):
        return [_scaled(v) for v in value]
    if not isinstance(value, dict):
        return value
    scaled = {key: v if key in ("frame", "tolerance") else _scaled(v) for key, v in value.items()}
    if "position" in value:
        scaled["position"] = [v / round(1.0 / MILLIMETRES) for v in value["position"]]
    return scaled
