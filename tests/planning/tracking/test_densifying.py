"""Points are added where the joint spline between them leaves the path, and nowhere else."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ikplan.documents.poses import Tolerance
from ikplan.joint_path import JointPath
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom
from ikplan.limits import JointLimits
from ikplan.path import Pose
from ikplan.planning.tracking.densify import densify
from ikplan.planning.tracking.path_deviation import deviation_ratios
from ikplan.planning.tracking.reference_path import initial_points, rest_points
from ikplan.planning.tracking.tracked_arm import TrackedArm
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.robots import load_robot
from ikplan.time_budget import TimeBudget
from tests.measured import off_polyline
from tests.path.requests import pose, through
from tests.planning.planar import Polyline, joints, line, tool, tracker_of, two_links

ROBOT = two_links()
GUIDE = line((0.3, 0.4), (0.7, 0.1), (0.5, -0.3))


def spline(guide: Polyline, s: np.ndarray, q: np.ndarray) -> JointPath:
    return JointPath.through(q, JointLimits.from_robot(ROBOT), rest_at=rest_points(guide, s))


def points(guide: Polyline, step: float, elbow: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    s = initial_points(guide, step)
    return s, joints(guide.poses(s)[1], elbow)


def off_between(guide: Polyline, s: np.ndarray, path: JointPath, each: int = 201) -> np.ndarray:
    """Largest distance from the path between each two points, in closed form, densely [m]."""
    off = []
    for k, (a, b) in enumerate(zip(path.s_waypoints[:-1], path.s_waypoints[1:], strict=True)):
        p = tool(path(np.linspace(a, b, each)))
        corners = guide.poses(s[k : k + 2])[1]
        off.append(off_polyline(p, corners).max())
    return np.array(off)


@pytest.mark.parametrize("elbow", [1.0, -1.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5, 1e-6])
def test_the_joint_spline_keeps_to_the_path(tolerance: float, elbow: float) -> None:
    s, q = points(GUIDE, 0.2, elbow)
    tracker = tracker_of(ROBOT, tolerance)
    dense, q_dense, rest = densify(tracker, GUIDE, s, q)
    assert np.isin(s, dense).all()
    assert (np.diff(dense) > 0.0).all()
    np.testing.assert_allclose(q_dense, joints(GUIDE.poses(dense)[1], elbow), atol=1e-7)
    np.testing.assert_array_equal(dense[rest], GUIDE.corners)
    path = spline(GUIDE, dense, q_dense)
    # Half of the tolerance is for the path between points, the other half in reserve.
    assert off_between(GUIDE, dense, path).max() <= 0.51 * tolerance
    assert tracker.clock.evaluations > len(dense)


def test_points_are_added_where_they_are_needed_only() -> None:
    s, q = points(GUIDE, 0.2)
    off = off_between(GUIDE, s, spline(GUIDE, s, q))
    tolerance = 2.0 * float(np.sort(off)[-2]) / 0.99
    assert off.max() > 0.5 * tolerance
    dense, *_ = densify(tracker_of(ROBOT, tolerance), GUIDE, s, q)
    added = np.setdiff1d(dense, s)
    worst = int(np.argmax(off))
    assert len(added) >= 1
    # The spline changes beside a new point too, but not at the other end of the path.
    assert (np.abs(added - 0.5 * (s[worst] + s[worst + 1])) <= np.ptp(s[worst : worst + 2])).all()


def test_no_point_is_added_to_a_path_that_is_kept_to() -> None:
    s, q = points(GUIDE, 0.2)
    off = off_between(GUIDE, s, spline(GUIDE, s, q)).max()
    dense, q_dense, rest = densify(tracker_of(ROBOT, 2.2 * float(off)), GUIDE, s, q)
    np.testing.assert_array_equal(dense, s)
    np.testing.assert_array_equal(q_dense, q)
    assert rest == rest_points(GUIDE, s)


def test_more_exact_means_more_points_by_the_fourth_root() -> None:
    """A cubic spline's error goes with the fourth power of the spacing."""
    counts = []
    for tolerance in (1e-3, 1e-5, 1e-7):
        s, q = points(GUIDE, 0.2)
        counts.append(len(densify(tracker_of(ROBOT, tolerance), GUIDE, s, q)[0]))
    for few, many in itertools.pairwise(counts):
        assert 2.0 < many / few < 6.0


