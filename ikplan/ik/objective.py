"""What the searches minimise.

Sources: [S] Slim et al., Robotics 2023, 12, 38, Eqs. 1, 3 and 15; [L] Li et al., Machines 2023,
11, 648, Eqs. 6-12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.ik.crowding import Surroundings, crowding_term
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import Frame, moved, placed
from ikplan.kinematics.wrist import SphericalWrist, nearest_wrist

__all__ = [
    "ORIENTATION",
    "POSITION",
    "ROSENBROCK",
    "SPHERE",
    "WEIGHTED",
    "WRIST",
    "Objective",
    "evaluate",
    "function_objective",
    "objective_chain",
    "pose_objective",
    "wrist_objective",
]


POSITION = 0
"""eps_p, the distance from the target [m]; [S] Eq. 1."""
ORIENTATION = 1
"""eps_r = ||R - R_d||_F / ||R_d||_F; [S] Eq. 3."""
WEIGHTED = 2
"""omega_P Delta P + omega_R Delta R; [L] Eq. 6, Delta R = ||R - R_d||_F of Eq. 7."""
WRIST = 3
"""Distance of the wrist centre from its target, plus 1 m where the wrist breaks its limits."""
SPHERE = 4
"""sum x_k^2, a test function of the searches."""
ROSENBROCK = 5
"""sum 100 (x_k+1 - x_k^2)^2 + (1 - x_k)^2, a test function of the searches."""


class Objective(NamedTuple):
    """A target and how far from it a configuration is.

    Few arrays, since numba counts the references to each in every call.

    Attributes:
        kind: One of the constants of this module.
        coupled: Whether the serial joints are more than the joint values themselves.
        weight_position: omega_P, per metre.
        weight_orientation: omega_R, per unit of Delta R.
        weight_motion: What a radian (or metre) of distance from the start weighs; 0: nothing.
        placements: Placements of the chain, shape (n + 1, 12), see
            :class:`~ikplan.kinematics.chain.Chain`.
        joints: A row a serial joint: 1 where it slides, its offset, and its coupling to the
            joint values, shape (n, 2 + dof).
        target: Rotation wanted, row by row, and position wanted [m], shape (12,); where the motion
            weighs something, then the start configuration, shape (12 + dof,).
        wrist: Kind WRIST only: rotations A, B and R_tool of the wrist, row by row, its lower and
            upper limits and the values to stay close to, shape (36,); empty for other kinds.
        around: What to keep clear of, as a term beside the error of the pose; None: nothing.
    """

    kind: int
    coupled: bool
    weight_position: float
    weight_orientation: float
    weight_motion: float
    placements: Array
    joints: Array
    target: Array
    wrist: Array
    around: Surroundings | None


@leaf_kernel
def _tool_frame(objective: Objective, x: Array) -> Frame:
    """Return the end of the chain searched over."""
    T, joints = objective.placements, objective.joints
    n = joints.shape[0]
    frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    for i in range(n):
        if objective.coupled:
            value = joints[i, 1]
            for k in range(x.shape[0]):
                value += joints[i, 2 + k] * x[k]
        else:
            value = x[i]
        frame = moved(placed(T, i, frame), value, joints[i, 0] != 0.0)
    return placed(T, n, frame)


@leaf_kernel
def _test_function(kind: int, x: Array) -> float:
    """Return the value of a test function."""
    total = 0.0
    if kind == SPHERE:
        for k in range(x.shape[0]):
            total += x[k] * x[k]
        return total
    for k in range(x.shape[0] - 1):
        total += 100.0 * (x[k + 1] - x[k] * x[k]) ** 2 + (1.0 - x[k]) ** 2
    return total


@leaf_kernel
def _motion_term(objective: Objective, x: Array) -> float:
    """Return what the distance from the start weighs."""
    if objective.weight_motion == 0.0:
        return 0.0
    square = 0.0
    for k in range(x.shape[0]):
        step = x[k] - objective.target[12 + k]
        square += step * step
    return objective.weight_motion * math.sqrt(square)


@kernel
def _wrist_inside(objective: Objective, frame: Frame) -> bool:
    """Whether one of the two wrist solutions is inside the wrist's limits."""
    w, g = objective.wrist, objective.target
    flat = np.array(frame)
    R_arm = flat[:9].copy().reshape(3, 3).T.copy()
    no_chain = Chain(
        objective.placements, np.zeros(0, dtype=np.bool_), False, objective.joints, objective.wrist
    )
    wrist = SphericalWrist(
        no_chain,
        w[:3],
        w[:9].copy().reshape(3, 3),
        w[9:18].copy().reshape(3, 3),
        w[18:27].copy().reshape(3, 3),
        w[27:30],
        w[30:33],
    )
    R_target = g[:9].copy().reshape(3, 3)
    return nearest_wrist(wrist, R_arm, R_target, w[33:36], np.empty(3))


