"""What the searches minimise.

Sources: [S] Slim et al., Robotics 2023, 12, 38, Eqs. 1, 3 and 15; [L] Li et al., Machines 2023,
11, 648, Eqs. 6-12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_into
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
    "pose_objective",
    "wrist_objective",
]

Array = NDArray[np.float64]

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
    """A target and how far from it a configuration is. One search at a time uses it.

    Attributes:
        kind: One of the constants of this module.
        chain: The chain searched over.
        R_target: Rotation wanted, shape (3, 3).
        p_target: Position wanted, shape (3,) [m].
        weight_position: omega_P, per metre.
        weight_orientation: omega_R, per unit of Delta R.
        wrist: The wrist, used by kind WRIST only.
        near: Wrist joint values to stay close to, shape (3,) [rad], used by kind WRIST only.
        R: Work space, shape (3, 3).
        p: Work space, shape (3,).
        z: Work space, shape (n, 3).
        o: Work space, shape (n, 3).
    """

    kind: int
    chain: Chain
    R_target: Array
    p_target: Array
    weight_position: float
    weight_orientation: float
    wrist: SphericalWrist
    near: Array
    R: Array
    p: Array
    z: Array
    o: Array


@kernel
def evaluate(objective: Objective, x: Array) -> float:
    """Return the objective's value of one candidate.

    Args:
        objective: What is minimised.
        x: Joint values searched over, shape (D,) [rad or m].
    """
    kind = objective.kind
    if kind == SPHERE:
        total = 0.0
        for k in range(x.shape[0]):
            total += x[k] * x[k]
        return total
    if kind == ROSENBROCK:
        total = 0.0
        for k in range(x.shape[0] - 1):
            total += 100.0 * (x[k + 1] - x[k] * x[k]) ** 2 + (1.0 - x[k]) ** 2
        return total
    R, p = objective.R, objective.p
    forward_into(objective.chain, x, R, p, objective.z, objective.o)
    distance = 0.0
    for k in range(3):
        distance += (p[k] - objective.p_target[k]) ** 2
    distance = math.sqrt(distance)
    if kind == POSITION:
        return distance
    if kind == WRIST:
        angles = np.empty(3)
        if not nearest_wrist(objective.wrist, R, objective.R_target, objective.near, angles):
            distance += 1.0
        return distance
    rotation = 0.0
    for i in range(3):
        for k in range(3):
            rotation += (R[i, k] - objective.R_target[i, k]) ** 2
    rotation = math.sqrt(rotation)
    if kind == ORIENTATION:
        return rotation / math.sqrt(3.0)
    return objective.weight_position * distance + objective.weight_orientation * rotation


def _no_wrist() -> SphericalWrist:
    empty = Chain(
        np.zeros((1, 12)),
        np.zeros(0, dtype=np.bool_),
        False,
        np.zeros((0, 0)),
        np.zeros(0),
    )
    z3, z33 = np.zeros(3), np.zeros((3, 3))
    return SphericalWrist(empty, z3, z33, z33, z33, z3, z3)


def pose_objective(
    chain: Chain,
    R_target: Array,
    p_target: Array,
    kind: int = WEIGHTED,
    *,
    weight_position: float = 1.0,
    weight_orientation: float = 0.1,
) -> Objective:
    """Build the objective of a tool pose.

    Args:
        chain: The chain from base to tool.
        R_target: Rotation wanted in the base, shape (3, 3).
        p_target: Position wanted in the base, shape (3,) [m].
        kind: POSITION, ORIENTATION or WEIGHTED (or a test function).
        weight_position: omega_P, per metre.
        weight_orientation: omega_R, per unit of Delta R.
    """
    n = chain.prismatic.shape[0]
    return Objective(
        kind,
        chain,
        np.ascontiguousarray(R_target, dtype=np.float64),
        np.ascontiguousarray(p_target, dtype=np.float64),
        float(weight_position),
        float(weight_orientation),
        _no_wrist(),
        np.zeros(3),
        np.empty((3, 3)),
        np.empty(3),
        np.empty((n, 3)),
        np.empty((n, 3)),
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
    kind = WRIST if penalise else POSITION
    return pose_objective(wrist.arm, R_target, centre, kind)._replace(
        wrist=wrist, near=np.ascontiguousarray(near, dtype=np.float64)
    )
