"""Points of a path are tracked on one branch, as far as there is one: a planar arm tells."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import ORIENTATION_WEIGHT, no_freedom
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.tracking_kernels import (
    NO_EXTRA_OFFSET,
    errors_at,
    first_discontinuity,
    project_onto_targets,
    track_points,
)
from ikplan.robots import Robot, load_robot
from tests.planning.planar import L1, L2, REACH, joints, positions, tool, two_links

EXACT = 1e-9


def tracked(
    robot: Robot,
    p: np.ndarray,
    q_first: np.ndarray,
    first: int = 0,
    extra_offset: float = NO_EXTRA_OFFSET,
) -> tuple[int, np.ndarray]:
    """The last point reached, and the configurations up to it."""
    arm, q = arm_of(robot), np.full((len(p), robot.dof), np.nan)
    q[first] = q_first
    s = np.linspace(0.0, 1.0, len(p))
    reached, evaluations = track_points(
        arm.chain,
        positions(p),
        s,
        q,
        first,
        arm.lower,
        arm.upper,
        EXACT,
        EXACT,
        False,
        extra_offset,
        damped=False,
    )
    assert evaluations > 0
    return reached, q


def straight(a: tuple[float, float], b: tuple[float, float], count: int) -> np.ndarray:
    return np.linspace([*a, 0.0], [*b, 0.0], count)


@settings(deadline=None, max_examples=40)
@given(
    elbow=st.sampled_from([1.0, -1.0]),
    ends=st.tuples(*[st.floats(-1.3, 1.3), st.floats(0.2, 0.85)] * 2),
)
def test_a_line_within_reach_is_followed_on_its_branch(
    elbow: float, ends: tuple[float, ...]
) -> None:
    a, b = ((r * math.cos(angle), r * math.sin(angle)) for angle, r in (ends[:2], ends[2:]))
    p = straight(a, b, 401)
    assume(np.linalg.norm(p, axis=1).min() > 0.15)
    want = joints(p, elbow)
    reached, q = tracked(two_links(), p, want[0])
    assert reached == len(p) - 1
    np.testing.assert_allclose(q, want, atol=1e-7)


def test_a_line_out_of_reach_is_followed_to_the_last_point_within() -> None:
    p = straight((0.5, 0.2), (1.1, 0.2), 121)
    within = np.linalg.norm(p, axis=1) <= REACH
    last = int(np.flatnonzero(within)[-1])
    reached, q = tracked(two_links(), p, joints(p[0], 1.0))
    # Steps of two points, and no half-way that moves far, as it does by the stretched arm.
    assert reached % 2 == 0
    assert last - 4 <= reached <= last
    np.testing.assert_allclose(tool(q[: reached + 1]), p[: reached + 1], atol=EXACT)
    assert np.isnan(q[reached + 1 :]).all()


@pytest.mark.parametrize("limit", [0.4, 0.9])
def test_a_turn_about_the_base_ends_at_the_limit_of_the_shoulder(limit: float) -> None:
    angles = np.linspace(0.0, 1.5, 151)
    p = 0.6 * np.stack([np.cos(angles), np.sin(angles), np.zeros(151)], axis=1)
    shift = joints(p[0], 1.0)[0]
    robot = two_links(shoulder=(-2.9, shift + limit))
    reached, q = tracked(robot, p, joints(p[0], 1.0))
    assert angles[reached] <= limit + 1e-9 < angles[reached + 2]
    np.testing.assert_allclose(np.diff(q[: reached + 1, 1]), 0.0, atol=1e-8)
    np.testing.assert_allclose(q[: reached + 1, 0], shift + angles[: reached + 1], atol=1e-8)


def test_a_point_far_aside_is_not_stepped_to() -> None:
    """What the tool jumps, the arm does not: there is no threshold, the half-way tells."""
    p = straight((0.4, -0.3), (0.5, 0.3), 41)
    p[21:] += [0.0, 0.25, 0.0]
    reached, _ = tracked(two_links(), p, joints(p[0], 1.0))
    assert reached == 20


def test_a_bend_sharper_than_the_points_takes_slack() -> None:
    """Out and back within one step: half-way is off the middle by the whole of the step out."""
    out = 0.02
    p = np.tile([0.6, 0.1, 0.0], (3, 1))
    p[1, 1] += out
    q0 = joints(p[0], 1.0)
    off = float(np.linalg.norm(joints(p[1], 1.0) - q0))
    assert tracked(two_links(), p, q0, extra_offset=0.9 * off)[0] == 0
    assert tracked(two_links(), p, q0, extra_offset=1.1 * off)[0] == 2


def test_following_goes_on_from_a_later_point() -> None:
    p = straight((0.4, -0.3), (0.5, 0.3), 41)
    want = joints(p, -1.0)
    reached, q = tracked(two_links(), p, want[10], first=10)
    assert reached == 40
    assert np.isnan(q[:10]).all()
    np.testing.assert_allclose(q[10:], want[10:], atol=1e-8)


@pytest.mark.parametrize("at", [1, 2, 7, 20, 33, 39])
def test_a_change_of_the_branch_is_found_where_it_is(at: int) -> None:
    p = straight((0.4, -0.3), (0.5, 0.3), 41)
    arm = arm_of(two_links())
    q = joints(p, 1.0)
    whole, _ = first_discontinuity(arm.chain, positions(p), q, arm.lower, arm.upper, EXACT, EXACT)
    assert whole == 40
    q[at:] = joints(p[at:], -1.0)
    broken, _ = first_discontinuity(arm.chain, positions(p), q, arm.lower, arm.upper, EXACT, EXACT)
    assert broken == 2 * ((at - 1) // 2)


def test_configurations_come_onto_their_targets_or_as_near_as_the_reach_lets_them() -> None:
    rng = np.random.default_rng(2)
    p = straight((0.4, -0.3), (0.5, 0.3), 15)
    want = joints(p, 1.0)
    q = want + rng.normal(size=want.shape) * 0.02
    p[4], p[9] = [1.2, 0.3, 0.0], [0.02, 0.01, 0.0]
    arm = arm_of(two_links())
    left, evaluations = project_onto_targets(arm.chain, positions(p), q, arm.lower, arm.upper)
    assert evaluations >= len(p)
    there = np.ones(15, dtype=bool)
    there[[4, 9]] = False
    assert left[there].max() <= EXACT
    np.testing.assert_allclose(q[there], want[there], atol=1e-7)
    beyond = np.linalg.norm(p[4]) - REACH
    assert left[4] >= beyond - 1e-12
    np.testing.assert_allclose(left, np.linalg.norm(tool(q) - p, axis=1), atol=1e-9)


@pytest.mark.parametrize("oriented", [True, False])
def test_errors_at_targets_are_those_of_pinocchio(oriented: bool) -> None:
    robot = load_robot("iiwa14")
    rng = np.random.default_rng(4)
    q, elsewhere = (np.array([robot.random_configuration(rng) for _ in range(20)]) for _ in "ab")
    (R, p), (R_have, p_have) = robot.poses(elsewhere), robot.poses(q)
    mask = np.full(20, oriented)
    weight = np.where(mask, ORIENTATION_WEIGHT, 0.0)
    targets = Targets(R.copy(), p.copy(), mask, weight, no_freedom())
    distance, angle = errors_at(arm_of(robot).chain, targets, q)
    np.testing.assert_allclose(distance, np.linalg.norm(p_have - p, axis=1), rtol=1e-9)
    trace = np.einsum("nij,nij->n", R, R_have)
    turned = np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0))
    np.testing.assert_allclose(angle, turned if oriented else 0.0, atol=1e-7)


def test_a_redundant_arm_leans_away_from_its_limits_and_stays_on_the_path() -> None:
    """The iiwa begins with its last joint near to its limit, which a swing of the elbow eases."""
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    q0 = np.array([0.3, 0.7, 0.2, -1.4, 0.2, 0.9, 2.9])
    T = robot.fk(q0)
    m = 161
    p = T.translation + np.linspace(0.0, 0.2, m)[:, None] * np.array([0.0, 0.0, -1.0])
    R = np.broadcast_to(T.rotation, (m, 3, 3)).copy()
    targets = Targets(R, p, np.ones(m, dtype=bool), np.full(m, ORIENTATION_WEIGHT), no_freedom())
    left = []
    for leaning in (False, True):
        q = np.full((m, 7), np.nan)
        q[0] = q0
        reached, _ = track_points(
            arm.chain, targets, np.linspace(0.0, 0.2, m), q, 0, arm.lower, arm.upper, EXACT, EXACT,
            leaning, NO_EXTRA_OFFSET, False,
        )  # fmt: skip
        assert reached == m - 1
        R_have, p_have = robot.poses(q)
        np.testing.assert_allclose(p_have, p, atol=1e-8)
        np.testing.assert_allclose(R_have, R, atol=1e-8)
        assert ((arm.lower <= q) & (q <= arm.upper)).all()
        left.append(robot.upper[6] - q[-1, 6])
    assert left[1] > left[0] + 0.3


def test_the_arm_is_the_one_of_the_closed_form() -> None:
    robot, rng = two_links(), np.random.default_rng(0)
    for q in rng.uniform(-2.9, 2.9, (20, 2)):
        np.testing.assert_allclose(robot.fk(q).translation, tool(q), atol=1e-12)
        np.testing.assert_allclose(joints(tool(q), np.sign(q[1])), q, atol=1e-9)
    assert (L1, L2) == (0.5, 0.4)


def test_damped_self_motion_stays_small_through_many_points() -> None:
    """Undamped, each step away from a limit adds to the speed that the self-motion has."""
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    q0 = np.array([0.3, 0.7, 0.2, -1.4, 0.2, 0.9, 3.0])
    T = robot.fk(q0)
    lengths: dict[bool, list[float]] = {False: [], True: []}
    for m in (161, 641, 2561):
        s = np.linspace(0.0, 0.2, m)
        p = T.translation + s[:, None] * np.array([0.0, 0.0, -1.0])
        R = np.broadcast_to(T.rotation, (m, 3, 3)).copy()
        targets = Targets(
            R, p, np.ones(m, dtype=bool), np.full(m, ORIENTATION_WEIGHT), no_freedom()
        )
        for damped, found in lengths.items():
            q = np.full((m, 7), np.nan)
            q[0] = q0
            reached, _ = track_points(
                arm.chain, targets, s, q, 0, arm.lower, arm.upper, EXACT, EXACT, True,
                NO_EXTRA_OFFSET, damped,
            )  # fmt: skip
            assert reached == m - 1
            found.append(float(np.linalg.norm(np.diff(q, axis=0), axis=1).sum()))
    assert max(lengths[True]) < 2.0 * min(lengths[True])
    assert min(lengths[False]) > 4.0 * max(lengths[True])
