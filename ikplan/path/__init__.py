"""The path asked for: poses, segments, and what must hold along them."""

from ikplan.path.build.legs import JointLeg, JointWaypoint, Leg, MoveLeg, ToolLeg, legs_of
from ikplan.path.build.tolerance_corners import Rounding
from ikplan.path.pieces.piece import TURN_LENGTH, PathDerivatives, Piece, Pose
from ikplan.path.rotation.so3 import rotation_of
from ikplan.path.tool_path import Corner, PathWaypoint, SegmentRange, ToolPath

__all__ = [
    "TURN_LENGTH",
    "Corner",
    "JointLeg",
    "JointWaypoint",
    "Leg",
    "MoveLeg",
    "PathDerivatives",
    "PathWaypoint",
    "Piece",
    "Pose",
    "Rounding",
    "SegmentRange",
    "ToolLeg",
    "ToolPath",
    "legs_of",
    "rotation_of",
]
