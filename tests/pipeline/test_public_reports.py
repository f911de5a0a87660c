"""Cases from public reports and from other planners' own tests, with the right value of each."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InvalidRequest, load_robot
from tests.measured import off_polyline

QUIET = {"self_collision": False}
DOWN = [1.0, 0.0, 0.0, 0.0]


def at(*position: float, turned: Any = DOWN) -> dict[str, Any]:
    return {"position": list(position), "quaternion_xyzw": turned}


def line(*position: float, turned: Any = DOWN, **more: Any) -> dict[str, Any]:
    return {"type": "line", "to": at(*position, turned=turned), **more}


def test_a_slow_line_from_home_is_planned() -> None:
    """JeanElsner/panda-py#10: 0.1 m ahead and down at a twentieth of the speed."""
    panda = load_robot("panda")
    T = panda.fk(panda.home)
    end = np.add(T.translation, [0.1, 0.0, -0.1]).tolist()
    request = {
        "robot": "panda",
        "path": {"segments": [line(*end)]},
        "limits": {"velocity_scale": 0.05, "jerk": False},
        "scene": QUIET,
        "sampling": {"rate_hz": 50},
    }
    plan = ikplan.plan(request)
    assert plan.certificate.velocity_limit_ratio <= 1.0 + 1e-9
    assert panda.fk(plan.q[-1]).translation == pytest.approx(end, abs=1e-6)


def test_a_sharp_corner_is_blended_within_its_ball() -> None:
    """ros-industrial/pilz_industrial_motion#84: the blend of a corner of 169 degrees."""
    corner = [0.6, 0.25, 0.3]
    for radius in (0.01, 0.04):
        path = {
            "begin": at(0.6, -0.25, 0.3),
            "segments": [line(*corner, blend=radius), line(0.6, -0.25, 0.4)],
        }
        request = {
            "robot": "ur10",
            "start": "free",
            "path": path,
            "limits": {"tool_speed": 0.25, "jerk": False},
            "scene": QUIET,
        }
        plan = ikplan.plan(request)
        exact = ikplan.plan({**request, "path": {**path, "corners": "exact", "segments": [
            line(*corner), line(0.6, -0.25, 0.4)]}})  # fmt: skip
        p = load_robot("ur10").poses(plan.q)[1]
        away = np.linalg.norm(p - corner, axis=1)
        assert away.min() <= radius
        off = off_polyline(p, [[0.6, -0.25, 0.3], corner, [0.6, -0.25, 0.4]])
        assert off[away > radius].max() <= 1e-4
        assert plan.duration <= exact.duration


def test_a_wound_up_wrist_unwinds_where_its_limit_is_in_the_way() -> None:
    """Universal_Robots_ROS_Driver#325: from 5.8 rad, a turn of 0.6 rad does not fit."""
    ur5 = load_robot("ur5")
    start = np.array([0.3, -1.2, 1.4, -1.8, -1.57, 5.8])
    end = np.add(start, [0.05, 0.0, 0.0, 0.0, 0.0, 0.6])
    T = ur5.fk(end)
    turned = pin.Quaternion(T.rotation).normalized().coeffs().tolist()
    path = {"waypoints": [at(*T.translation, turned=turned)]}
    plan = ikplan.plan({"robot": "ur5", "start": start.tolist(), "path": path, "scene": QUIET})
    assert (plan.q <= ur5.upper + 1e-9).all()
    met = ur5.fk(plan.q[-1])
    assert np.linalg.norm(pin.log6(met.actInv(T)).vector) < 1e-6
    unwound = end - [0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * np.pi]
    assert np.linalg.norm(plan.q[-1] - start) <= np.linalg.norm(unwound - start) + 1e-6


@pytest.mark.parametrize(
    ("rows", "acceleration"),
    [
        ([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [100.0] * 3),
        (np.linspace(-0.000385929168, 0.00116383433, 10)[:, None].repeat(3, 1), [1e3, 2e3, 1e4]),
        (np.linspace(-0.00038593, 0.00425594, 10)[:, None].repeat(3, 1), [100.0] * 3),
    ],
)
def test_straight_ways_take_the_time_of_the_bang_bang_motion(
    rows: Any, acceleration: list[float], tmp_path: Path
) -> None:
    """toppra's problem suite: 2 sqrt(d / a) of the slowest joint, also for tiny motions."""
    links = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k - 1}"/>'
        f'<child link="l{k}"/><origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-10" upper="10" velocity="100" effort="1"/></joint>'
        for k in (1, 2, 3)
    )
    file = tmp_path / "t.urdf"
    file.write_text(f'<robot name="t"><link name="l0"/>{links}</robot>')
    own = {f"j{k + 1}": {"acceleration": value} for k, value in enumerate(acceleration)}
    robot = load_robot(file, limits=own)
    plan = ikplan.time_path(robot, rows, rate_hz=10_000)
    moved = np.abs(np.array(rows)[-1] - np.array(rows)[0])
    exact = float((2.0 * np.sqrt(moved / np.array(acceleration))).max())
    # It ends at a sample, a period of 0.1 ms later at most.
    assert exact * (1.0 - 1e-9) <= plan.duration <= exact * 1.01 + 2e-4


