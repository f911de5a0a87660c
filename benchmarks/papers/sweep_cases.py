"""The cases of the sweeps: starts at a distance, and arms of more and more joints."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from benchmarks.papers.helix import iiwa
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.robots import Robot
from ikplan.robots.load import robot_from_urdf

__all__ = ["COUNT", "DIMENSIONS", "DISTANCES", "dimension_case", "distance_case", "trunk"]

Array = NDArray[np.float64]

DISTANCES = (5, 15, 30, 45, 60, 90)
"""Largest distance of the start from a solution, a joint [deg]."""
DIMENSIONS = (6, 7, 10, 15, 20, 30)
COUNT = 20
START = 30.0
"""Distance of the start in the sweep over the joints [deg]."""
LIMIT = 2.0
"""Limits of a trunk's joints [rad]."""


def _near(robot: Robot, count: int, degrees: float, seed: int) -> tuple[Array, Array]:
    """Positions of random configurations, and starts up to some degrees a joint from those."""
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed])))
    p, starts = [], []
    for _ in range(count):
        q = robot.random_configuration(rng)
        shift = np.radians(degrees) * (2.0 * rng.random(robot.dof) - 1.0)
        p.append(robot.fk(q).translation)
        starts.append(np.clip(q + shift, robot.lower, robot.upper))
    return np.array(p), np.array(starts)


def _case(name: str, title: str, robot: Robot, arm: Arm, p: Array, starts: Array) -> Case:
    return Case(
        name,
        title,
        robot,
        arm,
        np.tile(np.eye(3), (len(p), 1, 1)),
        p,
        False,
        starts[0],
        starts=starts,
        tracks=False,
        reachable=np.ones(len(p), dtype=np.bool_),
    )


def distance_case(degrees: int) -> Case:
    """Return positions of the iiwa with starts up to ``degrees`` a joint from a solution.

    The positions are the same for every distance, and so are the directions of the starts.
    """
    robot, arm = iiwa()
    p, starts = _near(robot, COUNT, degrees, 31)
    return _case(f"S1-{degrees}", f"start within {degrees} deg a joint", robot, arm, p, starts)


@functools.cache
def trunk(dof: int) -> Robot:
    """Return an arm of 1 m: joints by turns about z and y, all links equally long."""
    length = 1.0 / dof
    parts = ['<robot name="trunk"><link name="l0"/>']
    for k in range(dof):
        axis = "0 0 1" if k % 2 == 0 else "0 1 0"
        z = 0.0 if k == 0 else length
        parts.append(
            f'<link name="l{k + 1}"/><joint name="j{k + 1}" type="revolute"><parent link="l{k}"/>'
            f'<child link="l{k + 1}"/><origin xyz="0 0 {z!r}"/><axis xyz="{axis}"/>'
            f'<limit lower="{-LIMIT}" upper="{LIMIT}" velocity="2" effort="0"/></joint>'
        )
    parts.append(
        f'<link name="tool"/><joint name="end" type="fixed"><parent link="l{dof}"/>'
        f'<child link="tool"/><origin xyz="0 0 {length!r}"/></joint></robot>'
    )
    return robot_from_urdf("".join(parts), tip="tool", name=f"trunk{dof}")


def dimension_case(dof: int) -> Case:
    """Return positions of a trunk of ``dof`` joints, with starts up to 30 deg a joint away."""
    robot = trunk(dof)
    p, starts = _near(robot, COUNT, START, 32)
    case = _case(f"S2-{dof}", f"{dof} joints", robot, arm_of(robot), p, starts)
    return replace(case, name=f"S2-{dof}")
