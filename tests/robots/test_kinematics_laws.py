"""What holds for the kinematics of every robot of the catalogue."""

from __future__ import annotations

import pickle
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml

from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot, load_robot
from ikplan.robots.folders import package_file, robot_folder

NAMES = REFERENCE_ROBOTS


def _from_package(name: str) -> Path | None:
    file = yaml.safe_load((robot_folder(name) / "robot.yaml").read_text())
    urdf = file["kinematics"].get("urdf")
    return None if urdf is None else package_file(urdf["package"], urdf["path"])


def _reduced(robot: Robot, path: Path) -> pin.Model:
    """Pinocchio's own reading of the file, its other joints locked at neutral."""
    full = pin.buildModelFromUrdf(str(path))
    locked = [i for i in range(1, full.njoints) if full.names[i] not in robot.joint_names]
    return pin.buildReducedModel(full, locked, pin.neutral(full))


@pytest.mark.parametrize("name", [n for n in NAMES if _from_package(n) is not None])
def test_model_is_pinocchios_own_reduced_model(name: str) -> None:
    robot = load_robot(name)
    path = _from_package(name)
    assert path is not None
    reduced = _reduced(robot, path)
    assert tuple(reduced.names)[1:] == robot.joint_names
    data = reduced.createData()
    base = reduced.getFrameId(robot.base_frame, pin.FrameType.BODY)
    tip = reduced.getFrameId(robot.tip_frame, pin.FrameType.BODY)
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = robot.random_configuration(rng)
        configuration = robot.configuration(q)
        pin.framesForwardKinematics(reduced, data, configuration)
        want = data.oMf[base].actInv(data.oMf[tip])
        np.testing.assert_allclose(robot.fk(q).homogeneous, want.homogeneous, atol=1e-12)
        J = pin.computeFrameJacobian(reduced, data, configuration, tip, pin.ReferenceFrame.LOCAL)
        np.testing.assert_allclose(robot.jacobian(q), J, atol=1e-12)
        tau = pin.computeGeneralizedGravity(reduced, data, configuration)
        mine = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), configuration)
        np.testing.assert_allclose(mine, tau, atol=1e-9)
    bounded = ~robot.continuous
    index = [reduced.joints[i + 1].idx_q for i in np.flatnonzero(bounded).tolist()]
    np.testing.assert_array_equal(reduced.lowerPositionLimit[index], robot.lower[bounded])
    np.testing.assert_array_equal(reduced.upperPositionLimit[index], robot.upper[bounded])
    np.testing.assert_array_equal(reduced.upperVelocityLimit, robot.velocity_limit)


