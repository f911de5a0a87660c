"""Joints with room for full turns: the copy that the whole path wants, not the nearest one."""

import itertools
import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from ikplan.kinematics.arm import arm_of
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.planning.ladder.ik_candidates import IkCandidates
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.ladder.ladder_graph import diverse_shortest_paths
from ikplan.planning.ladder.motion_cost import plain_cost
from ikplan.robots import load_robot

TURN = 2.0 * math.pi
EOD = arm_of(load_robot("eod_arm")).chain  # six revolute joints


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), free=st.booleans())
def test_the_shortest_path_is_found_among_all_the_copies(seed: int, free: bool) -> None:
    rng = np.random.default_rng(seed)
    dof = 6
    upper = rng.uniform(2.0, 2.6 * math.pi, dof)
    upper[3:] = 1.0  # few enough copies to try them all
    lower = -upper
    q = rng.uniform(-1, 1, (4, 3, dof)) * np.minimum(upper, math.pi)
    counts = rng.integers(1, 4, size=4)
    start = rng.uniform(lower, upper)
    candidates = IkCandidates(q, counts, np.zeros(1, dtype=np.int64))
    paths = diverse_shortest_paths(
        EOD, candidates, start, free, lower, upper, plain_cost(len(lower)), 5, 1e-9, 10.0
    )

    rows = []
    for k in range(4):
        solutions = []
        for value in q[k, : counts[k]]:
            copies = [
                [v + TURN * i for i in range(-3, 4) if lo <= v + TURN * i <= up]
                for v, lo, up in zip(value, lower, upper, strict=True)
            ]
            solutions += [np.array(c) for c in itertools.product(*copies)]
        rows.append(np.array(solutions))
    cost = np.zeros(len(rows[0])) if free else np.linalg.norm(rows[0] - start, axis=1)
    for before, here in itertools.pairwise(rows):
        steps = np.linalg.norm(before[:, None] - here[None], axis=2)
        cost = np.min(cost[:, None] + steps, axis=0)
    assert joint_path_length(paths[0], start, free) == pytest.approx(cost.min(), rel=1e-9)
    assert ((lower <= paths[0]) & (paths[0] <= upper)).all()


def test_the_copies_of_a_solution_are_all_those_within_the_limits() -> None:
    arm = arm_of(load_robot("ur5"))  # all joints turn by 2 pi either way, the elbow by pi
    copies = with_equivalents(arm, np.full((1, 6), 0.5))
    assert len(copies) == 2**5
    assert ((arm.lower <= copies) & (copies <= arm.upper)).all()
    np.testing.assert_allclose(np.mod(copies, TURN), 0.5)


def test_a_joint_without_limits_goes_on_turning() -> None:
    # Around the base and on: the arm's first joint has no limits, so it never turns back.
    robot = load_robot("kinova_j2s6s200")
    T = robot.fk(robot.home)
    radius = float(np.hypot(T.translation[0], T.translation[1]))
    begin = math.atan2(T.translation[1], T.translation[0])
    waypoints = []
    for k in range(25):
        angle = 2.0 * TURN * k / 24
        turn = np.array(
            [
                [math.cos(angle), -math.sin(angle), 0.0],
                [math.sin(angle), math.cos(angle), 0.0],
                [0.0, 0.0, 1.0],
            ]
        )
        p = [radius * math.cos(begin + angle), radius * math.sin(begin + angle), T.translation[2]]
        quaternion = pin.Quaternion(turn @ T.rotation).coeffs()
        waypoints.append({"position": p, "quaternion_xyzw": quaternion.tolist()})
    plan = ikplan.plan({"robot": "kinova_j2s6s200", "path": {"waypoints": waypoints}})
    q = plan.waypoints.q
    turned = np.abs(q[-1] - q[0])
    assert turned.max() == pytest.approx(2.0 * TURN, abs=0.2)
    assert np.abs(np.diff(q, axis=0)).max() < 1.2


def test_a_tool_path_may_wind_a_joint_without_limits_on() -> None:
    robot = load_robot("kinova_j2s6s200")
    height = float(robot.fk(robot.home).translation[2])
    arc = {"type": "arc", "centre": [0.0, 0.0, height], "axis": [0, 0, 1], "angle": 3.0 * TURN}
    plan = ikplan.plan(
        {"robot": robot.name, "path": {"segments": [arc], "orientation_free": "all"}}
    )
    turned = np.abs(plan.q[-1] - plan.q[0])
    assert turned.max() > TURN
    assert turned.argmax() == 0
