"""Segments, freedoms and laws of whole plans, seen by Pinocchio."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InvalidRequest, Plan, load_robot
from tests.measured import check_motion, off_polyline

UR5_START = [0.4, -1.2, 1.5, -0.8, -1.2, 0.3]


def pose(T: pin.SE3) -> dict[str, Any]:
    x = pin.SE3ToXYZQUAT(T).tolist()
    return {"position": x[:3], "quaternion_xyzw": x[3:]}


def shifted(T: pin.SE3, by: list[float], turn: tuple[float, ...] = (0.0, 0.0, 0.0)) -> pin.SE3:
    return pin.SE3(T.rotation @ pin.exp3(np.array(turn)), T.translation + np.array(by))


def planned(name: str, start: Any, path: dict[str, Any], **more: Any) -> Plan:
    return ikplan.plan({"robot": name, "start": start, "path": path, **more})


@functools.cache
def ur5_begin() -> pin.SE3:
    return load_robot("ur5").fk(UR5_START)


def ur5_line(*by: list[float], start: Any = None, **path: Any) -> Plan:
    waypoints = [pose(shifted(ur5_begin(), d)) for d in by]
    return planned(
        "ur5", start or UR5_START, {"waypoints": waypoints, "interpolation": "line", **path}
    )


def tool_poses(plan: Plan) -> list[pin.SE3]:
    robot = load_robot(plan.robot)
    return [robot.fk(q) for q in plan.q]


def test_the_tool_stays_on_its_line_on_every_sample() -> None:
    plan = ur5_line([0.1, 0.05, 0.08])
    begin, d = ur5_begin(), np.array([0.1, 0.05, 0.08])
    u = d / np.linalg.norm(d)
    worst = 0.0
    for T in tool_poses(plan):
        r = T.translation - begin.translation
        worst = max(worst, float(np.linalg.norm(r - (r @ u) * u)))
        assert np.linalg.norm(pin.log3(T.rotation.T @ begin.rotation)) < 1e-3
    assert worst <= 1e-4
    assert plan.certificate.max_path_deviation == pytest.approx(worst, abs=1e-7)


def sinusoid(length: float, tolerance: float, **wave: float) -> Plan:
    path = {
        "frame": {"position": [0.4, 0.1, 0.3], "quaternion_xyzw": [1, 0, 0, 0]},
        "begin": {"position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]},
        "segments": [{"type": "sinusoid", "length": length, **wave}],
        "tolerance": {"position": tolerance},
    }
    return planned("ur5", "free", path)


@pytest.mark.parametrize("wavelength", [1e-3, 7e-4, 3e-4])
@pytest.mark.parametrize("tolerance", [1e-4, 2e-5])
def test_bends_sharper_than_the_tolerance_are_kept_to_with_a_margin(
    wavelength: float, tolerance: float
) -> None:
    plan = sinusoid(10 * wavelength, tolerance, amplitude=0.01, wavelength=wavelength)
    assert plan.certificate.max_path_deviation is not None
    assert 0.1 * tolerance < plan.certificate.max_path_deviation < 0.6 * tolerance


def test_a_path_too_intricate_to_keep_to_is_refused_with_what_would_help() -> None:
    with pytest.raises(InvalidRequest, match="allow more, or send the path in parts") as caught:
        sinusoid(0.2, 1e-7, amplitude=0.005, wavelength=1e-3)
    assert caught.value.field == "path.tolerance"


def test_all_segments_in_one_path() -> None:
    robot, T = load_robot("ur5"), ur5_begin()
    q = np.add(UR5_START, [0.1, 0.05, -0.05, 0.0, 0.1, 0.0])
    p = T.translation
    segments = [
        {"type": "line", "to": pose(shifted(T, [0.0, 0.06, 0.0]))},
        {"type": "arc", "via": np.add(p, [0.03, 0.09, 0.0]).tolist(),
         "to": pose(shifted(T, [0.06, 0.06, 0.0], (0.0, 0.2, 0.1)))},
        {"type": "spline", "through": [pose(shifted(T, [0.06, 0.02, 0.03])),
                                       pose(shifted(T, [0.02, 0.0, 0.05]))]},
        {"type": "joint", "q": q.tolist()},
        {"type": "helix", "radius": 0.03, "rise": 0.04, "turns": 1.0,
         "frame": {"position": (robot.fk(q).translation - [0.03, 0, 0]).tolist()}},
        {"type": "circle", "radius": 0.03, "frame": {"position": p.tolist()}},
    ]  # fmt: skip
    plan = planned("ur5", UR5_START, {"segments": segments, "corners": "exact"})
    check_motion(plan.trajectory, robot)
    corners = [p, np.add(p, [0.0, 0.06, 0.0]), np.add(p, [0.06, 0.06, 0.0])]
    reached = [robot.fk(plan.waypoints.q[k]).translation for k in range(4)]
    through = [*corners[1:], *(np.add(p, d) for d in ([0.06, 0.02, 0.03], [0.02, 0.0, 0.05]))]
    np.testing.assert_allclose(reached, through, atol=1e-8)
    # The arc is the half circle of 30 mm about the middle between its ends.
    points, time = robot.poses(plan.q)[1], plan.waypoints.time
    assert off_polyline(points[plan.time <= time[0]], corners[:2]).max() <= 1e-4
    on_arc = points[(plan.time >= time[0]) & (plan.time <= time[1])] - np.mean(corners[1:], axis=0)
    assert np.abs(np.linalg.norm(on_arc, axis=1) - 0.03).max() <= 1e-4
    assert np.abs(on_arc[:, 2]).max() <= 1e-4
    np.testing.assert_allclose(plan.waypoints.q[4], q, atol=1e-12)
    at_q = int(np.argmin(np.abs(plan.time - plan.waypoints.time[4])))
    np.testing.assert_allclose(plan.q[at_q], q, atol=0.02)


def test_an_exact_corner_stops_and_a_rounded_one_does_not() -> None:
    corner = [0.08, 0.0, 0.0], [0.08, 0.08, 0.0]
    exact, rounded = ur5_line(*corner, blend=0.0), ur5_line(*corner, blend=0.02)
    speed = {}
    for name, plan in (("exact", exact), ("rounded", rounded)):
        near = np.abs(plan.time - plan.waypoints.time[0]) < 0.003
        speed[name] = np.abs(plan.dq[near]).max(axis=1).min()
    assert speed["exact"] < 0.1
    assert speed["rounded"] > 0.3
    assert rounded.duration < exact.duration
    assert exact.waypoints.position_error[0] <= 1e-8
    assert 1e-4 < rounded.waypoints.position_error[0] <= 0.02


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_free_axis_points_where_it_is_asked_to_and_saves_motion(axis: int) -> None:
    goal = shifted(ur5_begin(), [0.08, 0.05, 0.05], (0.5, 0.4, 0.6))
    path = {"waypoints": [pose(goal)], "interpolation": "line"}
    full = planned("ur5", UR5_START, path)
    about = {"about": ("tool_x", "tool_y", "tool_z")[axis]}
    free = planned("ur5", UR5_START, {**path, "orientation_free": about})
    assert free.certificate.elongation_sum < full.certificate.elongation_sum
    end = load_robot("ur5").fk(free.q[-1])
    np.testing.assert_allclose(end.rotation[:, axis], goal.rotation[:, axis], atol=1e-7)
    np.testing.assert_allclose(end.translation, goal.translation, atol=1e-8)
    # All along, the axis is that of the rotation interpolated along the shortest arc.
    turn = pin.log3(ur5_begin().rotation.T @ goal.rotation)
    d = goal.translation - ur5_begin().translation
    for T in tool_poses(free)[::5]:
        u = (T.translation - ur5_begin().translation) @ d / (d @ d)
        wanted = (ur5_begin().rotation @ pin.exp3(u * turn))[:, axis]
        assert math.acos(min(1.0, T.rotation[:, axis] @ wanted)) < 2e-3


def test_a_cone_is_kept_and_saves_more_the_wider_it_is() -> None:
    goal = shifted(ur5_begin(), [0.05, 0.05, 0.0], (0.6, 0.3, 0.0))
    lengths = []
    for cone in (None, 0.1, 0.3):
        free = {"about": "tool_z", "cone": cone}
        path = {"waypoints": [pose(goal)], "orientation_free": free}
        plan = planned("ur5", UR5_START, path)
        z = load_robot("ur5").fk(plan.q[-1]).rotation[:, 2]
        assert math.acos(min(1.0, z @ goal.rotation[:, 2])) <= (cone or 0.0) + 1e-6
        lengths.append(plan.certificate.elongation_sum)
    assert lengths[0] > lengths[1] > lengths[2]


@pytest.mark.parametrize("frame", ["tool", "path"])
def test_a_box_is_kept_in_its_frame_and_saves_motion(frame: str) -> None:
    goal = shifted(ur5_begin(), [0.06, 0.06, 0.03], (0.2, 0.1, 0.4))
    half = np.array([0.01, 0.0, 0.02])
    box = {"position": half.tolist(), "orientation": [0.0, 0.0, 0.2], "frame": frame}
    exact = planned("ur5", UR5_START, {"waypoints": [pose(goal)]})
    plan = planned("ur5", UR5_START, {"waypoints": [pose(goal)], "tolerance": {"box": box}})
    assert plan.certificate.elongation_sum < exact.certificate.elongation_sum
    T = load_robot("ur5").fk(plan.q[-1])
    apart = T.translation - goal.translation
    turn = goal.rotation @ pin.log3(goal.rotation.T @ T.rotation)
    if frame == "tool":
        apart, turn = goal.rotation.T @ apart, goal.rotation.T @ turn
    assert (np.abs(apart) <= half + 1e-7).all()
    assert (np.abs(turn) <= np.array([0.0, 0.0, 0.2]) + 1e-7).all()


@pytest.mark.parametrize("name", ["ur5", "tiago", "dobot_magician", "iiwa14"])
def test_positions_alone_along_a_line(name: str) -> None:
    robot = load_robot(name)
    start = np.array(robot.home)
    begin = robot.fk(start).translation
    goal = robot.fk(robot.clip(start + 0.15)).translation
    path = {"waypoints": [{"position": goal.tolist()}], "interpolation": "line",
            "orientation_free": "all"}  # fmt: skip
    plan = planned(name, start.tolist(), path)
    d = goal - begin
    for T in tool_poses(plan)[::3]:
        r = T.translation - begin
        assert np.linalg.norm(r - (r @ d) / (d @ d) * d) <= 1e-4
    assert plan.certificate.max_orientation_deviation is None


def test_splitting_a_line_in_two_changes_nothing_beyond_tolerance() -> None:
    d = np.array([0.12, 0.06, 0.04])
    whole, split = ur5_line(d.tolist()), ur5_line((0.37 * d).tolist(), d.tolist())
    np.testing.assert_allclose(split.q[-1], whole.q[-1], atol=1e-7)
    assert split.duration == pytest.approx(whole.duration, rel=0.02)


def test_reversing_waypoints_reverses_the_motion_when_the_start_is_free() -> None:
    robot = load_robot("iiwa14")
    rng = np.random.default_rng(6)
    q, poses = np.array(robot.home), []
    for _ in range(6):
        q = robot.clip(q + rng.uniform(-0.3, 0.3, 7))
        poses.append(pose(robot.fk(q)))
    there = planned("iiwa14", "free", {"waypoints": poses})
    back = planned("iiwa14", "free", {"waypoints": poses[::-1]})
    assert back.certificate.elongation_sum == pytest.approx(
        there.certificate.elongation_sum, rel=5e-3
    )


def test_a_free_start_is_never_worse_than_the_best_given_one() -> None:
    waypoints = [pose(shifted(ur5_begin(), d)) for d in ([0.0, 0.0, 0.0], [0.1, 0.05, 0.0])]
    given = planned("ur5", UR5_START, {"waypoints": waypoints, "interpolation": "line"})
    free = planned("ur5", "free", {"waypoints": waypoints, "interpolation": "line"})
    motion = [
        np.linalg.norm(np.diff(np.array(p.waypoints.q), axis=0), axis=1).sum()
        for p in (free, given)
    ]
    assert motion[0] <= motion[1] * (1.0 + 1e-6)


def test_moving_the_frame_with_the_path_changes_no_line() -> None:
    pin.seed(3)
    frame = pin.SE3.Random()
    goal = shifted(ur5_begin(), [0.1, 0.05, 0.0], (0.0, 0.2, 0.1))
    plain = planned("ur5", UR5_START, {"waypoints": [pose(goal)], "interpolation": "line"})
    path = {"frame": pose(frame), "waypoints": [pose(frame.actInv(goal))],
            "interpolation": "line"}  # fmt: skip
    moved = planned("ur5", UR5_START, path)
    assert moved.duration == pytest.approx(plain.duration, rel=1e-6)
    np.testing.assert_allclose(moved.q[-1], plain.q[-1], atol=1e-7)


def test_the_same_line_gives_the_same_bytes() -> None:
    a, b = ur5_line([0.1, 0.0, 0.05]), ur5_line([0.1, 0.0, 0.05])
    assert a.model_dump_json(exclude={"stats"}) == b.model_dump_json(exclude={"stats"})


def test_a_line_may_be_approached_from_where_it_begins() -> None:
    begin = ur5_begin()
    plan = ur5_line([0.0, 0.0, 0.0], [0.05, 0.0, 0.05], approach="joint")
    np.testing.assert_allclose(plan.waypoints.q[0], UR5_START, atol=1e-9)
    end = load_robot("ur5").fk(plan.waypoints.q[1]).translation - begin.translation
    np.testing.assert_allclose(end, [0.05, 0.0, 0.05], atol=1e-4)


@pytest.mark.parametrize("start", [None, "free"])
@pytest.mark.parametrize("interpolation", ["line", "spline"])
@pytest.mark.parametrize("oriented", [(0, 0, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 0, 0, 1, 0)])
def test_orientations_are_met_where_they_are_asked_for(
    oriented: tuple[int, ...], interpolation: str, start: str | None
) -> None:
    robot = load_robot("panda")
    rng = np.random.default_rng(5)
    wanted = [robot.fk(robot.home + 0.15 * rng.normal(size=7)) for _ in oriented]
    waypoints = [pose(T) for T in wanted]
    for waypoint, turns in zip(waypoints, oriented, strict=True):
        if not turns:
            del waypoint["quaternion_xyzw"]
    plan = planned("panda", start, {"waypoints": waypoints, "interpolation": interpolation})
    for q, T, turns in zip(plan.waypoints.q, wanted, oriented, strict=True):
        off = robot.fk(q).actInv(T)
        assert np.linalg.norm(off.translation) <= 1e-4
        assert not turns or np.linalg.norm(pin.log3(off.rotation)) <= 1e-3


def test_a_way_to_an_orientation_turns_evenly_to_it() -> None:
    robot = load_robot("panda")
    begin = robot.fk(robot.home)
    through, end = shifted(begin, [0.0, 0.1, 0.0]), shifted(begin, [0.0, 0.2, 0.0], (0.4, 0.0, 0.0))
    waypoints = [{"position": through.translation.tolist()}, pose(end)]
    plan = planned("panda", None, {"waypoints": waypoints, "interpolation": "line"})
    half = robot.fk(plan.waypoints.q[0])
    np.testing.assert_allclose(pin.log3(begin.rotation.T @ half.rotation), [0.2, 0, 0], atol=2e-3)


def test_a_spline_does_not_rest_where_an_orientation_begins_to_count() -> None:
    robot = load_robot("panda")
    rng = np.random.default_rng(0)
    waypoints = [pose(robot.fk(robot.home + 0.15 * rng.normal(size=7))) for _ in range(5)]
    for k in (1, 3):
        del waypoints[k]["quaternion_xyzw"]
    plan = planned("panda", None, {"waypoints": waypoints, "interpolation": "spline"})
    speed = np.abs(plan.dq).max(axis=1)
    for time in plan.waypoints.time[:-1]:
        assert np.interp(time, plan.time, speed) > 0.1
