"""The cases of E9: four trajectories of the EOD arm."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from benchmarks.papers.closed_forms import eod_solutions
from benchmarks.papers.li_poses import MILLIMETRES, OMEGA_R
from ikplan.ik.objective import WEIGHTED
from ikplan.kinematics.arm import arm_of
from ikplan.robots import load_robot

__all__ = ["EQ_47", "PRINTED", "path_case", "path_points"]

Array = NDArray[np.float64]

PRINTED = np.array(
    [[0.2838, -0.8639, -0.4161], [0.6716, -0.1307, -0.7293], [0.6844, -0.4865, -0.5431]]
)
"""[L] Eq. 47: not a rotation, its determinant is 0.134."""


def _repaired() -> Array:
    """The printed entries with the signs of pattern A, made orthonormal."""
    signs = np.array([[1, -1, 1], [1, -1, -1], [1, 1, 1]])
    U, _, Vt = np.linalg.svd(np.abs(PRINTED) * signs)
    R: Array = U @ Vt
    return R


EQ_47 = _repaired()


def path_points(name: str) -> Array:
    """Return the 200 points of a trajectory, shape (200, 3) [m]; "3+": x = +500 as printed."""
    u = np.linspace(0.0, 1.0, 200)
    x = np.full(200, 500.0 if name == "3+" else -500.0)
    if name == "1":
        s = -520.0 + 300.0 * math.pi * u
        y, z = s, -100.0 + 400.0 * np.sin(math.pi * s / 150.0)
    elif name == "2":
        t = 2.0 * math.pi * u
        y, z = -200.0 + 300.0 * np.sin(t), -100.0 + 300.0 * np.cos(t)
    elif name == "4":
        b = math.pi * u
        r = 300.0 * np.cos(3.0 * b)
        y, z = -520.0 + r * np.cos(b), r * np.sin(b)
    else:
        s = -520.0 + 420.0 * u
        y, z = s, np.clip(-200.0 + 400.0 * np.sin(math.pi * s / 60.0), -400.0, 0.0)
    return 1e-3 * np.column_stack([x, y, z])


def path_case(name: str, *, printed: bool = False) -> Case:
    """Return E9 of a trajectory: 200 points, cold, omega_R of the EOD arm.

    Args:
        name: "1" to "4", or "3+".
        printed: The orientation as printed, which is no rotation.
    """
    robot = load_robot("eod_arm")
    arm = arm_of(robot)
    p = path_points(name)
    R = np.tile(PRINTED if printed else EQ_47, (len(p), 1, 1))

    def reachable(position: Array) -> bool:
        solutions = eod_solutions(EQ_47, position)
        return any(bool((np.abs(q) <= 0.5 * math.pi + 1e-9).all()) for q in solutions)

    flags = [not printed and reachable(position) for position in p]
    suffix = "-printed" if printed else ""
    return Case(
        f"E9-{name}{suffix}",
        f"trajectory {name}" + (", Eq. 47 as printed" if printed else ""),
        robot,
        arm,
        R,
        p,
        True,
        np.zeros(6),
        kind=WEIGHTED,
        weight_position=MILLIMETRES,
        weight_orientation=OMEGA_R,
        tracks=False,
        stop_value=1e-6,
        reachable=np.array(flags),
    )
