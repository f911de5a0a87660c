"""Poses of a request in the robot's base: the path frame, waypoints, directions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.certificate.requested.rotations import angle_between, rotation_of, unit
from ikplan.documents.path import PathRequest
from ikplan.documents.poses import Frame, Waypoint

__all__ = ["SAME_PLACE", "PathFrame", "RequestedPose"]


SAME_PLACE = 1e-9
"""Poses this near to one another are one pose [m and rad]."""


@dataclass(frozen=True, eq=False)
class RequestedPose:
    """A pose of the tool in the base.

    Attributes:
        p: Position, shape (3,) [m].
        R: Rotation, shape (3, 3); None: free.
    """

    p: Array
    R: Array | None

    def passed_from(self, before: RequestedPose) -> RequestedPose:
        """Return where the tool passes this pose: where it is already if both are one place."""
        if not length_of(self.p - before.p) <= SAME_PLACE:
            return self
        if self.R is None or before.R is None:
            return RequestedPose(before.p, self.R)
        return before if angle_between(before.R, self.R) <= SAME_PLACE else self


class PathFrame:
    """The path frame in the base.

    Args:
        path: The path; where only its positions count, no pose has an orientation.
    """

    def __init__(self, path: PathRequest) -> None:
        self.R = rotation_of(path.frame.quaternion_xyzw)
        self.p: Array = np.array(path.frame.position)
        self.positions_only = path.orientation_free == "all"

    def point(self, position: Sequence[float]) -> Array:
        """Return a point in the base, shape (3,) [m]."""
        return np.asarray(self.R @ np.array(position) + self.p)

    def direction(self, vector: Sequence[float]) -> Array:
        """Return a direction in the base, of length 1, shape (3,)."""
        return np.asarray(self.R @ unit(vector))

    def rotation(self, quaternion_xyzw: Sequence[float] | None) -> Array | None:
        """Return an orientation in the base, shape (3, 3); None: free."""
        if quaternion_xyzw is None or self.positions_only:
            return None
        return np.asarray(self.R @ rotation_of(quaternion_xyzw))

    def pose(self, waypoint: Waypoint) -> RequestedPose:
        """Return the pose of a waypoint."""
        return RequestedPose(self.point(waypoint.position), self.rotation(waypoint.quaternion_xyzw))

    def frame(self, frame: Frame) -> tuple[Array, Array]:
        """Return rotation (3, 3) and origin (3,) [m] of a frame within the path frame."""
        return self.R @ rotation_of(frame.quaternion_xyzw), self.point(frame.position)
