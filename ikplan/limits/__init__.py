"""What a motion has to keep, merged once: read by planning, timing and certificate alike."""

from ikplan.limits.joint_limits import JointLimits, LimitedRobot
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits

__all__ = ["JointLimits", "LimitedRobot", "LimitedSegment", "MotionLimits"]
