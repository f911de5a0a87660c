"""Robots: loading, checking and describing them.

A :class:`Robot` comes from the catalogue (``robots/``, one folder a robot), from the user's own
folders (``IKPLAN_ROBOTS_PATH``), or from a URDF file.
"""

from ikplan.robots.folders import robot_names
from ikplan.robots.info import JointInfo, LimitSourceInfo, RobotInfo
from ikplan.robots.load import catalogue_robot, load_robot, robot_from_urdf
from ikplan.robots.robot import Robot
from ikplan.robots.upload import JointLimits, RobotUpload, is_upload_id
from ikplan.robots.urdf.visual import RobotVisual, catalogue_visual, robot_visual

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
