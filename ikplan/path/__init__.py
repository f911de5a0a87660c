"""The path asked for: poses, segments, and what must hold along them."""

from ikplan.path.deviation import path_deviation
from ikplan.path.legs import JointLeg, JointTarget, Leg, ToolLeg, legs_of
from ikplan.path.piece import TURN_LENGTH, Motion, Piece, Pose
from ikplan.path.rotation import rotation_of
from ikplan.path.tool_path import Corner, PathStretch, PathWaypoint, ToolPath
from ikplan.path.waypoints_csv import read_waypoints_csv

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
    "path_deviation",
    "read_waypoints_csv",
    "rotation_of",
]
