"""The geometric joint path q(s): a cubic spline through configurations."""

from ikplan.joint_path.joint_path import JointPath

__all__ = ["JointPath"]
