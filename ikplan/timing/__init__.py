"""Timing: when the joints are where along a geometric path, under the limits of the robot."""

from ikplan.timing.joint_path import JointPath
from ikplan.timing.limits import JointLimits, LimitedRobot
from ikplan.timing.retime import Retimed, retime
from ikplan.timing.sampling import Samples, sample
from ikplan.timing.time_path import time_joint_path
from ikplan.timing.timed_path import TimedPath

__all__ = [
    "JointLimits",
    "JointPath",
    "LimitedRobot",
    "Retimed",
    "Samples",
    "TimedPath",
    "retime",
    "sample",
    "time_joint_path",
]
