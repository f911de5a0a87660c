"""Kinematics on flat arrays: the chain taken from a Pinocchio model and the kernels on it."""

from ikplan.kinematics.chain import Chain, chain_of
from ikplan.kinematics.forward import forward, forward_batch, jacobian, pose_error

__all__ = ["Chain", "chain_of", "forward", "forward_batch", "jacobian", "pose_error"]