def test_a_jump_between_two_points_is_lost_with_both_its_sides() -> None:
    s, q = points(GUIDE, 0.05)
    k = len(s) // 3
    q[k + 1 :] = joints(GUIDE.poses(s[k + 1 :])[1], -1.0)
    with pytest.raises(TrackingFailed) as caught:
        densify(tracker_of(ROBOT), GUIDE, s, q)
    failure = caught.value
    assert s[k] <= failure.s <= s[k + 1]
    assert failure.beyond is not None
    here = GUIDE.poses(np.array([failure.s]))[1][0]
    np.testing.assert_allclose(tool(failure.q), here, atol=1e-8)
    np.testing.assert_allclose(tool(failure.beyond), here, atol=2e-6)
    assert np.sign([failure.q[1], failure.beyond[1]]).tolist() == [1.0, -1.0]
    np.testing.assert_allclose(failure.beyond, joints(here, -1.0), atol=1e-4)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-5, 1e-4, 1e-3]))
def test_what_strays_between_points_is_what_strays_densely(seed: int, tolerance: float) -> None:
    rng = np.random.default_rng(seed)
    angles, radii = rng.uniform(-1.2, 1.2, 3), rng.uniform(0.35, 0.8, 3)
    corners = zip(radii * np.cos(angles), radii * np.sin(angles), strict=True)
    guide = line(*((float(x), float(y)) for x, y in corners))
    _, dense = guide.poses(np.linspace(0.0, guide.length, 200))
    assume(np.linalg.norm(dense, axis=1).min() > 0.2)
    assume(np.diff([0.0, *guide.waypoint_s]).min() > 0.05)
    s, q = points(guide, 0.05)
    path = spline(guide, s, q)
    tracker = tracker_of(ROBOT, tolerance)
    chain = arm_of(ROBOT).chain
    shares, _ = deviation_ratios(
        chain, guide, lambda at: tracker.targets_at(guide, at), s, path, tracker.tolerance, 0.5,
        bounded=False,
    )  # fmt: skip
    want = off_between(guide, s, path) / tolerance
    assert shares.shape == want.shape
    assert (shares <= want * (1.0 + 1e-6) + 1e-6).all()
    # Eleven places find the largest of a cubic's bump to a few per cent; three, to a third.
    floor = 0.9 if shares.max() <= 0.5 else 0.6
    assert (shares >= floor * want - 1e-6).all()


@pytest.mark.parametrize("angle", [2e-4, 2e-3])
def test_a_tool_that_turns_aside_between_points_uses_up_its_orientation_tolerance(
    angle: float,
) -> None:
    """The joint path bulges by an angle of the last joint, which turns the tool on the spot."""
    robot = load_robot("ur5")
    q0 = np.array([0.4, -1.2, 1.5, -0.8, -1.2, 0.3])
    T = robot.fk(q0)
    here = Pose(T.rotation, T.translation)
    goal = pose(T.translation + np.array([0.0, 0.0, 1e-3]), pin.log3(T.rotation))
    guide = through([goal], "line", here)
    tolerance = Tolerance(position=1.0, orientation=1e-3)
    limits = JointLimits.from_robot(robot)
    arm = TrackedArm(arm_of(robot), limits, no_freedom(), True, tolerance, TimeBudget(1e6))
    q = np.array([q0, q0, q0])
    q[1, 5] += angle
    s = np.array([0.0, 0.5, 1.0]) * guide.length
    shares, _ = deviation_ratios(
        arm.arm.chain, guide, lambda at: arm.targets_at(guide, at), s,
        JointPath.through(q, limits), tolerance, 10.0, bounded=False,
    )  # fmt: skip
    np.testing.assert_allclose(shares, angle / 1e-3, rtol=1e-3)