@leaf_kernel
def evaluate(objective: Objective, x: Array) -> float:
    """Return the objective's value of one candidate.

    Args:
        objective: What is minimised.
        x: Joint values searched over, shape (D,) [rad or m].
    """
    kind = objective.kind
    if kind >= SPHERE:
        return _test_function(kind, x)
    frame = _tool_frame(objective, x)
    g = objective.target
    d0, d1, d2 = frame[9] - g[9], frame[10] - g[10], frame[11] - g[11]
    distance = math.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
    if kind == POSITION:
        return distance + crowding_term(objective.around, x, distance) + _motion_term(objective, x)
    if kind == WRIST:
        return distance if _wrist_inside(objective, frame) else distance + 1.0
    square = 0.0
    for i in range(3):
        a, b, c = frame[i] - g[3 * i], frame[3 + i] - g[3 * i + 1], frame[6 + i] - g[3 * i + 2]
        square += a * a + b * b + c * c
    rotation = math.sqrt(square)
    if kind == ORIENTATION:
        value = rotation / math.sqrt(3.0)
    else:
        value = objective.weight_position * distance + objective.weight_orientation * rotation
    return value + crowding_term(objective.around, x, value) + _motion_term(objective, x)


@kernel
def objective_chain(objective: Objective) -> Chain:
    """Return the chain that an objective searches over."""
    return Chain(
        objective.placements,
        objective.joints[:, 0].copy() != 0.0,
        objective.coupled,
        objective.joints[:, 2:].copy(),
        objective.joints[:, 1].copy(),
    )


def pose_objective(
    chain: Chain,
    R_target: Array,
    p_target: Array,
    kind: int = WEIGHTED,
    *,
    weight_position: float = 1.0,
    weight_orientation: float = 0.1,
    weight_motion: float = 0.0,
    q_start: Array | None = None,
    around: Surroundings | None = None,
) -> Objective:
    """Build the objective of a tool pose.

    Args:
        chain: The chain from base to tool.
        R_target: Rotation wanted in the base, shape (3, 3).
        p_target: Position wanted in the base, shape (3,) [m].
        kind: POSITION, ORIENTATION or WEIGHTED.
        weight_position: omega_P, per metre.
        weight_orientation: omega_R, per unit of Delta R.
        weight_motion: What the distance from ``q_start`` weighs, per radian or metre.
        q_start: Start configuration, shape (dof,) [rad or m]; needed where the motion weighs.
        around: What to keep clear of; None: nothing.
    """
    n, dof = chain.coupling.shape
    joints = np.empty((n, 2 + dof))
    joints[:, 0] = chain.prismatic
    joints[:, 1] = chain.offset
    joints[:, 2:] = chain.coupling
    weighs = weight_motion != 0.0 and q_start is not None
    target = np.empty(12 + (dof if weighs else 0))
    target[:9] = np.asarray(R_target).ravel()
    target[9:12] = p_target
    if weighs:
        target[12:] = q_start
    return Objective(
        kind,
        bool(chain.coupled),
        float(weight_position),
        float(weight_orientation),
        float(weight_motion) if weighs else 0.0,
        chain.placements,
        joints,
        target,
        np.empty(0),
        around,
    )


def wrist_objective(
    wrist: SphericalWrist, R_target: Array, p_target: Array, near: Array, *, penalise: bool
) -> Objective:
    """Build the objective of the decoupled arm: the distance of the wrist centre, [S] Eq. 15.

    Args:
        wrist: The arm cut at its wrist.
        R_target: Rotation of the tool wanted in the base, shape (3, 3).
        p_target: Position of the tool wanted in the base, shape (3,) [m].
        near: Wrist joint values to stay close to, shape (3,) [rad].
        penalise: Add 1 m where neither wrist solution is inside its limits; [S] ignores them.
    """
    centre = np.asarray(p_target) + np.asarray(R_target) @ wrist.tool_to_centre
    objective = pose_objective(wrist.arm, R_target, centre, POSITION)
    if not penalise:
        return objective
    rotations = (wrist.A.ravel(), wrist.B.ravel(), wrist.R_tool.ravel())
    packed = np.concatenate([*rotations, wrist.lower, wrist.upper, near])
    return objective._replace(kind=WRIST, wrist=packed)


def function_objective(kind: int) -> Objective:
    """Build a test function: SPHERE or ROSENBROCK, in as many dimensions as the bounds have."""
    nothing = np.zeros((1, 12)), np.zeros((0, 2)), np.zeros(12), np.empty(0), None
    return Objective(kind, False, 1.0, 1.0, 0.0, *nothing)
