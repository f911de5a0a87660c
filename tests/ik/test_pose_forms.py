"""The forms in which a pose may be given."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import ikplan
from ikplan import InvalidRequest
from ikplan.ik.arguments import target_of


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_every_form_of_a_pose_is_the_same_target(seed: int) -> None:
    rng = np.random.default_rng(seed)
    quaternion = rng.standard_normal(4)
    quaternion /= np.linalg.norm(quaternion)
    position = rng.uniform(-1.0, 1.0, 3)
    pose = pin.SE3(pin.Quaternion(quaternion), position)
    scipy_rotation = Rotation.from_quat(quaternion)
    forms: list[Any] = [
        pose.homogeneous,
        pose.homogeneous.tolist(),
        np.concatenate([position, quaternion]),
        [*position, *-quaternion],
        (position, quaternion),
        [position.tolist(), quaternion.tolist()],
        (position, pose.rotation),
        (position, scipy_rotation),
    ]
    wanted = target_of(pose)
    for form in forms:
        found = target_of(form)
        assert found.oriented
        np.testing.assert_allclose(found.R, wanted.R, atol=1e-14)
        np.testing.assert_array_equal(found.p, wanted.p)


def test_position_alone_leaves_the_orientation() -> None:
    assert not target_of([0.1, 0.2, 0.3]).oriented
    assert not target_of((0.1, 0.2, 0.3)).oriented


@pytest.mark.parametrize(
    "pose",
    [
        [0.1, 0.2],
        np.zeros(6),
        np.zeros(7),
        np.zeros((4, 4)),
        np.diag([1.0, 1.0, -1.0, 1.0]),
        np.eye(4) + np.outer([0, 0, 0, 1.0], [0.1, 0, 0, 0]),
        ([0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 2.0]),
        ([0.1, 0.2], [0.0, 0.0, 0.0, 1.0]),
        ([0.1, 0.2, 0.3], "x"),
        ([0.1, 0.2, 0.3], [np.nan, 0.0, 0.0, 1.0]),
        {"position": [0.1, 0.2, 0.3]},
        None,
        "here",
    ],
)
def test_what_is_no_pose_is_told(pose: Any) -> None:
    with pytest.raises(InvalidRequest, match="pose"):
        target_of(pose)


def test_solutions_do_not_depend_on_the_form() -> None:
    robot = ikplan.load_robot("ur5")
    pose = robot.fk([0.3, -1.2, 1.4, -0.6, 0.9, 0.2])
    as_pose = ikplan.solve_ik(robot, pose, method="lm")
    as_matrix = ikplan.solve_ik(robot, pose.homogeneous, method="lm")
    np.testing.assert_allclose(as_matrix.q, as_pose.q, atol=1e-9)
