"""Timing: when the joints are where along a geometric path, under the limits of the robot."""

from ikplan.timing.binding import Binding, BindingShare, WhatIf, binding, what_if
from ikplan.timing.constraints import ConstraintRows, PathConstraint, PathPoints
from ikplan.timing.joint_path import JointPath
from ikplan.timing.kept import sampled_within_limits
from ikplan.timing.limits import JointLimits, LimitedRobot
from ikplan.timing.profile import SegmentLimits
from ikplan.timing.retime import Retimed, retime
from ikplan.timing.sampling import Samples, knots, sample
from ikplan.timing.time_path import time_joint_path
from ikplan.timing.timed_path import TimedPath
from ikplan.timing.tool_limits import ToolLimits, ToolMotion
from ikplan.timing.torque_limits import InverseDynamics, TorqueLimits

__all__ = [
    "Binding",
    "BindingShare",
    "ConstraintRows",
    "InverseDynamics",
    "JointLimits",
    "JointPath",
    "LimitedRobot",
    "PathConstraint",
    "PathPoints",
    "Retimed",
    "Samples",
    "SegmentLimits",
    "TimedPath",
    "ToolLimits",
    "ToolMotion",
    "TorqueLimits",
    "WhatIf",
    "binding",
    "knots",
    "retime",
    "sample",
    "sampled_within_limits",
    "time_joint_path",
    "what_if",
]
