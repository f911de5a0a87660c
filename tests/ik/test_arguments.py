"""What callers from Python may not pass, and how it is told."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ikplan import InvalidRequest, load_robot, solve_ik

NAN, INF = math.nan, math.inf
CASES: list[tuple[str, dict[str, Any]]] = [
    ("tolerance.position", {"tolerance_position": NAN}),
    ("tolerance.position", {"tolerance_position": 0.0}),
    ("tolerance.orientation", {"tolerance_orientation": -1e-6}),
    ("tolerance.orientation", {"tolerance_orientation": INF}),
    ("ik.seed", {"seed": -1}),
    ("ik.seed", {"seed": 1.5}),
    ("ik.seed", {"seed": 2**63}),
    ("ik.seed", {"seed": "7"}),
    ("ik.population", {"population": 0}),
    ("ik.population", {"population": 2.5}),
    ("ik.population", {"population": True}),
    ("ik.population", {"population": "many"}),
    ("ik.population", {"method": "lm", "population": 10}),
    ("ik.iterations", {"iterations": 0}),
    ("ik.iterations", {"iterations": -3}),
    ("ik.iterations", {"method": "lm", "iterations": "foo"}),
    ("ik.method", {"method": "ik_ba"}),
    ("ik.method", {"method": 3}),
    ("ik.params", {"params": [1]}),
    ("ik.params.alpha", {"params": {"alpha": None}}),
    ("ik.params.alpha", {"params": {"alpha": NAN}}),
    ("ik.params.alpha", {"params": {"alpha": [0.9]}}),
    ("ik.params.alpha", {"params": {"alpha": True}}),
    ("ik.params.alpah", {"params": {"alpah": 0.9}}),
    ("ik.params.decouple", {"params": {"decouple": 1}}),
    ("ik.params.restarts", {"method": "lm", "params": {"restarts": 1.5}}),
    ("start", {"start": [0.0] * 6}),
    ("start", {"start": [[0.0] * 7]}),
    ("start", {"start": ["a"] * 7}),
    ("start", {"start": [[0.0], [0.0, 1.0]]}),
    ("start[2]", {"start": [0, 0, NAN, 0, 0, 0, 0]}),
    ("start[6]", {"start": [0, 0, 0, 0, 0, 0, -INF]}),
    ("start[3]", {"start": [0, 0, 0, 2.2, 0, 0, 0]}),
]


@pytest.mark.parametrize(("field", "arguments"), CASES)
def test_a_wrong_argument_is_named(field: str, arguments: dict[str, Any]) -> None:
    robot = load_robot("iiwa14")
    with pytest.raises(InvalidRequest) as caught:
        solve_ik(robot, robot.fk(robot.home), **arguments)
    assert caught.value.field == field
    assert field in caught.value.detail


def test_one_and_true_are_told_apart_in_either_order() -> None:
    robot = load_robot("ur5")
    pose = robot.fk(robot.home)
    for first, second in (({"alpha": 1}, {"alpha": True}), ({"decouple": False}, {"decouple": 0})):
        solve_ik(robot, pose, params=first)
        with pytest.raises(InvalidRequest):
            solve_ik(robot, pose, params=second)


class Pose:
    """Something that looks like a pose."""

    def __init__(self, rotation: Any, translation: Any) -> None:
        self.rotation, self.translation = rotation, translation


AT = [0.3, 0.2, 0.4]
BAD_POSES: list[Any] = [
    None,
    "here",
    [0.1, 0.2],
    [0.1, 0.2, NAN],
    [0.1, 0.2, INF],
    [2e6, 0.0, 0.0],
    ["x", "y", "z"],
    np.eye(3),
    Pose(np.diag([1.0, 1.0, -1.0]), AT),
    Pose(np.diag([1.0, 1.0, 1.1]), AT),
    Pose(np.full((3, 3), NAN), AT),
    Pose(np.zeros((3, 3)), AT),
    Pose(np.eye(4), AT),
    Pose("none", AT),
    Pose(np.eye(3), [0.1]),
    Pose(np.eye(3), [0.1, NAN, 0.0]),
]


@pytest.mark.parametrize("pose", BAD_POSES, ids=range(len(BAD_POSES)))
def test_what_is_no_pose_is_refused(pose: Any) -> None:
    with pytest.raises(InvalidRequest) as caught:
        solve_ik(load_robot("ur5"), pose)
    assert caught.value.field == "pose"


def test_a_joint_without_limits_starts_somewhere_finite() -> None:
    robot = load_robot("kinova_j2s6s200")
    for value in (INF, NAN, 1e7):
        start = np.where(robot.continuous, value, robot.home)
        with pytest.raises(InvalidRequest) as caught:
            solve_ik(robot, robot.fk(robot.home), start=start)
        assert caught.value.field == "start[0]"


def test_an_unknown_method_is_answered_with_near_names() -> None:
    robot = load_robot("ur5")
    with pytest.raises(InvalidRequest, match="did you mean 'ik-ba'") as caught:
        solve_ik(robot, robot.fk(robot.home), method="ikba")
    assert {"ik-ba", "lm"} <= set(caught.value.allowed)


def test_an_unknown_parameter_is_answered_with_near_names() -> None:
    robot = load_robot("ur5")
    with pytest.raises(InvalidRequest, match="did you mean 'alpha'") as caught:
        solve_ik(robot, robot.fk(robot.home), params={"alfa": 0.9})
    assert "gamma" in caught.value.allowed


def test_decoupling_an_arm_without_a_spherical_wrist_is_refused() -> None:
    robot = load_robot("ur5")
    with pytest.raises(InvalidRequest, match="spherical wrist") as caught:
        solve_ik(robot, robot.fk(robot.home), params={"decouple": True})
    assert caught.value.field == "ik.params.decouple"
