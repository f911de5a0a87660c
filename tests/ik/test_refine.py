"""The Levenberg-Marquardt refinement and the restarts."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.stats import qmc

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.ik.levenberg_marquardt import Effort, differentiate, new_workspace, refine, residual
from ikplan.ik.restarts import restart_into
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom, pose_target
from ikplan.robots import load_robot


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_a_seed_nearby_converges_to_machine_precision(name: str) -> None:
    robot = load_robot(name)
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    rng = np.random.default_rng(51)
    good = 0
    for _ in range(40):
        goal = robot.random_configuration(rng)
        q = robot.clip(goal + 0.05 * rng.normal(size=robot.dof))
        pose = robot.fk(goal)
        target = pose_target(pose.translation, pose.rotation)
        lower, upper = arm.search_bounds(q)
        distance, angle, _ = refine(arm.chain, target, q, lower, upper, Effort(40, 6), w)
        have = robot.fk(q)
        assert distance == pytest.approx(
            np.linalg.norm(have.translation - pose.translation), abs=1e-14
        )
        turn = np.linalg.norm(pin.log3(have.rotation.T @ pose.rotation))
        assert angle == pytest.approx(turn, abs=1e-13)
        assert (q >= robot.lower).all()
        assert (q <= robot.upper).all()
        good += distance < 1e-11 and angle < 1e-11
    assert good >= 36


@pytest.mark.parametrize("name", ["ur5", "iiwa14", "panda", "dobot_magician"])
def test_a_seed_nearby_comes_to_where_edges_of_a_box_meet(name: str) -> None:
    robot = load_robot(name)
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    rng = np.random.default_rng(54)
    missed, draws = 0, 500
    for _ in range(draws):
        goal = robot.random_configuration(rng)
        pose = robot.fk(goal)
        box = rng.choice([0.0, 1e-3, 1e-2], 6)
        if robot.dof < 6:
            box[3:] = 4.0  # any orientation
        freedom = no_freedom()._replace(boxed=True, box=box, in_tool=bool(rng.integers(2)))
        target = pose_target(pose.translation, pose.rotation, freedom=freedom)
        q = robot.clip(goal + rng.choice([1e-4, 1e-2, 0.1]) * rng.normal(size=robot.dof))
        distance, angle, _ = refine(arm.chain, target, q, arm.lower, arm.upper, Effort(15, 8), w)
        axes = pose.rotation if freedom.in_tool else np.eye(3)
        have = robot.fk(q)
        along = axes.T @ (have.translation - pose.translation)
        outside = np.maximum(np.abs(along) - box[:3], 0.0)
        assert distance == pytest.approx(np.linalg.norm(outside), abs=1e-13)
        missed += max(distance, angle) > 1e-9
    assert missed <= 0.01 * draws


def test_convergence_is_quadratic() -> None:
    """From a millirad away, three steps are enough for every digit."""
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    w = new_workspace(arm.chain)
    rng = np.random.default_rng(52)
    for _ in range(20):
        goal = 0.5 * robot.random_configuration(rng)
        pose = robot.fk(goal)
        target = pose_target(pose.translation, pose.rotation)
        q = goal + 1e-3 * rng.uniform(-1, 1, robot.dof)
        distance, angle, evaluations = refine(
            arm.chain, target, q, arm.lower, arm.upper, Effort(3, 6), w
        )
        assert evaluations <= 4
        assert max(distance, angle) < 1e-11


def test_the_error_never_rises_and_the_limits_are_kept() -> None:
    rng = np.random.default_rng(53)
    for name in ("panda", "mh5", "so101", "tiago", "dobot_magician"):
        robot = load_robot(name)
        arm = arm_of(robot)
        w = new_workspace(arm.chain)
        for oriented in (True, False):
            for _ in range(30):
                pose = robot.fk(robot.random_configuration(rng))
                target = pose_target(pose.translation, pose.rotation if oriented else None)
                q = robot.random_configuration(rng)
                lower, upper = arm.search_bounds(q)
                *_, error = residual(arm.chain, target, q, np.empty(6), w)
                for _ in range(10):
                    refine(arm.chain, target, q, lower, upper, Effort(1, 6), w)
                    *_, after = residual(arm.chain, target, q, np.empty(6), w)
                    assert after <= error
                    assert (lower <= q).all()
                    assert (q <= upper).all()
                    error = after


@pytest.mark.parametrize("oriented", [True, False])
def test_the_gradient_of_the_residual_is_the_jacobian_times_the_error(oriented: bool) -> None:
    robot = load_robot("ur5")
    chain = arm_of(robot).chain
    w = new_workspace(chain)
    rng = np.random.default_rng(54)
    for _ in range(20):
        goal = robot.random_configuration(rng)
        pose = robot.fk(goal)
        target = pose_target(pose.translation, pose.rotation if oriented else None)
        q = goal + 0.05 * rng.normal(size=robot.dof)
        e = np.empty(6)
        residual(chain, target, q, e, w)
        differentiate(chain, target, w)
        gradient = -w.Jt @ e
        h = 1e-6
        numeric = [
            (
                residual(chain, target, q + h * axis, np.empty(6), w)[2]
                - residual(chain, target, q - h * axis, np.empty(6), w)[2]
            )
            / (2 * h)
            for axis in np.eye(robot.dof)
        ]
        # The right Jacobian of the rotation logarithm is left out: first order in the angle, and
        # orthogonal to the error itself.
        np.testing.assert_allclose(gradient, numeric, atol=2e-9, rtol=1e-6)


def test_restarts_cover_the_limits_evenly_and_depend_on_the_shift_alone() -> None:
    lower, upper = np.array([-1.0, 0.0, 2.0]), np.array([1.0, 5.0, 2.5])
    points = np.empty((512, 3))
    for i, q in enumerate(points):
        restart_into(i, 0.5, lower, upper, q)
    assert (points >= lower).all()
    assert (points <= upper).all()
    # The discrepancy of the sequence is far below that of as many random points.
    rng = np.random.default_rng(55)
    random = [qmc.discrepancy(rng.random((512, 3))) for _ in range(9)]
    assert qmc.discrepancy((points - lower) / (upper - lower)) < 0.2 * min(random)
    again, other = np.empty(3), np.empty(3)
    restart_into(17, 0.5, lower, upper, again)
    restart_into(17, 0.6, lower, upper, other)
    np.testing.assert_array_equal(again, points[17])
    assert not np.array_equal(other, again)
