"""The chain from base to tool as flat arrays, extracted from a robot's Pinocchio model.

Every joint turns about, or slides along, the z axis of its own frame: an axis ``a`` of the model is
aligned by a constant rotation ``Q`` with ``Q e_z = a``, which is folded into the neighbouring
placements, so that the kernels have one kind of axis to deal with.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["Chain", "aligning_rotation", "chain_of", "placement_of"]


class Chain(NamedTuple):
    """A serial chain of n joints that move with dof joint values.

    Attributes:
        placements: Shape (n + 1, 12): nine entries of the rotation, row by row, and three of the
            translation [m] of joint i in joint i - 1's frame (in the base for i = 0); the last row
            is the tool in the last joint's frame.
        prismatic: Which joints slide, shape (n,).
        coupled: Whether the serial joints are more than the joint values themselves.
        coupling: Serial joint values per joint value, shape (n, dof).
        offset: Serial joint values at joint values of zero, shape (n,) [rad or m].
    """

    placements: Array
    prismatic: Flags
    coupled: bool
    coupling: Array
    offset: Array


def placement_of(chain: Chain, i: int) -> tuple[Array, Array]:
    """Return rotation, shape (3, 3), and translation, shape (3,) [m], of placement i."""
    return chain.placements[i, :9].reshape(3, 3), chain.placements[i, 9:]


def aligning_rotation(axis: Array) -> Array:
    """Return a rotation whose third column is the unit vector ``axis``, shape (3, 3)."""
    # The coordinate axis least along `axis` makes the best conditioned cross product.
    helper = np.zeros(3)
    helper[int(np.argmin(np.abs(axis)))] = 1.0
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def chain_of(robot: Robot) -> Chain:
    """Extract the chain from the robot's Pinocchio model.

    Args:
        robot: A robot; its tool is the end of the chain.

    Returns:
        The chain from the robot's base to its tool.
    """
    model = robot.model
    base = robot.T_universe_base
    rotations, translations, prismatic = [], [], []
    # Alignment of the frame before, and the placement still to be folded into the next joint.
    R_before, p_before = base.rotation.T, -base.rotation.T @ base.translation
    for joint in range(1, model.njoints):
        placement = model.jointPlacements[joint]
        joint_model = model.joints[joint]
        joint_data = joint_model.createData()
        joint_model.calc(joint_data, _neutral(joint_model.nq, joint_model.nv))
        subspace = np.asarray(joint_data.S, dtype=np.float64).reshape(6)
        slides = bool(np.linalg.norm(subspace[3:]) < 0.5)
        axis = subspace[:3] if slides else subspace[3:]
        Q = aligning_rotation(axis / np.linalg.norm(axis))
        rotations.append((R_before @ placement.rotation @ Q).ravel())
        translations.append(R_before @ placement.translation + p_before)
        prismatic.append(slides)
        R_before, p_before = Q.T, np.zeros(3)
    tool = model.frames[robot.tip_frame_id].placement * robot.T_tip_tool
    rotations.append((R_before @ tool.rotation).ravel())
    translations.append(R_before @ tool.translation + p_before)
    coupling = np.array(robot.coupling, dtype=np.float64)
    offset = np.array(robot.coupling_offset, dtype=np.float64)
    identity = coupling.shape[0] == coupling.shape[1] and bool(
        np.array_equal(coupling, np.eye(coupling.shape[0])) and not offset.any()
    )
    return Chain(
        np.hstack([np.reshape(rotations, (-1, 9)), np.reshape(translations, (-1, 3))]),
        np.array(prismatic, dtype=np.bool_),
        not identity,
        np.ascontiguousarray(coupling),
        offset,
    )


def _neutral(nq: int, nv: int) -> Array:
    """Neutral value of one joint: zero, or (cos 0, sin 0) for a continuous one."""
    value = np.zeros(nq)
    if nq > nv:
        value[0] = 1.0
    return value
