"""The proof's forward kinematics and motion bounds, against Pinocchio and drawn motions."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from ikplan.certificate.clearance.bounds import motion_bounds
from ikplan.certificate.clearance.chain import chain_of, place_joints
from ikplan.robots import Robot, load_robot, robot_names


def placed(robot: Robot, serial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    R, p = np.empty((len(serial) + 1, 3, 3)), np.empty((len(serial) + 1, 3))
    place_joints(chain_of(robot), serial, R, p)
    return R, p


@pytest.mark.parametrize("name", robot_names())
def test_every_joint_is_where_pinocchio_has_it(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(1)
    data = robot.model.createData()
    for _ in range(10):
        q = robot.random_configuration(rng)
        R, p = placed(robot, robot.coupling @ q + robot.coupling_offset)
        pin.forwardKinematics(robot.model, data, robot.configuration(q))
        for k in range(1, robot.model.njoints):
            T = robot.T_universe_base.inverse() * data.oMi[k]
            np.testing.assert_allclose(R[k], T.rotation, atol=1e-12)
            np.testing.assert_allclose(p[k], T.translation, atol=1e-12)
        np.testing.assert_array_equal(R[0], np.eye(3))


@pytest.mark.parametrize("name", ["panda", "mh5", "tiago", "dobot_magician", "z1"])
def test_no_point_moves_farther_than_its_bound_and_some_nearly_as_far(name: str) -> None:
    """Against the frame of every joint before its own."""
    robot, rng = load_robot(name), np.random.default_rng(2)
    chain = chain_of(robot)
    n = robot.model.njoints - 1
    tightest = 0.0
    for _ in range(300):
        serial = robot.coupling @ robot.random_configuration(rng) + robot.coupling_offset
        delta = np.abs(rng.standard_normal(n)) * rng.choice([0.0, 0.01, 0.3, 2.0])
        delta *= rng.random(n) < 0.5
        carrier = np.array([int(rng.integers(1, n + 1))])
        local, size = rng.uniform(-0.2, 0.2, 3), float(rng.choice([0.0, 0.05]))
        R, p = placed(robot, serial)
        centre = (R[carrier[0]] @ local + p[carrier[0]])[None]
        bound = np.zeros((1, n + 1))
        motion_bounds(chain, R, p, delta, carrier, centre, np.array([size]), bound)
        offset = rng.standard_normal(3)
        point = local + size * offset / np.linalg.norm(offset)
        moved_R, moved_p = placed(robot, serial + delta * rng.choice([-1.0, 1.0], n))
        for base in range(carrier[0]):
            before = R[base].T @ (R[carrier[0]] @ point + p[carrier[0]] - p[base])
            after = moved_R[base].T @ (
                moved_R[carrier[0]] @ point + moved_p[carrier[0]] - moved_p[base]
            )
            moved = float(np.linalg.norm(after - before))
            assert moved <= bound[0, base] + 1e-12
            if bound[0, base] > 0.0:
                tightest = max(tightest, moved / bound[0, base])
    assert tightest > 0.95
