"""The compiled kinematics equal Pinocchio's."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.kinematics import chain_of, forward, forward_batch, jacobian, pose_error
from ikplan.kinematics.chain import aligning_rotation
from ikplan.kinematics.forward import rotation_log
from ikplan.robots import Robot, load_robot

from .synthetic import Joint, chains, pinocchio_pose, robot_of, urdf_of


def random_tool(robot: Robot, rng: np.random.Generator) -> Robot:
    quaternion = rng.normal(size=4)
    return robot.with_tool(0.3 * rng.normal(size=3), quaternion / np.linalg.norm(quaternion))


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_poses_and_jacobians_of_the_catalogue_equal_pinocchios(name: str) -> None:
    rng = np.random.default_rng(11)
    plain = load_robot(name)
    for robot in (plain, random_tool(plain, rng), random_tool(plain, rng)):
        chain = chain_of(robot)
        for _ in range(100):
            q = robot.random_configuration(rng)
            R, p = forward(chain, q)
            want = robot.fk(q)
            np.testing.assert_allclose(R, want.rotation, rtol=0, atol=1e-12)
            np.testing.assert_allclose(p, want.translation, rtol=0, atol=1e-12)
            np.testing.assert_allclose(jacobian(chain, q), robot.jacobian(q), rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["iiwa14", "kinova_j2s6s200", "tiago", "dobot_magician"])
def test_a_batch_is_its_poses_one_by_one(name: str) -> None:
    robot = load_robot(name)
    chain = chain_of(robot)
    rng = np.random.default_rng(12)
    q = np.array([robot.random_configuration(rng) for _ in range(300)])
    R, p = forward_batch(chain, q)
    one_by_one = [forward(chain, row) for row in q]
    np.testing.assert_array_equal(R, [pose[0] for pose in one_by_one])
    np.testing.assert_array_equal(p, [pose[1] for pose in one_by_one])


def test_a_batch_may_be_empty() -> None:
    R, p = forward_batch(chain_of(load_robot("ur5")), np.empty((0, 6)))
    assert R.shape == (0, 3, 3)
    assert p.shape == (0, 3)


@given(chains, st.integers(0, 2**32 - 1))
@settings(max_examples=80, deadline=None)
def test_any_chain_of_any_axes_equals_pinocchio(
    parts: tuple[list[Joint], Joint, Joint], seed: int
) -> None:
    joints, base, tip = parts
    document = urdf_of(joints, base, tip)
    robot = robot_of(joints, base, tip)
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.9, 2.9, robot.dof)
    chain = chain_of(robot)
    R, p = forward(chain, q)
    want = pinocchio_pose(document, robot, q.tolist())
    np.testing.assert_allclose(R, want.rotation, rtol=0, atol=1e-12)
    np.testing.assert_allclose(p, want.translation, rtol=0, atol=1e-12)
    np.testing.assert_allclose(jacobian(chain, q), robot.jacobian(q), rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_the_jacobian_is_the_derivative_of_the_kernels_pose(name: str) -> None:
    robot = load_robot(name)
    chain = chain_of(robot)
    q = robot.random_configuration(np.random.default_rng(13))
    h = 1e-6
    numeric = np.empty((6, robot.dof))
    for k in range(robot.dof):
        step = h * np.eye(robot.dof)[k]
        behind, ahead = (pin.SE3(*forward(chain, q + s)) for s in (-step, step))
        numeric[:, k] = pin.log6(behind.actInv(ahead)).vector / (2.0 * h)
    np.testing.assert_allclose(jacobian(chain, q), numeric, rtol=0, atol=1e-8)


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: np.linalg.norm(a) > 1e-3))
@settings(deadline=None)
def test_an_alignment_turns_z_onto_the_axis(axis: tuple[float, ...]) -> None:
    unit = np.array(axis) / np.linalg.norm(axis)
    Q = aligning_rotation(unit)
    np.testing.assert_allclose(Q[:, 2], unit, rtol=0, atol=1e-15)
    np.testing.assert_allclose(Q.T @ Q, np.eye(3), rtol=0, atol=1e-14)
    assert np.linalg.det(Q) == pytest.approx(1.0)


def turned(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation, with 1 - cos written so that it keeps its digits."""
    K = pin.skew(axis)
    return np.asarray(np.eye(3) + math.sin(angle) * K + 2.0 * math.sin(0.5 * angle) ** 2 * K @ K)


