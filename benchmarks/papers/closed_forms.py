"""Closed-form inverse kinematics: the ground truth of the Dobot and of the EOD arm.

Source: algebra of the models of [S] section 6 and [L] Table 2.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["closed_form", "dobot_solutions", "eod_solutions"]

Array = NDArray[np.float64]


def dobot_solutions(_R: Array, p: Array) -> list[Array]:
    """Return the joint values (theta1..theta4) of a tool position, theta4 = theta1.

    Args:
        _R: Not used: the tool is always vertical.
        p: Position, shape (3,) [m].
    """
    rear, fore, offset, height = 0.135, 0.147, 0.061, 0.058
    theta1 = math.atan2(p[1], p[0])
    r, z = math.hypot(p[0], p[1]) - offset, p[2] - height
    # r = rear sin(theta2) + fore cos(theta3), z = rear cos(theta2) - fore sin(theta3)
    reach = math.hypot(r, z)
    cosine = (reach * reach + rear * rear - fore * fore) / (2.0 * rear * reach)
    if abs(cosine) > 1.0:
        return []
    towards = math.atan2(r, z)  # from the vertical
    solutions = []
    for sign in (1.0, -1.0):
        theta2 = towards - sign * math.acos(cosine)
        theta3 = math.atan2(rear * math.cos(theta2) - z, r - rear * math.sin(theta2))
        solutions.append(np.array([theta1, theta2, theta3, theta1]))
    return solutions


_D1, _D4, _D5, _D6 = 0.1135, 0.0928, 0.1103, 0.0568
_A2, _A3 = -0.425, -0.3749


def _dh(theta: float, d: float, a: float, alpha: float) -> Array:
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array(
        [
            [c, -s * ca, s * sa, a * c],
            [s, c * ca, -c * sa, a * s],
            [0.0, sa, ca, d],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def eod_solutions(R: Array, p: Array) -> list[Array]:
    """Return up to eight joint solutions of a tool pose of the EOD arm, limits not looked at.

    Args:
        R: Rotation, shape (3, 3).
        p: Position, shape (3,) [m].
    """
    half = 0.5 * math.pi
    p5 = p - _D6 * R[:, 2]
    radius = math.hypot(p5[0], p5[1])
    if radius < _D4:
        return []
    solutions = []
    for branch in (0, 1):
        # p5x sin q1 - p5y cos q1 = d4
        angle = math.asin(_D4 / radius)
        q1 = math.atan2(p5[1], p5[0]) + (angle if branch == 0 else math.pi - angle)
        z1 = np.array([math.sin(q1), -math.cos(q1), 0.0])
        cosine = float(R[:, 2] @ z1)
        if abs(cosine) > 1.0:
            continue
        for sign in (1.0, -1.0):
            q5 = sign * math.acos(cosine)
            s5 = math.sin(q5)
            if abs(s5) < 1e-12:
                continue
            q6 = math.atan2(float(R[:, 1] @ z1) / s5, -float(R[:, 0] @ z1) / s5)
            T = np.eye(4)
            T[:3, :3], T[:3, 3] = R, p
            T14 = (
                np.linalg.inv(_dh(q1, _D1, 0.0, half))
                @ T
                @ np.linalg.inv(_dh(q5, _D5, 0.0, half) @ _dh(q6, _D6, 0.0, 0.0))
            )
            q234 = math.atan2(T14[1, 0], T14[0, 0])
            x, y = T14[0, 3], T14[1, 3]
            cosine3 = (x * x + y * y - _A2 * _A2 - _A3 * _A3) / (2.0 * _A2 * _A3)
            if abs(cosine3) > 1.0:
                continue
            for elbow in (1.0, -1.0):
                q3 = elbow * math.acos(cosine3)
                k1, k2 = _A2 + _A3 * math.cos(q3), _A3 * math.sin(q3)
                q2 = math.atan2(y, x) - math.atan2(k2, k1)
                q = np.array([q1, q2, q3, q234 - q2 - q3, q5, q6])
                solutions.append(q - 2.0 * math.pi * np.ceil((q - math.pi) / (2.0 * math.pi)))
    return solutions


def closed_form(robot: str) -> Callable[[Array, Array], list[Array]] | None:
    """Return the closed form of a robot, None where there is none here."""
    return {"dobot_magician": dobot_solutions, "eod_arm": eod_solutions}.get(robot)
