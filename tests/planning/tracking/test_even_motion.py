"""The even motion between two configurations, against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from ikplan import load_robot
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.within.even_motion import evened_motion
from ikplan.planning.within.window_kernels import linearised_errors

Array = NDArray[np.float64]

POSITION, ORIENTATION = 1e-3, 1e-2


def dense(arm: Arm, targets: Targets, q: Array, weight: float) -> Array:
    """Three Gauss-Newton steps, by a matrix of all unknowns."""
    q, (m, dof) = q.copy(), q.shape
    second = np.diff(np.eye(m), 2, axis=0)
    stiffness = second.T @ second
    inner = slice(1, m - 1)
    for _ in range(3):
        e, J = linearised_errors(arm.chain, targets, q)
        e, J = e[inner] / POSITION, J[inner] / POSITION
        matrix = weight * np.kron(stiffness[inner, inner], np.eye(dof))
        for k in range(m - 2):
            at = slice(k * dof, (k + 1) * dof)
            matrix[at, at] += J[k].T @ J[k]
        pull = np.einsum("kij,ki->kj", J, e) - weight * (stiffness @ q)[inner]
        q[inner] += np.linalg.solve(matrix, pull.ravel()).reshape(m - 2, dof)
    return np.asarray(np.clip(q, arm.lower, arm.upper))


@pytest.mark.parametrize("name", ["ur5", "iiwa14"])
@pytest.mark.parametrize("steps", [2, 3, 4, 24])
@pytest.mark.parametrize("weight", [1e2, 1e8])
def test_an_even_motion_is_that_of_dense_equations(name: str, steps: int, weight: float) -> None:
    robot = load_robot(name)
    arm = arm_of(robot)
    share = np.linspace(0.0, 1.0, steps + 1)[:, None]
    begin = np.array([0.2, -1.0, 0.9, -0.8, 0.7, 0.3, 0.1])[: robot.dof]
    q = begin + share * 0.2 + 0.01 * np.sin(7.0 * share)
    targets = stack_targets([pose_target(T.translation, T.rotation) for T in map(robot.fk, q)])
    straight = np.ascontiguousarray(begin + share * (q[-1] - q[0]))
    found = straight.copy()
    accepted = evened_motion(
        arm.chain, targets, found, arm.lower, arm.upper, np.array([weight]),
        POSITION, ORIENTATION, np.inf, 1.02,
    )  # fmt: skip
    assert accepted
    np.testing.assert_allclose(found, dense(arm, targets, straight, weight), atol=1e-10)


def test_where_no_weight_keeps_the_tolerance_the_motion_is_left() -> None:
    robot = load_robot("ur5")
    arm = arm_of(robot)
    q = np.linspace(np.full(6, 0.3), np.full(6, 0.6), 9)
    far = stack_targets([pose_target(np.array([3.0, 0.0, 0.0]), np.eye(3))] * 9)
    found = q.copy()
    assert not evened_motion(
        arm.chain, far, found, arm.lower, arm.upper, np.array([1e6, 1e4]),
        POSITION, ORIENTATION, 0.85, 1.02,
    )  # fmt: skip
    np.testing.assert_array_equal(found, q)
