"""Led along a whole path from several starts: the way that moves least, or where it was failure."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from ikplan.documents.poses import Tolerance
from ikplan.joint_path import JointPath
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom
from ikplan.limits import JointLimits
from ikplan.path import Pose, ToolPath
from ikplan.planning.tracking import path_tracker
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.track_from import first_points
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.robots import load_robot
from ikplan.time_budget import TimeBudget
from tests.measured import off_polyline
from tests.path.requests import pose, through
from tests.planning.planar import L1, L2, REACH, Polyline, joints, line, tool, tracker_of, two_links


def starts(guide: Polyline) -> np.ndarray:
    """Both branches of the arm at the begin of a path."""
    return np.array([joints(guide.points[0], elbow) for elbow in (1.0, -1.0)])


def motion(guide: Polyline, elbow: float) -> float:
    """Joint motion along a path on one branch, in closed form on fine steps."""
    _, p = guide.poses(np.linspace(0.0, guide.length, 20_001))
    return float(np.linalg.norm(np.diff(joints(p, elbow), axis=0), axis=1).sum())


GUIDE = line((0.3, 0.4), (0.7, 0.1), (0.5, -0.3))


def test_the_follower_takes_the_way_that_moves_the_joints_least() -> None:
    lengths = [motion(GUIDE, elbow) for elbow in (1.0, -1.0)]
    short = int(np.argmin(lengths))
    assert abs(lengths[0] - lengths[1]) > 0.05
    for both in (0.0, 0.5):
        tracked = tracker_of(two_links()).track(GUIDE, starts(GUIDE), np.full(2, both))
        assert np.sign(tracked.q[:, 1]).tolist() == [1.0 - 2.0 * short] * len(tracked.s)
        assert tracked.length == pytest.approx(both + lengths[short], rel=1e-3)
    # What it costs to get to the begin of the shorter way may be more than it saves.
    costs = np.zeros(2)
    costs[short] = 1.1 * abs(lengths[0] - lengths[1])
    tracked = tracker_of(two_links()).track(GUIDE, starts(GUIDE), costs)
    assert tracked.length == pytest.approx(lengths[1 - short], rel=1e-3)
    np.testing.assert_allclose(tracked.q[0], starts(GUIDE)[1 - short])


def test_the_points_are_on_the_path_and_name_its_waypoints_and_rests() -> None:
    tracker = tracker_of(two_links())
    tracked = tracker.track(GUIDE, starts(GUIDE), np.zeros(2))
    _, p = GUIDE.poses(tracked.s)
    np.testing.assert_allclose(tool(tracked.q), p, atol=1e-9)
    assert tracked.s[0] == 0.0
    assert tracked.s[-1] == GUIDE.length
    assert (np.diff(tracked.s) > 0.0).all()
    np.testing.assert_allclose(tracked.s[tracked.waypoint], GUIDE.waypoint_s, atol=1e-12)
    np.testing.assert_allclose(tracked.s[tracked.rest], GUIDE.corners, atol=1e-12)
    assert tracker.clock.evaluations > len(tracked.s)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_the_joint_spline_through_the_points_is_on_the_path(tolerance: float) -> None:
    robot = two_links()
    tracked = tracker_of(robot, tolerance).track(GUIDE, starts(GUIDE), np.zeros(2))
    path = JointPath.through(tracked.q, JointLimits.from_robot(robot), rest_at=tracked.rest)
    p = tool(path(np.linspace(0.0, path.length, 5001)))
    assert off_polyline(p, GUIDE.points).max() <= tolerance


def test_where_the_reach_ends_the_arm_is_lost_stretched() -> None:
    guide = line((0.5, 0.2), (1.1, 0.2))
    end = math.sqrt(REACH**2 - 0.2**2) - 0.5
    with pytest.raises(TrackingFailed) as caught:
        tracker_of(two_links()).track(guide, starts(guide), np.zeros(2))
    failure = caught.value
    assert end - 2e-4 <= failure.s <= end
    np.testing.assert_allclose(tool(failure.q), guide.poses(np.array([failure.s]))[1][0], atol=1e-9)
    assert abs(failure.q[1]) < 0.05
    assert failure.beyond is None


def test_lost_names_the_start_that_gets_farthest() -> None:
    """With its elbow down the shoulder has to go farther round, and meets its limit earlier."""
    guide = line((0.5, -0.4), (0.3, 0.7))
    _, p = guide.poses(s := np.linspace(0.0, guide.length, 20_001))
    shoulder = np.array([joints(p, elbow)[:, 0] for elbow in (1.0, -1.0)])
    limit = 0.35
    ends = [
        s[int(np.argmax(row > limit))] if (row > limit).any() else guide.length for row in shoulder
    ]
    robot = two_links(shoulder=(-2.9, limit))
    assert max(ends) < guide.length
    assert abs(ends[0] - ends[1]) > 0.05
    for order in (slice(None), slice(None, None, -1)):
        tracker = tracker_of(robot)
        with pytest.raises(TrackingFailed) as caught:
            tracker.track(guide, starts(guide)[order], np.zeros(2))
        failure = caught.value
        assert failure.s == pytest.approx(max(ends), abs=2e-3)
        assert failure.s <= max(ends) + 1e-9
        assert failure.q[0] == pytest.approx(limit, abs=0.01)
        assert tracker.clock.evaluations > 0


@pytest.mark.parametrize("elbow", [2.9, 2.5])
def test_past_the_base_the_arm_is_lost_where_its_elbow_is_at_its_limit(elbow: float) -> None:
    guide = line((0.4, 0.05), (-0.4, 0.05))
    nearest = math.sqrt(L1**2 + L2**2 + 2.0 * L1 * L2 * math.cos(elbow))
    end = 0.4 - math.sqrt(nearest**2 - 0.05**2)
    with pytest.raises(TrackingFailed) as caught:
        tracker_of(two_links(elbow=(-elbow, elbow))).track(guide, starts(guide), np.zeros(2))
    assert end - 2e-3 <= caught.value.s <= end + 1e-9
    assert abs(caught.value.q[1]) == pytest.approx(elbow, abs=0.01)


def test_an_arm_without_self_motion_has_no_way_to_choose() -> None:
    with pytest.raises(TrackingFailed) as caught:
        tracker_of(two_links()).track_global(GUIDE, starts(GUIDE), np.zeros(2))
    assert caught.value.s == 0.0
    np.testing.assert_array_equal(caught.value.q, starts(GUIDE)[0])


def seven_joints(step: list[float]) -> tuple[PathTracker, ToolPath, np.ndarray]:
    """A redundant arm, a line by a step [m], and its begin."""
    robot = load_robot("iiwa14")
    arm, limits = arm_of(robot), JointLimits.from_robot(robot)
    tracker = PathTracker(arm, limits, no_freedom(), True, Tolerance(), TimeBudget(1e6))
    q0 = np.array([0.3, 0.7, 0.2, -1.4, 0.2, 0.9, 0.4])
    T = robot.fk(q0)
    goal = pose(T.translation + np.array(step), pin.log3(T.rotation))
    return tracker, through([goal], "line", Pose(T.rotation, T.translation)), q0


def test_a_way_chosen_over_all_points_is_on_the_path_and_within_the_limits() -> None:
    robot = load_robot("iiwa14")
    tracker, path, q0 = seven_joints([0.1, -0.1, 0.05])
    tracked = tracker.track_global(path, q0[None], np.zeros(1))
    assert tracker.clock.evaluations > len(tracked.s)
    np.testing.assert_array_equal(tracked.q[0], q0)
    R, p = path.poses(tracked.s)
    R_have, p_have = robot.poses(tracked.q)
    np.testing.assert_allclose(p_have, p, atol=1e-8)
    np.testing.assert_allclose(R_have, R, atol=1e-8)
    assert ((robot.lower <= tracked.q) & (tracked.q <= robot.upper)).all()


def test_there_is_no_way_to_choose_on_a_path_out_of_reach() -> None:
    tracker, path, q0 = seven_joints([3.0, 0.0, 0.0])
    with pytest.raises(TrackingFailed) as caught:
        tracker.track_global(path, q0[None], np.zeros(1))
    assert caught.value.s == 0.0
    assert tracker.clock.evaluations > 0


def test_what_ways_that_were_lost_took_counts_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both ways of the first steps are failure between their points: smaller steps are tried."""
    once, tracker = tracker_of(two_links()), tracker_of(two_links())
    plain = once.track(GUIDE, starts(GUIDE), np.zeros(2))
    left = [10**6, 10**6]

    def losing(arm: Any, guide: Any, s: np.ndarray, q: np.ndarray, windows: Any) -> Any:
        if left:
            arm.clock.count(left.pop())
            raise TrackingFailed(0.1, q[0])
        return densify(arm, guide, s, q, windows)

    monkeypatch.setattr(path_tracker, "densify", losing)
    tracked = tracker.track(GUIDE, starts(GUIDE), np.zeros(2))
    assert tracker.clock.evaluations > 2 * 10**6 + once.clock.evaluations
    assert tracked.length == pytest.approx(plain.length, rel=1e-3)


@pytest.mark.parametrize("target", [[0.1, -0.1, 0.05], [-0.3, 0.3, -0.3]])
def test_a_shortened_way_is_as_long_as_it_says(target: list[float]) -> None:
    """Ways compete by their lengths once they are shortened, not by those before."""
    tracker, path, q0 = seven_joints(target)
    tracked = tracker.track(path, q0[None], np.zeros(1))
    length = float(np.linalg.norm(np.diff(tracked.q, axis=0), axis=1).sum())
    assert tracked.length == pytest.approx(length, rel=1e-3)
    before = tracker._track_from(path, q0, first_points(tracker, path, 0.04))[1]
    assert tracked.length < float(np.linalg.norm(np.diff(before, axis=0), axis=1).sum())
