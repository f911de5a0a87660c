"""The home of an arm whose source gives none: a posture far from singular."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from catalogue.facts import Arm, Triple

__all__ = ["pick_home"]

Array = NDArray[Any]
_POSTURES = 64
_MIDDLE = 0.6
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19)
_TURN_STEP = math.radians(5.0)
_SLIDE_STEP = 0.01


def pick_home(arm: Arm) -> list[float]:
    """Pick the home: the best conditioned of 64 fixed postures in the middle 60 % of each range.

    The postures are the first 64 points of the Halton sequence after its origin, rounded to 5 deg
    and 10 mm. A range counts for at most one turn about its middle. The first and the last joint
    of an arm turn the whole arm or its tool, which changes no singular value: they stay at the
    value nearest to zero. Postures with a joint origin or the tip below the base are taken only
    where there are no others. The measure is the smallest singular value of the Jacobian (metres
    and radians), compared to 1e-6 so that no rounding of a machine decides.

    Args:
        arm: The arm.

    Returns:
        The values of the joints that the user has [rad or m].
    """
    middle, half, steps = _ranges(arm)
    frames = [_frame(origin.xyz, origin.rpy) for origin in (*arm.joints, arm.tool)]
    matrix = np.array(arm.counting.matrix) if arm.counting else np.eye(len(arm.joints))
    best: tuple[bool, float] = (False, -1.0)
    home = middle
    for k in range(1, _POSTURES + 1):
        point = np.array([_radical_inverse(k, base) for base in _PRIMES[: len(middle)]])
        q = middle + _MIDDLE * half * (2.0 * point - 1.0)
        for end in (0, -1):
            q[end] = np.clip(0.0, *(middle[end] + _MIDDLE * half[end] * np.array([-1.0, 1.0])))
        q = np.round(q / steps) * steps
        J, lowest = _jacobian(arm, frames, matrix @ q)
        least = np.linalg.svd(J @ matrix, compute_uv=False)[-1]
        rank = (lowest > -1e-9, round(float(least), 6))
        if rank > best:
            best, home = rank, q
    return [float(v) + 0.0 for v in home]


def _ranges(arm: Arm) -> tuple[Array, Array, Array]:
    """Middles, half ranges and steps of the joints that the user has."""
    counted = arm.counting.joints if arm.counting else arm.joints
    rows = []
    for i, serial in enumerate(arm.joints):
        slides = serial.type == "prismatic"
        lower, upper = counted[i].lower, counted[i].upper
        if lower is None or upper is None:
            lower, upper = -math.pi, math.pi
        half = 0.5 * (upper - lower)
        if not slides:
            half = min(half, math.pi)
        rows.append((0.5 * (lower + upper), half, _SLIDE_STEP if slides else _TURN_STEP))
    middle, half_range, steps = np.array(rows).T
    return middle, half_range, steps


def _radical_inverse(k: int, base: int) -> float:
    value, place = 0.0, 1.0 / base
    while k:
        k, digit = divmod(k, base)
        value += digit * place
        place /= base
    return value


def _jacobian(arm: Arm, frames: list[Array], q: Array) -> tuple[Array, float]:
    """Jacobian of the tip in the base, and the least height of a joint origin or the tip.

    ``frames`` are those of the joints and the tip, each in the one before.
    """
    T = np.eye(4)
    axes, origins = [], []
    for joint, frame, value in zip(arm.joints, frames[:-1], q, strict=True):
        T = T @ frame
        axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
        axes.append(T[:3, :3] @ axis)
        origins.append(T[:3, 3].copy())
        T = T @ _moved(axis, float(value), joint.type == "prismatic")
    tip = (T @ frames[-1])[:3, 3]
    J = np.zeros((6, len(q)))
    for i, joint in enumerate(arm.joints):
        if joint.type == "prismatic":
            J[:3, i] = axes[i]
        else:
            J[:3, i] = np.cross(axes[i], tip - origins[i])
            J[3:, i] = axes[i]
    return J, min(float(p[2]) for p in [*origins[1:], tip])


def _frame(xyz: Triple, rpy: Triple) -> Array:
    T = np.eye(4)
    for axis, angle in zip(np.eye(3)[::-1], rpy[::-1], strict=True):
        T = T @ _moved(axis, angle, False)
    T[:3, 3] = xyz
    return T


def _moved(axis: Array, value: float, slides: bool) -> Array:
    T = np.eye(4)
    if slides:
        T[:3, 3] = value * axis
        return T
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    T[:3, :3] += math.sin(value) * K + (1.0 - math.cos(value)) * (K @ K)
    return T
