"""An arm made ready for the kernels: its chain, its limits, its wrist, its shoulder."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.chain import Chain, chain_of
from ikplan.kinematics.closed_form.form import ClosedForm, find_closed_form
from ikplan.kinematics.forward import forward_into
from ikplan.kinematics.wrist import SphericalWrist, find_wrist

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["Arm", "Shoulder", "arm_of"]


@dataclass(frozen=True)
class Shoulder:
    """A point that no joint moves, and how far from it the wrist centre can be.

    Attributes:
        centre: Where the first axes meet, in the base, shape (3,) [m].
        nearest: Smallest distance of the wrist centre within the elbow's limits [m].
        farthest: Largest such distance [m].
    """

    centre: Array
    nearest: float
    farthest: float


@dataclass(frozen=True)
class Arm:
    """A robot's kinematics as the kernels want them.

    Attributes:
        chain: The chain from base to tool.
        lower: Lower position limits, shape (dof,); -inf for continuous joints [rad or m].
        upper: Upper position limits, shape (dof,); inf for continuous joints [rad or m].
        wrist: The spherical wrist, if the arm has one.
        shoulder: The shoulder, if the arm has one, a wrist, and one joint between them.
        bounded: Whether every joint has position limits.
        closed_form: The closed form of its inverse kinematics; of the kind NO_FORM if it has none.
    """

    chain: Chain
    lower: Array
    upper: Array
    wrist: SphericalWrist | None
    shoulder: Shoulder | None
    bounded: bool
    closed_form: ClosedForm

    @property
    def dof(self) -> int:
        """Number of joint values."""
        return int(self.lower.shape[0])

    def search_bounds(self, q_start: Array) -> tuple[Array, Array]:
        """Return finite bounds, each of shape (dof,): a continuous joint's are half a turn around.

        Args:
            q_start: Configuration to stay near to, shape (dof,) [rad or m].
        """
        if self.bounded:
            return self.lower, self.upper
        lower = np.where(np.isfinite(self.lower), self.lower, q_start - math.pi)
        upper = np.where(np.isfinite(self.upper), self.upper, q_start + math.pi)
        return lower, upper


@functools.lru_cache(maxsize=128)
def arm_of(robot: Robot) -> Arm:
    """Return the arm of a robot. Robots do not change, so neither do their arms."""
    chain = chain_of(robot)
    lower = np.array(robot.lower, dtype=np.float64)
    upper = np.array(robot.upper, dtype=np.float64)
    wrist = find_wrist(chain, lower, upper)
    bounded = bool(np.isfinite(lower).all() and np.isfinite(upper).all())
    shoulder = _find_shoulder(wrist, lower, upper)
    return Arm(chain, lower, upper, wrist, shoulder, bounded, find_closed_form(chain))


def _find_shoulder(wrist: SphericalWrist | None, lower: Array, upper: Array) -> Shoulder | None:
    """Find the point where all axes before the elbow meet, and the reach from it.

    With joints 1..k meeting in S and one elbow joint k + 1 before the wrist, the distance of the
    wrist centre from S depends on the elbow alone: its square is a + b cos + c sin of the angle.
    """
    if wrist is None:
        return None
    arm = wrist.arm
    elbow = arm.prismatic.shape[0] - 1
    if elbow < 2 or arm.prismatic.any():
        return None
    R, p = np.empty((3, 3)), np.empty(3)
    z, o = np.empty((elbow + 1, 3)), np.empty((elbow + 1, 3))
    q = np.zeros(elbow + 1)
    forward_into(arm, q, R, p, z, o)
    # Least-squares point of the lines (o_i, z_i).
    projectors = [np.eye(3) - np.outer(z[i], z[i]) for i in range(elbow)]
    normal = sum(projectors, np.zeros((3, 3)))
    if np.linalg.cond(normal) > 1e9:
        return None
    centre = np.linalg.solve(normal, sum((P @ o[i] for i, P in enumerate(projectors)), np.zeros(3)))
    if max(np.linalg.norm(P @ (centre - o[i])) for i, P in enumerate(projectors)) > 1e-9:
        return None

    def squared(angle: float) -> float:
        q[elbow] = angle
        forward_into(arm, q, R, p, z, o)
        return float((p - centre) @ (p - centre))

    at = [squared(angle) for angle in (0.0, 0.5 * math.pi, math.pi)]
    b, c = 0.5 * (at[0] - at[2]), at[1] - 0.5 * (at[0] + at[2])
    stationary = math.atan2(c, b)
    low, high = float(lower[elbow]), float(upper[elbow])
    if not high - low < 2.0 * math.pi:
        low, high = -math.pi, math.pi
    first = stationary + math.pi * math.ceil((low - stationary) / math.pi)
    angles = [a for a in (first, first + math.pi) if a <= high]
    reach = [math.sqrt(max(squared(a), 0.0)) for a in (low, high, *angles)]
    return Shoulder(centre, min(reach), max(reach))
