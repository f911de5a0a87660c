"""The path asked for: poses, segments, and what must hold along them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use

if TYPE_CHECKING:
    from ikplan.path.build.found_corners import FoundCorners
    from ikplan.path.build.legs import JointLeg, JointWaypoint, Leg, MoveLeg, ToolLeg, legs_of
    from ikplan.path.build.passed_order import first_rows, passed_rows
    from ikplan.path.pieces.piece import TURN_LENGTH, PathDerivatives, Piece, Pose
    from ikplan.path.rotation.so3 import rotation_of
    from ikplan.path.tolerance_shares import Rounding
    from ikplan.path.tool_path import Corner, PathWaypoint, SegmentRange, ToolPath
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "FoundCorners": "build.found_corners",
            "JointLeg": "build.legs",
            "JointWaypoint": "build.legs",
            "Leg": "build.legs",
            "MoveLeg": "build.legs",
            "ToolLeg": "build.legs",
            "legs_of": "build.legs",
            "first_rows": "build.passed_order",
            "passed_rows": "build.passed_order",
            "Rounding": "tolerance_shares",
            "TURN_LENGTH": "pieces.piece",
            "PathDerivatives": "pieces.piece",
            "Piece": "pieces.piece",
            "Pose": "pieces.piece",
            "rotation_of": "rotation.so3",
            "Corner": "tool_path",
            "PathWaypoint": "tool_path",
            "SegmentRange": "tool_path",
            "ToolPath": "tool_path",
        },
    )

__all__ = [
    "TURN_LENGTH",
    "Corner",
    "FoundCorners",
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
    "first_rows",
    "legs_of",
    "passed_rows",
    "rotation_of",
]
