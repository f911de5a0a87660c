"""Why a target has no solution: by how much it is missed, which limit binds, what is too far."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.levenberg_marquardt import Effort, new_workspace, refine
from ikplan.ik.restarts import restart_into
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target

__all__ = ["ClosestApproach", "explain_unreachable", "within"]

_FIRST = Effort(16, 100)
_FURTHER = Effort(100, 100)
_FOLLOWED = 3
"""Steps from every seed, from those that came closest, and one of how many seeds these are."""
_GAIN = 10.0
"""How much nearer an error of the orientation may bring the tool, at most [m/rad]."""


@dataclass(frozen=True)
class ClosestApproach:
    """The closest that the arm gets to a target.

    Attributes:
        q: Joint values of the closest configuration found, shape (dof,) [rad or m].
        position_error: Its distance from the target [m].
        orientation_error: Its rotation from the target [rad]; None for a position target.
        limits: Indices of the joints at a position limit there.
        reason: The cause, in words, with figures.
    """

    q: Array
    position_error: float
    orientation_error: float | None
    limits: list[int]
    reason: str


@kernel
def _closest(
    chain: Chain, target: Target, seeds: Array, lower: Array, upper: Array, restarts: int, q: Array
) -> tuple[float, float, int]:
    """Write the closest configuration to ``q``; its distance [m], angle [rad] and evaluations.

    From every seed a few steps are taken; then the search goes on from those that came closest.
    """
    w = new_workspace(chain)
    count = seeds.shape[0] + restarts
    trials = np.empty((count, q.shape[0]))
    value = np.empty(count)
    best, best_distance, best_angle, evaluations = math.inf, math.inf, math.inf, 0
    for attempt in range(count):
        trial = trials[attempt]
        if attempt < seeds.shape[0]:
            trial[:] = seeds[attempt]
        else:
            restart_into(attempt - seeds.shape[0], 0.5, lower, upper, trial)
        distance, angle, spent = refine(chain, target, trial, lower, upper, _FIRST, w)
        evaluations += spent
        value[attempt] = distance * distance + (target.weight * angle) ** 2
    for _ in range((count + _FOLLOWED - 1) // _FOLLOWED):
        attempt = int(np.argmin(value))
        trial = trials[attempt]
        value[attempt] = math.inf
        distance, angle, spent = refine(chain, target, trial, lower, upper, _FURTHER, w)
        evaluations += spent
        found = distance * distance + (target.weight * angle) ** 2
        if found < best:
            best, best_distance, best_angle = found, distance, angle
            q[:] = trial
    return best_distance, best_angle, evaluations


def explain_unreachable(
    arm: Arm, target: Target, q_best: Array, q_start: Array, *, restarts: int = 60
) -> tuple[ClosestApproach, int]:
    """Find out how far off a target stays, and why.

    The orientation is held to first order and the distance made least, so that the figure is the
    one a user can act on: how far to move the work piece.

    Args:
        arm: The arm.
        target: A target without a solution.
        q_best: The best configuration found so far, shape (dof,) [rad or m].
        q_start: Configuration that solutions were wanted near to, shape (dof,) [rad or m].
        restarts: Further seeds to try.

    Returns:
        The verdict and the evaluations spent on it.
    """
    lower, upper = arm.search_bounds(q_start)
    stiff = target._replace(weight=30.0 if target.oriented else 0.0)
    q = np.clip(q_best, lower, upper)
    seeds = np.clip(np.vstack([q_best, q_start]), lower, upper)
    distance, angle, spent = _closest(arm.chain, stiff, seeds, lower, upper, restarts, q)
    held = not target.oriented or angle < 0.02
    limits = [
        k for k in range(arm.dof) if q[k] <= arm.lower[k] + 1e-6 or q[k] >= arm.upper[k] - 1e-6
    ]
    reason = _shell_reason(arm, target)
    if reason is None and not held:
        reason = (
            f"the orientation cannot be reached there: closest is {distance * 1e3:.1f} mm "
            f"and {math.degrees(angle):.1f} deg away"
        )
    if reason is None:
        reason = f"out of reach by {distance * 1e3:.1f} mm over {restarts + 2} branches tried"
    closest = ClosestApproach(
        q, float(distance), float(angle) if target.oriented else None, limits, reason
    )
    return closest, int(spent)


def within(
    arm: Arm,
    target: Target,
    closest: ClosestApproach,
    q_near: Array,
    position: float,
    orientation: float,
    *,
    restarts: int = 150,
) -> tuple[ClosestApproach | None, int]:
    """Find a configuration within the tolerance of a target that cannot be met exactly.

    The closest approach holds the orientation and is off in the position alone; where that is too
    far, the error is made least in units of the tolerance, so that it is shared between the two.

    Args:
        arm: The arm.
        target: A target without a solution.
        closest: The closest that the arm gets to it.
        q_near: Configuration that solutions were wanted near to, shape (dof,) [rad or m].
        position: Distance that is tolerated [m].
        orientation: Angle that is tolerated [rad].
        restarts: Further seeds to try.

    Returns:
        The configuration with its errors, None where none is found, and the evaluations spent.
    """

    def tolerated(distance: float, angle: float) -> bool:
        return distance <= position and angle <= orientation

    distance, angle = closest.position_error, closest.orientation_error or 0.0
    if tolerated(distance, angle):
        return closest, 0
    if not target.oriented or distance > position + _GAIN * orientation:
        return None, 0
    lower, upper = arm.search_bounds(q_near)
    shared = target._replace(weight=min(max(position / orientation, 0.01), 10.0))
    q = closest.q.copy()
    seeds = np.clip(np.vstack([closest.q, q_near]), lower, upper)
    distance, angle, spent = _closest(arm.chain, shared, seeds, lower, upper, restarts, q)
    if not tolerated(distance, angle):
        return None, int(spent)
    found = ClosestApproach(q, float(distance), float(angle), closest.limits, closest.reason)
    return found, int(spent)


def _shell_reason(arm: Arm, target: Target) -> str | None:
    """The verdict of the shoulder-wrist distance, where the arm has one."""
    if arm.wrist is None or arm.shoulder is None or not target.oriented:
        return None
    centre = target.p + target.R @ arm.wrist.tool_to_centre
    distance = float(np.linalg.norm(centre - arm.shoulder.centre))
    near, far = arm.shoulder.nearest, arm.shoulder.farthest
    if near <= distance <= far:
        return None
    beyond = distance - far if distance > far else near - distance
    side = "too far from" if distance > far else "too close to"
    return (
        f"the wrist centre would be {distance:.4f} m from the shoulder, {beyond * 1e3:.1f} mm "
        f"{side} it: the elbow allows {near:.4f} to {far:.4f} m"
    )