@pytest.mark.parametrize("tool", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_jacobian_is_the_derivative_of_the_pose(name: str, tool: bool) -> None:
    robot = load_robot(name)
    if tool:
        robot = robot.with_tool([0.1, -0.2, 0.3], [0.5, 0.5, -0.5, 0.5])
    rng = np.random.default_rng(4)
    h = 1e-6
    for _ in range(3):
        q = robot.random_configuration(rng)
        numeric = np.empty((6, robot.dof))
        for i in range(robot.dof):
            step = h * np.eye(robot.dof)[i]
            change = robot.fk(q - step).actInv(robot.fk(q + step))
            numeric[:, i] = pin.log6(change).vector / (2 * h)
        np.testing.assert_allclose(robot.jacobian(q), numeric, atol=2e-8)


@pytest.mark.parametrize("name", NAMES)
def test_many_at_once_are_the_same_as_one_by_one(name: str) -> None:
    robot = load_robot(name).with_tool([0.1, -0.2, 0.3], [0.5, 0.5, -0.5, 0.5])
    rng = np.random.default_rng(9)
    q = np.array([robot.random_configuration(rng) for _ in range(5)])
    R, p = robot.poses(q)
    J = robot.jacobians(q)
    for k in range(len(q)):
        np.testing.assert_allclose(R[k], robot.fk(q[k]).rotation, atol=1e-14)
        np.testing.assert_allclose(p[k], robot.fk(q[k]).translation, atol=1e-14)
        np.testing.assert_allclose(J[k], robot.jacobian(q[k]), atol=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_pickled_robot_is_the_same(name: str) -> None:
    robot = load_robot(name).with_tool([0, 0, 0.1])
    copy = pickle.loads(pickle.dumps(robot))
    assert copy.fingerprint == robot.fingerprint
    assert copy.fk(robot.home) == robot.fk(robot.home)
    np.testing.assert_array_equal(copy.coupling, robot.coupling)


@pytest.fixture
def fast_switching() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.parametrize("name", ["kinova_j2s6s200", "tiago", "dobot_magician"])
@pytest.mark.usefixtures("fast_switching")
def test_threads_do_not_disturb_each_other(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(5)
    configurations = [robot.random_configuration(rng) for _ in range(200)]
    want = [robot.fk(q).homogeneous for q in configurations]
    wrong: list[int] = []

    def work(order: list[int]) -> None:
        wrong.extend(
            i for i in order if not np.array_equal(robot.fk(configurations[i]).homogeneous, want[i])
        )

    threads = [
        threading.Thread(target=work, args=(rng.permutation(200).tolist(),)) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_continuous_joint_takes_any_turn() -> None:
    robot = load_robot("kinova_j2s6s200")
    assert robot.continuous.tolist() == [True, False, False, True, False, True]
    assert robot.model.nq == 9
    assert robot.model.nv == 6
    turned = robot.home + 2 * np.pi * np.array([3, 0, 0, -2, 0, 1])
    np.testing.assert_allclose(
        robot.fk(turned).homogeneous, robot.fk(robot.home).homogeneous, atol=1e-12
    )
    assert np.isneginf(robot.lower[robot.continuous]).all()
    assert np.isposinf(robot.upper[robot.continuous]).all()
    np.testing.assert_array_equal(robot.clip(turned)[robot.continuous], turned[[0, 3, 5]])
    rng = np.random.default_rng(6)
    draws = np.array([robot.random_configuration(rng) for _ in range(300)])[:, robot.continuous]
    assert draws.min() >= -np.pi
    assert draws.max() < np.pi
    assert draws.min() < -0.9 * np.pi
    assert draws.max() > 0.9 * np.pi


def test_prismatic_joint_slides() -> None:
    robot = load_robot("tiago")
    assert robot.prismatic.tolist() == [True] + [False] * 7
    up = robot.home + 0.1 * np.eye(8)[0]
    shift = robot.fk(up).translation - robot.fk(robot.home).translation
    np.testing.assert_allclose(shift, [0, 0, 0.1], atol=1e-14)


def test_serial_joints_follow_the_coupling() -> None:
    robot = load_robot("dobot_magician")
    assert robot.coupling.shape == (5, 4)
    q = np.array([0.1, 0.5, 0.7, -0.2])
    serial = robot.coupling @ q + robot.coupling_offset
    np.testing.assert_allclose(serial, [0.1, 0.5, 0.2, -0.7, 0.2])
    np.testing.assert_array_equal(robot.configuration(q), serial)
    # theta3 - theta2 runs from -95 to 95 deg, as the users' limits allow.
    np.testing.assert_allclose(np.degrees(robot.model.upperPositionLimit[2]), 95)
    np.testing.assert_allclose(np.degrees(robot.model.lowerPositionLimit[2]), -95)


@pytest.mark.parametrize("name", NAMES)
def test_random_configurations_fill_the_limits(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(7)
    draws = np.array([robot.random_configuration(rng) for _ in range(400)])
    assert (draws >= robot.lower).all()
    assert (draws <= robot.upper).all()
    bounded = ~robot.continuous
    spread = np.ptp(draws, axis=0)[bounded] / (robot.upper - robot.lower)[bounded]
    assert spread.min() > 0.95
    outside = np.where(bounded, robot.upper + 1, 0.0)
    np.testing.assert_array_equal(robot.clip(outside)[bounded], robot.upper[bounded])


@pytest.mark.parametrize(
    ("q", "said"),
    [
        ([0, 0, 0], "7 values expected"),
        ([0] * 8, "7 values expected"),
        ([[0] * 7], "shape"),
        ([0, 0, np.nan, 0, 0, 0, 0], "must be 7 of them"),
        ([0, 0, 0, np.inf, 0, 0, 0], "must be 7 of them"),
        (["x"] * 7, "7 numbers"),
        (None, "7"),
    ],
)
@pytest.mark.parametrize("method", ["fk", "jacobian", "configuration", "clip"])
def test_wrong_joint_values_are_refused_by_name(method: str, q: object, said: str) -> None:
    with pytest.raises(InvalidRequest, match=said) as caught:
        getattr(load_robot("iiwa14"), method)(q)
    assert caught.value.field == "q"
    assert "7" in caught.value.allowed


def test_configuration_is_not_the_callers_array() -> None:
    robot = load_robot("iiwa14")
    q = robot.home.copy()
    configuration = robot.configuration(q)
    configuration[:] = 9
    np.testing.assert_array_equal(q, robot.home)
