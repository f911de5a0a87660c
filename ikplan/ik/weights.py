"""The weights of the fitness of Li et al., computed from the arm.

Source: [L] Li, Luo, Qiao, "Inverse Kinematics of Robot Manipulator Based on BODE-CS Algorithm",
Machines 2023, 11(6), 648, Eqs. 6-12.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from ikplan.kinematics.arm import Arm
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_batch, forward_into

__all__ = ["FitnessWeights", "arm_length", "fitness_weights"]


_SAMPLES = 300_000


@dataclass(frozen=True)
class FitnessWeights:
    """omega_P, omega_R and what they are computed from; the fitness is in millimetres.

    Attributes:
        l_arm: Sum of the link lengths |d_i| + |a_i| [m].
        nearest: Smallest distance of the tool from the base in a random sample [m].
        farthest: Largest such distance [m].
        joint_range: Sum of the ranges of the revolute joints [rad].
        lambda_p: (farthest - nearest) / l_arm.
        omega_position: omega_P, the weight of the distance: 1 per millimetre, so 1000 per metre.
        omega_rotation: omega_R, the weight of ||R - R_d||_F [mm].
    """

    l_arm: float
    nearest: float
    farthest: float
    joint_range: float
    lambda_p: float
    omega_position: float
    omega_rotation: float


def fitness_weights(arm: Arm) -> FitnessWeights:
    """Compute the weights of an arm, from a random sample that is the same every time.

    omega_R = (lambda_R (1 rad) / sum(theta_max - theta_min)) / lambda_p, lambda_R = 1 - lambda_p,
    and omega_P = 1 per millimetre.
    """
    return _weights(arm.chain.placements.tobytes(), arm.lower.tobytes(), _Hidden(arm))


class _Hidden:
    """Carries an arm past a cache whose keys are the arm's own numbers."""

    def __init__(self, arm: Arm) -> None:
        self.arm = arm

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Hidden)

    def __hash__(self) -> int:
        return 0


@functools.lru_cache(maxsize=64)
def _weights(_chain: bytes, _limits: bytes, hidden: _Hidden) -> FitnessWeights:
    arm = hidden.arm
    lower, upper = arm.search_bounds(np.zeros(arm.dof))
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence([_SAMPLES])))
    q = lower + rng.random((_SAMPLES, arm.dof)) * (upper - lower)
    _, p = forward_batch(arm.chain, q)
    distances = np.linalg.norm(p, axis=1)
    nearest, farthest = float(distances.min()), float(distances.max())
    l_arm = arm_length(arm.chain)
    moving = np.abs(arm.chain.coupling[~arm.chain.prismatic]).sum(axis=0) > 0.0
    joint_range = float((upper - lower)[moving].sum())
    lambda_p = (farthest - nearest) / l_arm
    omega_R = (1.0 - lambda_p) / joint_range / lambda_p
    return FitnessWeights(l_arm, nearest, farthest, joint_range, lambda_p, 1000.0, omega_R)


def arm_length(chain: Chain) -> float:
    """Return sum |d_i| + |a_i| of the chain's Denavit-Hartenberg parameters [m].

    Between parallel axes the common normal is taken through the last point, which makes their
    d zero and leaves the offset to the next axis that is not parallel.
    """
    n, dof = chain.coupling.shape
    R, p = np.empty((3, 3)), np.empty(3)
    z, o = np.empty((n, 3)), np.empty((n, 3))
    forward_into(chain, np.zeros(dof), R, p, z, o)
    axis, point, total = np.array([0.0, 0.0, 1.0]), np.zeros(3), 0.0
    for i in range(n):
        normal = np.cross(axis, z[i])
        apart = o[i] - point
        sine = float(np.linalg.norm(normal))
        if sine < 1e-9:
            a = apart - (apart @ axis) * axis
            point = point + a
        else:
            a = (apart @ normal) / sine**2 * normal
            # On the last axis, point + d axis + a must lie on the next axis.
            d = float(np.cross(apart, z[i]) @ normal) / sine**2
            point = point + d * axis + a
            total += abs(d)
        total += float(np.linalg.norm(a))
        axis = z[i]
    end = p - point
    along = float(end @ axis)
    return total + abs(along) + math.sqrt(max(float(end @ end) - along * along, 0.0))
