"""Robots: loading, checking and describing them.

A :class:`Robot` comes from the catalogue (``robots/``, one folder a robot), from the user's own
folders (``IKPLAN_ROBOTS_PATH``), or from a URDF file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use

if TYPE_CHECKING:
    from ikplan.robots.folders import robot_names
    from ikplan.robots.info import JointInfo, LimitSourceInfo, RobotInfo
    from ikplan.robots.load import catalogue_robot, load_robot, robot_from_urdf
    from ikplan.robots.robot import Robot
    from ikplan.robots.upload import JointLimits, RobotUpload, is_upload_id
    from ikplan.robots.urdf.visual import RobotVisual, catalogue_visual, robot_visual
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "robot_names": "folders",
            "JointInfo": "info",
            "LimitSourceInfo": "info",
            "RobotInfo": "info",
            "catalogue_robot": "load",
            "load_robot": "load",
            "robot_from_urdf": "load",
            "Robot": "robot",
            "JointLimits": "upload",
            "RobotUpload": "upload",
            "is_upload_id": "upload",
            "RobotVisual": "urdf.visual",
            "catalogue_visual": "urdf.visual",
            "robot_visual": "urdf.visual",
        },
    )

__all__ = [
    "JointInfo",
    "JointLimits",
    "LimitSourceInfo",
    "Robot",
    "RobotInfo",
    "RobotUpload",
    "RobotVisual",
    "catalogue_robot",
    "catalogue_visual",
    "is_upload_id",
    "load_robot",
    "robot_from_urdf",
    "robot_names",
    "robot_visual",
]
