"""The path asked for: poses, segments, and what must hold along them."""

from ikplan.path.build.legs import JointLeg, JointTarget, Leg, ToolLeg, legs_of
from ikplan.path.pieces.piece import TURN_LENGTH, Motion, Piece, Pose
from ikplan.path.rotation.so3 import rotation_of
from ikplan.path.tool_path import Corner, PathStretch, PathWaypoint, ToolPath

__all__ = [
    "TURN_LENGTH",
    "Corner",
    "JointLeg",
    "JointTarget",
    "Leg",
    "Motion",
    "PathStretch",
    "PathWaypoint",
    "Piece",
    "Pose",
    "ToolLeg",
    "ToolPath",
    "legs_of",
    "rotation_of",
]
