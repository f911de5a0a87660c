"""When two poses of a path are one."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.arrays import length_of
from ikplan.path.pieces.piece import Pose
from ikplan.path.rotation.so3 import angle_between

__all__ = ["COINCIDENT", "coincide", "joined"]

COINCIDENT = 1e-9
"""Positions [m] and orientations [rad] no farther apart than this are one.

Inverse kinematics meets a pose as exactly as this, and a position written with nine decimals is
within it. Every part of a path that is left is longer than the rounding errors of its length.
"""


def coincide(a: Pose, b: Pose) -> bool:
    """Whether two poses are one; a free orientation is that of the other."""
    if not length_of(b.p - a.p) <= COINCIDENT:
        return False
    return a.R is None or b.R is None or float(angle_between(a.R, b.R)) <= COINCIDENT


def joined(poses: Sequence[Pose]) -> list[Pose]:
    """Return poses of which each that coincides with the one before is exactly there.

    Each is compared with where the one before has been put, so that many small steps add up to a
    way and are not lost.
    """
    passed = list(poses[:1])
    for pose in poses[1:]:
        before = passed[-1]
        if coincide(before, pose):
            both = before.R is not None and pose.R is not None
            pose = Pose(before.R if both else pose.R, before.p)
        passed.append(pose)
    return passed
