"""From the path frame of a request to the robot's base."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.path import PathRequest
from ikplan.documents.poses import Frame, Waypoint
from ikplan.path.pieces.piece import Pose, unit
from ikplan.path.rotation.so3 import rotation_of

__all__ = ["PathFrame"]


class PathFrame:
    """The path frame in the robot's base.

    Args:
        path: The path; where its orientation is free everywhere, every pose comes out without one.
    """

    def __init__(self, path: PathRequest) -> None:
        self._R = rotation_of(path.frame.quaternion_xyzw)
        self._p = np.array(path.frame.position)
        self.positions_only = path.orientation_free == "all"

    def point(self, position: Sequence[float]) -> Array:
        """Return a point of the path frame in the base, shape (3,) [m]."""
        return np.asarray(self._p + self._R @ np.array(position))

    def direction(self, vector: Sequence[float]) -> Array:
        """Return the direction of a vector of the path frame in the base, of length 1, shape (3,).

        Scaled to length 1 here and nowhere after: scaling twice rounds twice.
        """
        return unit(self._R @ np.array(vector))

    def rotation(self, quaternion_xyzw: Sequence[float] | None) -> Array | None:
        """Return a tool orientation in the base, shape (3, 3); None: free."""
        if quaternion_xyzw is None or self.positions_only:
            return None
        return np.asarray(self._R @ rotation_of(quaternion_xyzw))

    def pose(self, waypoint: Waypoint) -> Pose:
        """Return the pose of a waypoint in the base."""
        return Pose(self.rotation(waypoint.quaternion_xyzw), self.point(waypoint.position))

    def poses(self, waypoints: Sequence[Waypoint]) -> list[Pose]:
        """Return the poses of waypoints in the base."""
        points = [self.point(waypoint.position) for waypoint in waypoints]
        rotations: list[Array | None] = [None] * len(points)
        told = [k for k, w in enumerate(waypoints) if w.quaternion_xyzw is not None]
        if told and not self.positions_only:
            turned = self._R @ rotation_of(np.array([waypoints[k].quaternion_xyzw for k in told]))
            for k, R in zip(told, turned, strict=True):
                rotations[k] = R
        return [Pose(R, p) for R, p in zip(rotations, points, strict=True)]

    def frame(self, frame: Frame) -> tuple[Array, Array]:
        """Return rotation (3, 3) and origin (3,) [m] of a frame in the base."""
        R = self._R @ rotation_of(frame.quaternion_xyzw)
        return np.asarray(R), self.point(frame.position)
