"""One full pose of the UR5: every library by its own model, for the same joint values."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.peers.measure import Contestant, Row, compare, module
from ikplan import load_robot, solve_ik
from ikplan.arrays import Array
from ikplan.kinematics.arm import arm_of
from ikplan.robots import Robot

__all__ = ["run"]


def run(effort: float) -> list[Row]:
    """Solve random reachable poses.

    Args:
        effort: Share of the full number of poses, in (0, 1].
    """
    robot, rng = load_robot("ur5"), np.random.default_rng(2026)
    q = np.array([robot.random_configuration(rng) for _ in range(max(20, int(300 * effort)))])
    poses = [robot.fk(row) for row in q]
    contestants = [
        Contestant(
            f"ikplan {method}",
            [functools.partial(solve_ik, robot, pose, method=method) for pose in poses],
            note,
        )
        for method, note in (
            ("closed-form", "nearest of all branches, limits, checked by FK"),
            ("lm", "one solution, limits, restarts"),
        )
    ]
    for find in (_eaik, _ur_analytic, _toolbox):
        contestants += find(robot, q)
    return compare("UR5, one full pose", contestants, 5)


def _eaik(robot: Robot, q: Array) -> list[Contestant]:
    if module("eaik") is None:
        return []
    peer: Any = module("eaik.IK_HP")
    form = arm_of(robot).closed_form
    # Its last offset leads to the tool; axes 5 and 6 meet in the point that the form has.
    offsets = np.vstack([form.v[:5], np.zeros(3), -form.R @ form.centre])
    arm = peer.HPRobot(form.h, offsets)
    poses = [arm.fwdKin(row) for row in q]
    exact = [arm.IK(pose) for pose in poses[:5]]
    rows = [each.Q[int(np.argmin(each.is_LS))] for each in exact]
    _must_reach([arm.fwdKin(row) for row in rows], poses)
    calls = [functools.partial(arm.IK, pose) for pose in poses]
    return [Contestant("EAIK", calls, "all branches, least-squares ones among them; no limits")]


def _ur_analytic(robot: Robot, q: Array) -> list[Contestant]:
    peer: Any = module("ur_analytic_ik")
    if peer is None:
        return []
    arm = peer.ur5
    poses = [arm.forward_kinematics(*row) for row in q]
    home = [float(value) for value in robot.home]
    _must_reach(
        [arm.forward_kinematics(*arm.inverse_kinematics(pose)[0]) for pose in poses[:5]], poses
    )
    every: list[Callable[[], object]] = [
        functools.partial(arm.inverse_kinematics, p) for p in poses
    ]
    nearest = [functools.partial(arm.inverse_kinematics_closest, pose, *home) for pose in poses]
    return [
        Contestant("ur-analytic-ik, all", every, "all branches; UR arms only; no limits"),
        Contestant("ur-analytic-ik, closest", nearest, "UR arms only; no limits"),
    ]


def _toolbox(robot: Robot, q: Array) -> list[Contestant]:
    peer: Any = module("roboticstoolbox")
    if peer is None:
        return []
    arm = peer.models.DH.UR5().ets()
    poses = [np.asarray(arm.fkine(row)) for row in q]
    calls = [
        functools.partial(arm.ik_LM, pose, q0=np.array(robot.home), tol=1e-12) for pose in poses
    ]
    note = "one solution by Levenberg-Marquardt, to 1e-12"
    return [Contestant("roboticstoolbox ik_LM", calls, note)]


def _must_reach(found: list[Array], poses: list[Array]) -> None:
    """Refuse to time what does not solve the same poses."""
    for have, want in zip(found, poses, strict=False):
        np.testing.assert_allclose(have, want, rtol=0, atol=1e-6)
