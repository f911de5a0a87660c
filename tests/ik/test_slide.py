"""The slide along the self-motion ends at a constrained minimum."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.ik.levenberg_marquardt import new_workspace
from ikplan.ik.self_motion import nearest_on_manifold
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.robots import Robot, load_robot

REDUNDANT = [
    *[(name, True) for name in ("iiwa14", "panda", "xarm7", "baxter_left", "tiago")],
    *[(name, False) for name in ("iiwa14", "ur5", "mh5", "kinova_j2s6s200", "dobot_magician")],
]


def slope(
    robot: Robot, q: np.ndarray, start: np.ndarray, rows: int, low: np.ndarray, high: np.ndarray
) -> float:
    """Largest joint motion that would still lead nearer: zero where the KKT conditions hold.

    The gradient start - q, less what of it the constraints hold: the rows of Pinocchio's Jacobian,
    and the limits that it pushes against.
    """
    J, d = robot.jacobian(q)[:rows], start - q
    free = np.ones(robot.dof, dtype=bool)
    while True:
        g = np.zeros(robot.dof)
        g[free] = d[free] - J[:, free].T @ np.linalg.lstsq(J[:, free].T, d[free], rcond=None)[0]
        held = free & (((q < low + 2e-6) & (g < 0.0)) | ((q > high - 2e-6) & (g > 0.0)))
        if not held.any():
            return float(np.abs(g).max())
        free &= ~held


@pytest.mark.parametrize(("name", "oriented"), REDUNDANT)
@pytest.mark.parametrize("near", [True, False], ids=["near", "far"])
def test_it_ends_where_nothing_small_leads_nearer(name: str, oriented: bool, near: bool) -> None:
    robot = load_robot(name)
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    rng = np.random.default_rng(61)
    slopes = []
    for _ in range(50):
        q = robot.random_configuration(rng)
        start = robot.random_configuration(rng)
        if near:
            start = robot.clip(q + 0.3 * rng.normal(size=robot.dof))
        low, high = arm.search_bounds(start)
        q = np.clip(q, low, high)
        pose, before = robot.fk(q), np.linalg.norm(q - start)
        target = pose_target(pose.translation, pose.rotation if oriented else None)
        nearest_on_manifold(arm.chain, target, q, start, low, high, 100, w)
        after = robot.fk(q)
        assert np.abs(after.translation - pose.translation).max() < 2e-11
        if oriented:
            assert np.abs(after.rotation - pose.rotation).max() < 2e-11
        assert np.linalg.norm(q - start) <= before + 1e-12
        assert (low <= q).all()
        assert (q <= high).all()
        slopes.append(slope(robot, q, start, 6 if oriented else 3, low, high))
    # One in a thousand runs out of steps where many limits meet.
    assert np.quantile(slopes, 0.97) < 1e-4


def test_it_ends_at_a_minimum_by_finite_differences() -> None:
    """No point of the self-motion near the end is nearer to the start, seen by Pinocchio alone."""
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    rng = np.random.default_rng(62)
    for _ in range(20):
        q = 0.8 * robot.random_configuration(rng)
        start = robot.clip(q + 0.2 * rng.normal(size=robot.dof))
        pose = robot.fk(q)
        target = pose_target(pose.translation, pose.rotation)
        nearest_on_manifold(arm.chain, target, q, start, arm.lower, arm.upper, 100, w)
        inside = (q > robot.lower + 1e-3).all() and (q < robot.upper - 1e-3).all()
        if not inside:
            continue
        here = np.linalg.norm(q - start)
        for direction in (1.0, -1.0):
            other = q.copy()
            for _ in range(100):  # follow the null space for 0.1 rad
                null = np.linalg.svd(robot.jacobian(other))[2][-1]
                sign = direction * np.sign(null @ np.linalg.svd(robot.jacobian(q))[2][-1])
                other += 1e-3 * sign * null
            assert np.linalg.norm(other - start) > here - 1e-6


def test_an_arm_without_self_motion_stays() -> None:
    robot = load_robot("ur5")
    arm = arm_of(robot)
    q = robot.random_configuration(np.random.default_rng(63))
    pose, before = robot.fk(q), q.copy()
    target = pose_target(pose.translation, pose.rotation)
    w = new_workspace(arm.chain)
    assert nearest_on_manifold(arm.chain, target, q, robot.home, arm.lower, arm.upper, 50, w) == 0
    np.testing.assert_array_equal(q, before)


def test_the_start_itself_is_found_when_it_solves_the_target() -> None:
    robot = load_robot("panda")
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    start = np.array(robot.home)
    pose = robot.fk(start)
    target = pose_target(pose.translation, pose.rotation)
    q = start.copy()
    for _ in range(300):  # away from it, along the self-motion
        q += (
            1e-3
            * np.linalg.svd(robot.jacobian(q))[2][-1]
            * np.sign(np.linalg.svd(robot.jacobian(q))[2][-1][0])
        )
    nearest_on_manifold(arm.chain, target, q, start, arm.lower, arm.upper, 100, w)
    np.testing.assert_allclose(q, start, atol=1e-3)
