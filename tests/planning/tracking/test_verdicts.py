"""Why a path has no plan: the verdict says what a planar arm's closed form says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from ikplan import Disconnected, Robot, Unreachable, load_robot
from ikplan.documents.poses import Tolerance
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.path import Pose, ToolPath
from ikplan.planning import select_configurations
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.tracking.tracking_failure import explain_tracking_failure
from tests.path.requests import pose, through
from tests.planning.planar import (
    L1,
    L2,
    REACH,
    WAYPOINTS,
    Elongation,
    joints,
    problem_of,
    solver_of,
    tool,
    tracker_of,
    two_links,
)


def path_of(*points: tuple[float, float]) -> ToolPath:
    """Lines in the plane, positions alone."""
    first, *rest = ([x, y, 0.0] for x, y in points)
    return through([pose(p) for p in rest], "line", Pose(np.eye(3), np.array(first)))


def verdict(robot: Robot, path: ToolPath, failure: TrackingFailed) -> Unreachable | Disconnected:
    return explain_tracking_failure(robot, solver_of(robot), tracker_of(robot), path, failure)


def lost_on(robot: Robot, path: ToolPath, elbow: float) -> TrackingFailed:
    """Where the arm is failure, tracker_of from the begin of a path on one branch."""
    start = joints(path.pose(0.0)[1], elbow)
    with pytest.raises(TrackingFailed) as caught:
        tracker_of(robot).track(path, start[None], np.zeros(1))
    return caught.value


def at_shoulder_limit(short: float, direction: float) -> tuple[Robot, ToolPath, TrackingFailed]:
    """An arm folded to 0.22 m, so far short of a limit of its shoulder; the path goes round to it.

    The path is 1 m long: what is looked at of it next are 0.2 mm, 0.91 mrad of the shoulder. The
    other branch has its shoulder on the far side of the limit.
    """
    q = np.array([0.3, -2.7 * direction])
    p = tool(q)[:2]
    aside = 0.1 * direction * np.array([-p[1], p[0]]) / np.linalg.norm(p)
    ends = [p + k * aside for k in (0, 1, -1, 1, -1, 1, 0)]
    limit = q[0] + direction * short
    robot = two_links((-3.1, limit) if direction > 0 else (limit, 3.1))
    return robot, path_of(*map(tuple, ends)), TrackingFailed(0.0, q)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(
    ("short", "back", "named"),
    [
        (0.0, False, True),
        (5e-4, False, True),
        (8e-4, False, True),
        (1.2e-3, False, False),
        (0.01, False, False),
        (5e-4, True, False),
        (5e-5, True, True),
    ],
)
def test_the_limit_that_the_next_bit_of_the_path_runs_into_is_named(
    short: float, back: bool, named: bool, direction: float
) -> None:
    """At its limit, to 0.1 mrad, or brought there by the next 0.2 mm; not on the way back."""
    robot, path, failure = at_shoulder_limit(short, direction)
    if back:
        ends = [path.pose(0.0)[1], *(w.p for w in path.waypoints)]
        path = path_of(*(tuple((2.0 * ends[0] - p)[:2]) for p in ends))
    assert path.length == pytest.approx(1.0)
    error = verdict(robot, path, failure)
    assert isinstance(error, Disconnected)
    assert error.reason in error.detail
    if named:
        assert error.reason.startswith("j1 is at its limit (")
    else:
        assert error.reason.startswith("its branch ends (")
    least = np.linalg.svd(robot.jacobian(failure.q))[1][-1]
    assert f"the smallest singular value is {least:.2g}" in error.reason


def test_an_end_out_of_reach_is_missed_by_what_the_arm_lacks() -> None:
    robot, path = two_links(), path_of((0.5, 0.2), (0.6, 0.2), (1.1, 0.3))
    failure = lost_on(robot, path, 1.0)
    error = verdict(robot, path, failure)
    assert isinstance(error, Unreachable)
    assert error.waypoint == 1
    beyond = math.hypot(1.1, 0.3) - REACH
    assert error.position_error == pytest.approx(beyond, abs=1e-6)
    assert np.linalg.norm(tool(error.q) - [1.1, 0.3, 0.0]) == pytest.approx(
        error.position_error, rel=1e-9
    )
    assert f"{1e3 * beyond:.1f} mm" in error.detail
    assert f"{1e3 * failure.s:.1f} mm of {1e3 * path.length:.1f} mm along the path" in error.detail
    assert error.limits == []


def test_the_verdict_says_where_a_gap_in_the_reach_begins_and_how_wide_the_miss_is() -> None:
    """Past the base, nearer to it than the folded arm is long: the end is within reach."""
    elbow = 2.5
    robot, path = two_links(elbow=(-elbow, elbow)), path_of((0.5, 0.1), (-0.5, 0.1))
    nearest = math.sqrt(L1**2 + L2**2 + 2.0 * L1 * L2 * math.cos(elbow))
    begin = 0.5 - math.sqrt(nearest**2 - 0.1**2)
    error = verdict(robot, path, lost_on(robot, path, 1.0))
    assert isinstance(error, Unreachable)
    assert error.target is not None
    target = np.array(error.target["position"])
    assert begin < 0.5 - target[0] < begin + 0.02 * path.length + 1e-3
    assert target[1] == pytest.approx(0.1)
    missed = nearest - np.linalg.norm(target)
    assert error.position_error == pytest.approx(missed, abs=1e-6)
    assert np.linalg.norm(tool(error.q) - target) == pytest.approx(error.position_error, rel=1e-9)
    assert error.limits == ["j2"]
    assert "the path to waypoint 0" in error.detail


@pytest.mark.parametrize("row", [0, 1])
def test_the_verdict_names_the_joint_that_jumps_how_far_and_the_waypoints_beside_it(
    row: int,
) -> None:
    robot, path = two_links(), path_of((0.5, 0.2), (0.6, 0.2), (0.6, -0.2))
    s = (0.03, 0.3)[row]
    here = path.pose(s)[1]
    q, beyond = joints(here, 1.0), joints(here, -1.0)
    error = verdict(robot, path, TrackingFailed(s, q, beyond))
    assert isinstance(error, Disconnected)
    gap = beyond - q
    joint = int(np.argmax(np.abs(gap)))
    assert error.jump == pytest.approx(np.abs(gap).max(), rel=1e-12)
    assert f"{robot.joint_names[joint]} {gap[joint]:+.3f} rad away" in error.detail
    assert error.waypoints == [row - 1, row]
    assert error.q == q.tolist()
    assert f"gets to {1e3 * s:.1f} mm of 500.0 mm along the path" in error.detail


@pytest.mark.parametrize(("short", "held"), [(2e-3, False), (5e-5, True)])
def test_by_a_singular_configuration_only_a_limit_that_is_reached_is_named(
    short: float, held: bool
) -> None:
    """With its wrist straight the next motion has no bounds, and so no say in which limit holds."""
    robot = load_robot("ur5")
    q = np.array([0.3, -1.2, 1.5, -0.4, 1e-3, robot.upper[5] - short])
    T, J = robot.fk(q), robot.jacobian(q)
    U, values, _ = np.linalg.svd(J)
    lost_direction = U[:3, -1] / np.linalg.norm(U[:3, -1])
    next_motion = np.linalg.pinv(J) @ [*lost_direction * 0.1 / 4096.0, 0.0, 0.0, 0.0]
    assert next_motion[5] > 2e-3
    goal = pose(T.act(0.1 * lost_direction), pin.log3(T.rotation))
    path = through([goal], "line", Pose(T.rotation, T.translation))
    tracker = replace(tracker_of(robot), oriented=True)
    error = explain_tracking_failure(robot, solver_of(robot), tracker, path, TrackingFailed(0.0, q))
    assert isinstance(error, Disconnected)
    near = f"the smallest singular value is {values[-1]:.2g}"
    singular = f"it is singular: {near}"
    assert error.reason == (f"wrist_3_joint is at its limit ({near})" if held else singular)


@pytest.mark.parametrize("limit", [0.2, 0.5])
def test_the_limit_where_the_led_arm_is_lost_is_the_one_that_binds(limit: float) -> None:
    """Led on until its shoulder is at its limit, in closed form; the other branch goes on."""
    path = path_of((0.5, -0.4), (0.45, 0.35))
    s = np.linspace(0.0, path.length, 20_001)
    shoulder = joints(path.poses(s)[1], -1.0)[:, 0]
    assert joints(path.poses(s)[1], 1.0)[:, 0].max() < limit < shoulder.max()
    end = float(s[int(np.argmax(shoulder > limit))])
    robot = two_links(shoulder=(-3.1, limit))
    failure = lost_on(robot, path, -1.0)
    assert failure.s == pytest.approx(end, abs=1e-3)
    error = verdict(robot, path, failure)
    assert isinstance(error, Disconnected)
    assert error.reason.startswith("j1 is at its limit (")


def test_the_jump_leads_to_another_branch_and_not_a_little_farther_on_this_one() -> None:
    """TrackingFailed 2 thousandths of the path before its branch ends."""
    path = path_of((0.5, -0.4), (0.45, 0.35))
    s = np.linspace(0.0, path.length, 20_001)
    shoulder = joints(path.poses(s)[1], -1.0)[:, 0]
    end = float(s[int(np.argmax(shoulder > 0.2))])
    at = end - 2e-3 * path.length
    here = path.pose(at)[1]
    q = joints(here, -1.0)
    error = verdict(two_links(shoulder=(-3.1, 0.2)), path, TrackingFailed(at, q))
    assert isinstance(error, Disconnected)
    assert error.jump == pytest.approx(np.abs(joints(here, 1.0) - q).max(), rel=0.05)


OUT = {1: math.hypot(1.0, 0.5) - REACH, 4: 1.3 - REACH}
"""Out of reach, and by how much; one more is by less than the tolerance."""


@pytest.mark.parametrize("elongation", ["global", "greedy"])
def test_a_waypoint_out_of_reach_by_less_than_the_tolerance_is_met_as_well_as_can_be(
    elongation: Elongation,
) -> None:
    problem = problem_of(two_links())
    near = replace(problem, targets=[problem.targets[k] for k in (0, 3, 5)])
    q = select_configurations(near, IkOptions(method="lm", elongation=elongation))
    missed = np.linalg.norm(tool(q)[:, :2] - [WAYPOINTS[k] for k in (0, 3, 5)], axis=1)
    np.testing.assert_allclose(missed, [0.0, 5e-5, 0.0], atol=1e-8)
    with pytest.raises(Unreachable) as caught:
        select_configurations(
            replace(near, tolerance=Tolerance(position=4e-5)),
            IkOptions(method="lm", elongation=elongation),
        )
    assert caught.value.position_error == pytest.approx(5e-5, abs=1e-8)


@pytest.mark.parametrize("elongation", ["global", "greedy"])
@pytest.mark.parametrize(("explain", "first_row"), [(True, 0), (True, 7), (False, 0)])
def test_the_verdict_lists_every_waypoint_out_of_reach_with_its_distance(
    explain: bool, first_row: int, elongation: Elongation
) -> None:
    problem = problem_of(two_links(), explain=explain, first_row=first_row)
    with pytest.raises(Unreachable) as caught:
        select_configurations(problem, IkOptions(method="lm", elongation=elongation))
    error = caught.value
    out = dict(list(OUT.items())[:1] if not explain else OUT)
    assert [row["waypoint"] for row in error.waypoints] == [first_row + k for k in out]
    for row, (k, beyond) in zip(error.waypoints, out.items(), strict=True):
        assert row["position_error"] == pytest.approx(beyond, abs=1e-6)
        np.testing.assert_allclose(row["target"]["position"][:2], WAYPOINTS[k])
    assert error.waypoint == first_row + 1
    assert error.position_error == error.waypoints[0]["position_error"]
    missed = np.linalg.norm(tool(error.q) - [*WAYPOINTS[1], 0.0])
    assert missed == pytest.approx(error.position_error, rel=1e-9)
    also = f", as is {first_row + 4}," if explain else ""
    assert f"waypoint {first_row + 1} of {first_row + 6} (counted from 0){also}" in error.detail