@pytest.mark.parametrize(("away", "acceleration"), [(1e-5, 1e4), (1e-7, 1e3), (1e-3, 100.0)])
def test_a_tiny_way_and_back_takes_the_time_of_two_bang_bang_motions(
    away: float, acceleration: float, tmp_path: Path
) -> None:
    """toppra's problem suite, small_joint: to a waypoint where one joint turns back."""
    links = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k - 1}"/>'
        f'<child link="l{k}"/><origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>'
        '<limit lower="-10" upper="10" velocity="100" effort="1"/></joint>'
        for k in (1, 2, 3)
    )
    file = tmp_path / "t.urdf"
    file.write_text(f'<robot name="t"><link name="l0"/>{links}</robot>')
    own = {f"j{k}": {"acceleration": acceleration if k == 2 else 100.0} for k in (1, 2, 3)}
    robot = load_robot(file, limits=own)
    rows = [[0.0, 0.0, 0.0], [0.0, away, 0.0], [0.0, 0.0, 0.0]]
    plan = ikplan.time_path(robot, rows, rate_hz=10_000)
    exact = 4.0 * float(np.sqrt(away / acceleration))
    assert plan.certificate.valid
    # It ends at a sample, and has three of them at least.
    assert exact * (1.0 - 1e-9) <= plan.duration <= exact * 1.01 + 3e-4
    # It turns back between two samples.
    assert away - 0.5 * acceleration * 1e-4**2 <= np.abs(np.array(plan.q)[:, 1]).max()
    assert np.abs(np.array(plan.q)[:, 1]).max() <= away * (1.0 + 1e-9)
    assert np.abs(np.array(plan.q)[:, [0, 2]]).max() == 0.0


def test_a_turn_of_half_a_turn_is_refused_with_what_settles_it_and_less_is_planned() -> None:
    """Universal_Robots_ROS_Driver#540: the axis of a turn by 180 degrees is anyone's."""

    def request(angle: float, **more: Any) -> dict[str, Any]:
        half = 0.5 * angle
        turned = [np.cos(half), np.sin(half), 0.0, 0.0]
        path = {
            "begin": at(0.5, -0.4, 0.3),
            "segments": [line(0.5, 0.4, 0.3, turned=turned, **more)],
        }
        return {"robot": "ur10", "start": "free", "path": path, "scene": QUIET}

    with pytest.raises(InvalidRequest, match="turn_axis"):
        ikplan.plan(request(np.pi))
    assert ikplan.plan(request(np.radians(170.0))).certificate.valid
    assert ikplan.plan(request(np.pi, turn_axis=[0.0, 0.0, 1.0])).certificate.valid


def test_a_line_in_rounded_pieces_keeps_its_speed() -> None:
    """wandelbots-nova PR#509: one line, split in 7, its ends rounded to 1 um."""
    begin, way = np.array([0.4, -0.2, 0.3]), np.array([0.123054, 0.377166, 0.051022])
    points = [np.round(begin + k / 7.0 * way, 6) for k in range(8)]
    request = {
        "robot": "ur5",
        "start": "free",
        "path": {"begin": at(*points[0]), "segments": [line(*p) for p in points[1:]]},
        "limits": {"tool_speed": 0.1},
        "scene": QUIET,
    }
    plan = ikplan.plan(request)
    assert plan.certificate.stops == []
    ur5 = load_robot("ur5")
    speed = np.array(
        [np.linalg.norm((ur5.jacobian(q) @ dq)[:3]) for q, dq in zip(plan.q, plan.dq, strict=True)]
    )
    middle = (plan.time > 0.15 * plan.duration) & (plan.time < 0.85 * plan.duration)
    assert speed[middle].min() > 0.098


def test_the_second_differences_of_samples_keep_the_acceleration() -> None:
    """Universal_Robots_ROS2_Driver#1273: five rows at 500 Hz; no step is shorter than 2 ms."""
    rows = [
        [-0.5827, -0.9838, 1.6202, -2.1541, -1.4901, -3.6974],
        [-0.5761, -1.0009, 1.6452, -2.1632, -1.4907, -3.6906],
        [-0.5540, -1.0535, 1.7201, -2.1891, -1.4924, -3.6681],
        [-0.5087, -1.1467, 1.8451, -2.2274, -1.4956, -3.6220],
        [-0.4225, -1.2854, 2.0098, -2.2640, -1.5008, -3.5348],
    ]
    robot = load_robot("ur5")
    plan = ikplan.time_path(robot, rows, limits={"acceleration": 5.0, "jerk": False}, rate_hz=500)
    steps = np.diff(plan.time)
    assert steps.min() >= 2e-3 * (1.0 - 1e-9)
    speed = np.diff(plan.q, axis=0) / steps[:, None]
    second = np.diff(speed, axis=0) / (0.5 * (steps[1:] + steps[:-1]))[:, None]
    assert np.abs(second).max() <= 5.0 * (1.0 + 1e-6)
    assert plan.duration < 0.57


