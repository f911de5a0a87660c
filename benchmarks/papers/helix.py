"""The cases of E1 and E2: the KUKA iiwa 14."""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.robots import Robot, load_robot

__all__ = ["helix_cases", "helix_points", "iiwa", "random_targets"]

Array = NDArray[np.float64]

EQ_27 = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
"""[S] Eq. 27; its z axis is +y of the base, although the text says normal to the floor."""
TOOL_DOWN = np.diag([1.0, -1.0, -1.0])
UNREACHABLE_E1D = (0, 18, 19)
"""Of the literal reading, from 0: 0.826 to 0.851 m from the shoulder, beyond 0.82 m."""
BENT = np.radians([0.0, 45.0, 0.0, -90.0, 0.0, 45.0, 0.0])


@functools.cache
def iiwa() -> tuple[Robot, Arm]:
    """Return the robot and its kinematics."""
    robot = load_robot("iiwa14")
    return robot, arm_of(robot)


def helix_points(phase_deg: float) -> Array:
    """Return the 20 points, shape (20, 3) [m]: radius 0.2, length 0.5, two turns upwards."""
    s = np.arange(20) / 19.0
    a = 4.0 * math.pi * s + math.radians(phase_deg)
    return np.column_stack([0.6 + 0.2 * np.cos(a), 0.2 * np.sin(a), 0.1 + 0.5 * s])


def _case(name: str, title: str, phase: float, R: Array | None, q_start: Array) -> Case:
    robot, arm = iiwa()
    p = helix_points(phase)
    reachable = np.ones(20, dtype=np.bool_)
    if name == "E1d":
        reachable[list(UNREACHABLE_E1D)] = False
    return Case(
        name,
        title,
        robot,
        arm,
        np.tile(np.eye(3) if R is None else R, (20, 1, 1)),
        p,
        R is not None,
        q_start,
        decouple=R is not None,
        reachable=reachable,
    )


def helix_cases() -> dict[str, Case]:
    """Return the readings of E1, by name."""
    home = np.zeros(7)
    cases = (
        _case("E1a", "position only, 7 joints, phase 0", 0.0, None, home),
        _case("E1b", "Eq. 27, decoupled, phase 124 deg", 124.0, EQ_27, home),
        _case("E1c", "tool down, decoupled, phase 293 deg", 293.0, TOOL_DOWN, home),
        _case("E1d", "Eq. 27, decoupled, phase 0 (literal)", 0.0, EQ_27, home),
        _case("E1b-bent", "E1b from a bent home", 124.0, EQ_27, BENT),
    )
    return {case.name: case for case in cases}


def random_targets(count: int) -> Case:
    """Return E2: positions of uniformly random configurations."""
    robot, arm = iiwa()
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence([2])))
    poses = [robot.fk(robot.random_configuration(rng)) for _ in range(count)]
    return Case(
        "E2",
        "random reachable positions",
        robot,
        arm,
        np.tile(np.eye(3), (count, 1, 1)),
        np.array([pose.translation for pose in poses]),
        False,
        np.zeros(7),
        tracks=False,
        stop_value=1e-3,
        reachable=np.ones(count, dtype=np.bool_),
    )