SMALL = [10.0**-k for k in range(1, 17)]
ANGLES = [0.0, *SMALL, 0.5, 1.0, 2.0, 2.09, 2.1, 3.0, *(math.pi - d for d in SMALL), math.pi]


@pytest.mark.parametrize("angle", ANGLES)
def test_the_rotation_vector_is_exact_at_every_angle(angle: float) -> None:
    rng = np.random.default_rng(14)
    axes = [*np.eye(3), *-np.eye(3), *rng.normal(size=(50, 3))]
    axes += [v * [1.0, 1e-9, 1.0] for v in rng.normal(size=(20, 3))]
    for v in axes:
        axis = v / np.linalg.norm(v)
        R, out = turned(axis, angle), np.empty(3)
        found = rotation_log(R, out)
        # At a half turn the axis has no sign; R holds only what rounding left of it.
        signs = (1.0, -1.0) if math.pi - angle < 1e-14 else (1.0,)
        error = min(np.abs(out - sign * angle * axis).max() for sign in signs)
        assert error < 4e-15 * max(angle, 1e-3)
        assert found == pytest.approx(angle, rel=1e-15, abs=1e-15)


def test_the_rotation_vector_equals_pinocchios() -> None:
    rng = np.random.default_rng(15)
    for _ in range(500):
        R = pin.exp3(rng.uniform(0.0, 3.0) * (lambda v: v / np.linalg.norm(v))(rng.normal(size=3)))
        out = np.empty(3)
        angle = rotation_log(R, out)
        np.testing.assert_allclose(out, pin.log3(R), rtol=0, atol=1e-12)
        assert angle == pytest.approx(np.linalg.norm(out))


def error_of(have: pin.SE3, want: pin.SE3) -> tuple[float, float, np.ndarray]:
    e = np.empty(6)
    distance, angle = pose_error(
        have.rotation.copy(),
        have.translation,
        want.rotation.copy(),
        want.translation,
        np.empty((3, 3)),
        e,
        np.empty(3),
    )
    return distance, angle, e


def test_the_pose_error_is_the_difference_in_the_tool_frame() -> None:
    pin.seed(16)
    for _ in range(500):
        have, want = pin.SE3.Random(), pin.SE3.Random()
        distance, angle, e = error_of(have, want)
        difference = have.actInv(want)
        np.testing.assert_allclose(e[:3], difference.translation, atol=1e-14)
        np.testing.assert_allclose(e[3:], pin.log3(difference.rotation), atol=1e-9)
        assert distance == pytest.approx(np.linalg.norm(want.translation - have.translation))
        assert angle == pytest.approx(np.linalg.norm(e[3:]))


def test_the_pose_error_does_not_depend_on_the_base() -> None:
    pin.seed(17)
    for _ in range(100):
        have, want, moved = pin.SE3.Random(), pin.SE3.Random(), pin.SE3.Random()
        a, b = error_of(have, want), error_of(moved * have, moved * want)
        np.testing.assert_allclose(a[2], b[2], atol=1e-12)


def test_the_pose_error_vanishes_only_at_the_target() -> None:
    pin.seed(18)
    pose = pin.SE3.Random()
    distance, angle, e = error_of(pose, pose)
    assert distance == 0.0
    assert angle < 1e-15
    assert np.abs(e).max() < 1e-15


def test_to_first_order_a_motion_by_the_error_reaches_the_target() -> None:
    """e is what J dq has to make up: with J dq = e for a small e, the target is met."""
    robot = load_robot("ur5")
    chain = chain_of(robot)
    rng = np.random.default_rng(19)
    for _ in range(20):
        q = robot.random_configuration(rng)
        dq = 1e-6 * rng.normal(size=robot.dof)
        *_, e = error_of(pin.SE3(*forward(chain, q)), pin.SE3(*forward(chain, q + dq)))
        np.testing.assert_allclose(e, jacobian(chain, q) @ dq, atol=1e-10)