@pytest.mark.parametrize("away", [0.0, 3e-12, 1e-12])
def test_a_line_to_where_the_tool_is_already_is_a_plan(away: float) -> None:
    """Pilz, LinStartEqualsGoal; with limits of its own, and a hair beside."""
    ur5 = load_robot("ur5")
    start = np.array([0.3, -1.2, 1.4, -1.8, -1.57, 0.4])
    T = ur5.fk(start)
    turned = pin.Quaternion(T.rotation).normalized().coeffs().tolist()
    here = np.add(T.translation, [away, 0.0, 0.0]).tolist()
    segments = [
        line(*here, turned=turned, limits={"tool_speed": 0.1}),
        line(*T.translation, turned=turned),
    ]
    plan = ikplan.plan(
        {"robot": "ur5", "start": start.tolist(), "path": {"segments": segments}, "scene": QUIET}
    )
    assert plan.certificate.valid
    assert np.abs(plan.q - start).max() < 1e-9


def test_an_arc_through_points_on_a_line_is_the_line_and_one_of_no_radius_is_refused() -> None:
    """Pilz, colinearInterim and samePointsWithCenter."""
    begin, via, end = ([0.5, y, 0.3] for y in (-0.1, 0.0, 0.15))
    path = {
        "begin": at(*begin),
        "segments": [{"type": "arc", "via": via, "to": at(*end)}],
    }
    request = {"robot": "ur10", "start": "free", "path": path, "scene": QUIET}
    plan = ikplan.plan(request)
    p = load_robot("ur10").poses(plan.q)[1]
    assert off_polyline(p, [begin, end]).max() <= 1e-4
    tiny = {"type": "arc", "centre": [0.5 + 1.7e-8, -0.1, 0.3], "to": at(0.5 + 3.4e-8, -0.1, 0.3)}
    with pytest.raises(InvalidRequest, match="arc"):
        ikplan.plan({**request, "path": {"begin": at(*begin), "segments": [tiny]}})


def test_a_blend_where_the_tool_turns_is_not_slower_than_the_stop() -> None:
    """KDL's rounded composite: the tool turns 1 rad to the corner, and back after it."""
    half = [np.cos(0.5), np.sin(0.5), 0.0, 0.0]
    durations = []
    for radius in (0.0, 0.02, 0.06):
        path = {
            "begin": at(0.5, -0.15, 0.4),
            "segments": [
                line(0.5, 0.0, 0.4, turned=half, blend=radius),
                line(0.65, 0.0, 0.4),
            ],
        }
        request = {
            "robot": "ur10",
            "start": "free",
            "path": path,
            "scene": QUIET,
            "limits": {"jerk": False},
        }
        durations.append(ikplan.plan(request).duration)
    for exact, rounded in pairwise([durations[0], max(durations[1:])]):
        assert rounded <= exact


@pytest.mark.parametrize(
    ("distance", "velocity", "acceleration", "jerk", "duration"),
    [
        (2.0, 1.0, 100.0, 1.0, 4.0),
        (20.0, 100.0, 1.0, 1.0, 10.0),
        (10.0, 1.0, 1.0, 1.0, 12.0),
        (0.05, 2.175, 10.0, 1000.0, 0.15177),
    ],
)
def test_a_slide_as_long_as_a_model_has_it_takes_the_time_of_the_double_s(
    distance: float,
    velocity: float,
    acceleration: float,
    jerk: float,
    duration: float,
    tmp_path: Path,
) -> None:
    """Against ruckig 0.17, on a joint of +-10 km as models of one joint have it."""
    file = tmp_path / "slide.urdf"
    file.write_text(
        '<robot name="slide"><link name="l0"/><link name="l1"/>'
        '<joint name="j1" type="prismatic"><parent link="l0"/><child link="l1"/><axis xyz="1 0 0"/>'
        f'<limit lower="-10000" upper="10000" velocity="{velocity}" effort="1"/></joint></robot>'
    )
    robot = load_robot(file).with_limits(velocity=[velocity], acceleration=[acceleration])
    rows = [[0.0], [distance]]
    plan = ikplan.time_path(robot, rows, limits={"jerk": jerk}, rate_hz=1000)
    assert plan.duration == pytest.approx(duration, rel=0.01, abs=1e-3)
