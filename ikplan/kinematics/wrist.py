"""The spherical-wrist decoupling of the last three joints.

Source: Slim et al., Robotics 2023, 12, 38, section 4.3, Eqs. 15-17, generalised from the iiwa to
any arm whose last three axes meet in one point, each perpendicular to the next.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.copying import copy_into
from ikplan.kinematics.chain import Chain, placement_of

__all__ = ["SphericalWrist", "find_wrist", "nearest_wrist", "wrist_angles"]


class SphericalWrist(NamedTuple):
    """An arm cut at its wrist.

    Attributes:
        arm: The chain of the first n - 3 joints; its end is the wrist centre W, in the frame of
            the first wrist joint at zero.
        tool_to_centre: W in the tool frame, shape (3,) [m].
        A: Rotation of the second wrist joint in the first, shape (3, 3).
        B: Rotation of the third wrist joint in the second, shape (3, 3).
        R_tool: Rotation of the tool in the third wrist joint, shape (3, 3).
        lower: Lower limits of the wrist joints, shape (3,) [rad].
        upper: Upper limits of the wrist joints, shape (3,) [rad].
    """

    arm: Chain
    tool_to_centre: Array
    A: Array
    B: Array
    R_tool: Array
    lower: Array
    upper: Array


def find_wrist(chain: Chain, lower: Array, upper: Array) -> SphericalWrist | None:
    """Cut a chain at its spherical wrist.

    Args:
        chain: The chain.
        lower: Lower position limits, shape (dof,) [rad or m].
        upper: Upper position limits, shape (dof,) [rad or m].

    Returns:
        The wrist, or None for an arm whose last three axes do not meet in one point, each
        perpendicular to the next, or whose joints are coupled.
    """
    n = chain.prismatic.shape[0]
    if n < 4 or chain.coupled or chain.prismatic[-3:].any():
        return None
    (A, p_second), (B, p_third) = placement_of(chain, n - 2), placement_of(chain, n - 1)
    R_tool, p_tool = placement_of(chain, n)
    if abs(A[2, 2]) > 1e-9 or abs(B[2, 2]) > 1e-9:
        return None
    # In the first wrist joint's frame W = (0, 0, h); in the second it lies on its z axis too.
    # With second's axis a = A e_z perpendicular to e_z through p: the lines meet if p - h e_z || a.
    a = A[:, 2]
    h = float(p_second[2] - a[2] * (p_second @ a))
    off = p_second - np.array([0.0, 0.0, h])
    along_second = -float(off @ a)
    # W in the second frame is (0, 0, along_second); the third axis must pass through it.
    to_third = np.array([0.0, 0.0, along_second]) - p_third
    along_third = float(to_third @ B[:, 2])
    misses = (
        np.linalg.norm(off + along_second * a),
        np.linalg.norm(to_third - along_third * B[:, 2]),
    )
    if max(misses) > 1e-9:
        return None
    centre_in_third = np.array([0.0, 0.0, along_third])
    centre_in_tool = R_tool.T @ (centre_in_third - p_tool)
    placements = chain.placements[: n - 2].copy()
    # The end of the arm: the first wrist joint's frame, moved along its axis to W.
    placements[-1, 9:] += h * placements[-1, [2, 5, 8]]
    arm = Chain(
        placements,
        chain.prismatic[: n - 3].copy(),
        False,
        np.eye(n - 3),
        np.zeros(n - 3),
    )
    return SphericalWrist(
        arm,
        centre_in_tool,
        A.copy(),
        B.copy(),
        R_tool.copy(),
        np.array(lower[-3:], dtype=np.float64),
        np.array(upper[-3:], dtype=np.float64),
    )


@kernel
def _wrapped(angle: float, lower: float, upper: float, near: float) -> float:
    """Of the 2 pi copies of an angle inside the limits, the one nearest to ``near``.

    Without a copy inside, the copy in (-pi, pi].
    """
    turn = 2.0 * math.pi
    copy = angle + turn * math.floor((near - angle) / turn + 0.5)
    if copy < lower:
        copy += turn * math.ceil((lower - copy) / turn)
    elif copy > upper:
        copy -= turn * math.ceil((copy - upper) / turn)
    if lower <= copy <= upper:
        return copy
    return angle - turn * math.ceil((angle - math.pi) / turn)


@kernel
def _entry(left: Array, right: Array, i: int, j: int) -> float:
    """Entry (i, j) of the product of two matrices of shape (3, 3)."""
    return float(left[i, 0] * right[0, j] + left[i, 1] * right[1, j] + left[i, 2] * right[2, j])


@kernel
def _times_z_times(A: Array, angle: float, B: Array, C: Array) -> None:
    """Write C = A Rz(angle) B, each of shape (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    for i in range(3):
        x, y = c * A[i, 0] + s * A[i, 1], c * A[i, 1] - s * A[i, 0]
        for j in range(3):
            C[i, j] = x * B[0, j] + y * B[1, j] + A[i, 2] * B[2, j]


@kernel
def wrist_angles(
    wrist: SphericalWrist, R_arm: Array, R_target: Array, near: Array, out: Array
) -> None:
    """Write the two wrist solutions of a tool orientation, Eqs. 16-17.

    Args:
        wrist: The wrist.
        R_arm: Rotation of the first wrist joint's frame at zero in the base, shape (3, 3).
        R_target: Rotation of the tool in the base, shape (3, 3).
        near: Wrist joint values to stay close to, shape (3,) [rad].
        out: Out: wrist joint values of both solutions, shape (2, 3) [rad].
    """
    # M = R_arm^T R_target R_tool^T = Rz(q5) A Rz(q6) B Rz(q7)
    A, B, R_tool = wrist.A, wrist.B, wrist.R_tool
    half, M, C = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            half[i, j] = (
                R_target[i, 0] * R_tool[j, 0]
                + R_target[i, 1] * R_tool[j, 1]
                + R_target[i, 2] * R_tool[j, 2]
            )
    for i in range(3):
        for j in range(3):
            M[i, j] = _entry(R_arm.T, half, i, j)
    # A and B turn z to a perpendicular axis, so M[2, 2] = cos(q6 - phi).
    phi = math.atan2(A[2, 1] * B[0, 2] - A[2, 0] * B[1, 2], A[2, 0] * B[0, 2] + A[2, 1] * B[1, 2])
    sine = math.hypot(M[0, 2], M[1, 2])
    opening = math.atan2(sine, M[2, 2])
    for branch in range(2):
        q6 = phi + opening if branch == 0 else phi - opening
        _times_z_times(A, q6, B, C)
        # Where axes 5 and 7 are parallel only their sum counts: keep q5.
        q5 = near[0]
        if sine >= 1e-9:
            q5 = math.atan2(M[1, 2], M[0, 2]) - math.atan2(C[1, 2], C[0, 2])
        # q7 makes up what is left, and so takes back what rounding did to q5 near that place.
        c, s = math.cos(q5), math.sin(q5)
        m0, m1, m2 = c * M[0, 0] + s * M[1, 0], c * M[1, 0] - s * M[0, 0], M[2, 0]
        q7 = math.atan2(
            C[0, 1] * m0 + C[1, 1] * m1 + C[2, 1] * m2, C[0, 0] * m0 + C[1, 0] * m1 + C[2, 0] * m2
        )
        out[branch, 0] = _wrapped(q5, wrist.lower[0], wrist.upper[0], near[0])
        out[branch, 1] = _wrapped(q6, wrist.lower[1], wrist.upper[1], near[1])
        out[branch, 2] = _wrapped(q7, wrist.lower[2], wrist.upper[2], near[2])


@kernel
def nearest_wrist(
    wrist: SphericalWrist, R_arm: Array, R_target: Array, near: Array, out: Array
) -> bool:
    """Write the wrist solution to take.

    Inside the limits if one is; of two inside, or two outside, the one closer to ``near``.

    Args:
        wrist: The wrist.
        R_arm: Rotation of the first wrist joint's frame at zero in the base, shape (3, 3).
        R_target: Rotation of the tool in the base, shape (3, 3).
        near: Wrist joint values to stay close to, shape (3,) [rad].
        out: Out: wrist joint values, shape (3,) [rad].

    Returns:
        Whether the solution is inside the limits.
    """
    both = np.empty((2, 3))
    wrist_angles(wrist, R_arm, R_target, near, both)
    best_inside, best_distance = False, math.inf
    for branch in range(2):
        inside, distance = True, 0.0
        for k in range(3):
            value = both[branch, k]
            inside = inside and wrist.lower[k] <= value <= wrist.upper[k]
            distance += (value - near[k]) ** 2
        if (inside and not best_inside) or (inside == best_inside and distance < best_distance):
            best_inside, best_distance = inside, distance
            copy_into(out, both[branch])
    return best_inside
