"""Timing: when the joints are where along a geometric path, under the limits of the robot."""

from ikplan.timing.binding import Binding, BindingShare, WhatIf, binding, what_if, what_ifs
from ikplan.timing.constraints.constraints import ConstraintRows, PathConstraint, PathPoints
from ikplan.timing.constraints.tool_limits import ToolLimits, ToolRates
from ikplan.timing.constraints.torque_limits import InverseDynamics, TorqueLimits
from ikplan.timing.profile import SegmentJointLimits
from ikplan.timing.sampled_within_limits import sampled_within_limits
from ikplan.timing.sampling import Samples, on_grid, periods, sample, sample_at_nodes
from ikplan.timing.time_joint_path import time_joint_path
from ikplan.timing.timed_path import TimedPath

__all__ = [
    "Binding",
    "BindingShare",
    "ConstraintRows",
    "InverseDynamics",
    "PathConstraint",
    "PathPoints",
    "Samples",
    "SegmentJointLimits",
    "TimedPath",
    "ToolLimits",
    "ToolRates",
    "TorqueLimits",
    "WhatIf",
    "binding",
    "on_grid",
    "periods",
    "sample",
    "sample_at_nodes",
    "sampled_within_limits",
    "time_joint_path",
    "what_if",
    "what_ifs",
]
