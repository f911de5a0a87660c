"""Cases of other planners' tests and of public reports: timings near a polyline, arms, sizes."""

from __future__ import annotations

import itertools
import statistics
import time
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

import ikplan
from ikplan import Disconnected, Robot, load_robot

Array = NDArray[np.float64]

QUIET = {"self_collision": False}


def slides(folder: Path, velocity: list[float], acceleration: list[float]) -> Robot:
    """A gantry of as many prismatic joints as there are limits, up to the third along an axis."""
    axes = ["1 0 0", "0 1 0", "0 0 1", "1 1 0"]
    text = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="prismatic"><parent link="l{k - 1}"/>'
        f'<child link="l{k}"/><axis xyz="{axes[k - 1]}"/>'
        f'<limit lower="-10000" upper="10000" velocity="{v}" effort="1"/></joint>'
        for k, v in enumerate(velocity, 1)
    )
    file = folder / "gantry.urdf"
    file.write_text(f'<robot name="gantry"><link name="l0"/>{text}</robot>')
    return load_robot(file).with_limits(velocity=velocity, acceleration=acceleration)


def off_joint_polyline(q: Array, rows: Array) -> float:
    """Largest distance in any joint of configurations from a polyline, its legs cut finely."""
    shares = np.linspace(0.0, 1.0, 1001)[:, None]
    dense = np.vstack([a + shares * (b - a) for a, b in itertools.pairwise(rows)])
    return float(max(np.abs(dense - one).max(axis=1).min() for one in q))


@pytest.mark.parametrize(
    ("tolerance", "longest"),
    # TOTG takes 1919.56 s with deviations of 100; the legs one by one, each from rest to rest,
    # take 2868.6 s.
    [(100.0, 1919.56), (1.0, 2868.6)],
)
def test_a_path_in_millimetres_is_kept_within_a_tolerance_of_its_legs(
    tolerance: float, longest: float, tmp_path: Path
) -> None:
    """moveit2, time_optimal_trajectory_generation, test2 and test3."""
    robot = slides(tmp_path, [1.3, 0.67, 0.67, 0.5], [0.002] * 4)
    rows = np.array(
        [
            [1427.0, 368.0, 690.0, 90.0],
            [1427.0, 368.0, 790.0, 90.0],
            [952.499938964844, 433.0, 1051.0, 90.0],
            [452.5, 533.0, 1051.0, 90.0],
            [452.5, 533.0, 951.0, 90.0],
        ]
    )
    timing = ikplan.time_path(robot, rows, rate_hz=1, tolerance=tolerance)
    assert timing.duration < longest
    assert timing.certificate.max_joint_deviation is not None
    assert timing.certificate.max_joint_deviation <= tolerance
    assert off_joint_polyline(timing.q[::40], rows) <= tolerance * 1.01


def test_a_right_corner_within_a_thousandth_takes_hardly_less_than_the_stop(
    tmp_path: Path,
) -> None:
    """moveit2, AccelerationLimitIsRespected: 20.4 s with a stop; a spline leaves it by 0.096."""
    robot = slides(tmp_path, [0.1] * 3, [0.5] * 3)
    rows = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    spline = ikplan.time_path(robot, rows, rate_hz=100)
    told = spline.certificate.max_joint_deviation
    assert told is not None
    assert told == pytest.approx(off_joint_polyline(spline.q[::4], rows), rel=2e-2)
    assert told > 0.05
    for tolerance in (1e-3, 1e-4):
        near = ikplan.time_path(robot, rows, rate_hz=100, tolerance=tolerance)
        assert 20.0 < near.duration <= 20.41
        assert off_joint_polyline(near.q[::4], rows) <= tolerance + 6e-4
        assert near.certificate.max_joint_deviation is not None
        assert near.certificate.max_joint_deviation <= tolerance
        assert np.abs(near.ddq).max() <= 0.5 * (1.0 + 1e-9)


def test_a_path_of_another_planner_tells_how_far_the_tool_leaves_it_and_keeps_a_tolerance() -> None:
    """roboplan, createTestPathLong is of this kind: legs of a tree search, far from each other."""
    ur5 = load_robot("ur5").with_limits(velocity=[3.15] * 6, acceleration=[2.0] * 6)
    rng = np.random.default_rng(8)
    rows = ur5.home + np.cumsum(rng.uniform(-0.6, 0.6, (8, 6)), axis=0)
    tool = np.array([ur5.fk(q).translation for q in rows])
    assert np.linalg.norm(np.diff(tool, axis=0), axis=1).min() > 0.05
    spline = ikplan.time_path(ur5, rows)
    told = spline.certificate.max_joint_deviation
    assert told is not None
    assert told == pytest.approx(off_joint_polyline(spline.q[::8], rows), rel=0.05)
    assert spline.certificate.max_path_deviation is not None
    assert spline.certificate.max_path_deviation > 5e-3
    rest = ikplan.time_path(ur5, rows, rest_at=range(len(rows)))
    near = ikplan.time_path(ur5, rows, tolerance={"position": 1e-3, "orientation": 1e-2})
    assert near.certificate.max_path_deviation is not None
    assert near.certificate.max_path_deviation <= 1e-3
    assert near.certificate.max_orientation_deviation is not None
    assert near.certificate.max_orientation_deviation <= 1e-2
    assert near.duration <= rest.duration


SEVEN_AXES = (
    # Displacement of the next axis, and whether it turns by -90, 90 or 0 degrees about x.
    ((0.062, 0.0, 0.3571), -1),
    ((-0.062, 0.0, 0.1052), 1),
    ((0.05, 0.0, 0.9225), -1),
    ((-0.05, 0.0, -0.0857), 1),
    ((0.0, 0.0, 0.8775), -1),
    ((0.0, 0.0, 0.111), -1),
    ((0.0, 0.0, 0.108), 0),
)


def seven_axes(folder: Path) -> Robot:
    """An arm of seven axes with an offset at every one, so that no closed form solves it."""
    text = ""
    for k, (p, quarter) in enumerate(SEVEN_AXES, 1):
        low, high = (-1.22173, np.pi) if k in (2, 4) else (-2.0 * np.pi, 2.0 * np.pi)
        before = "base" if k == 1 else f"f{k - 1}"
        turn = quarter * 0.5 * np.pi
        text += (
            f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="{before}"/>'
            f'<child link="l{k}"/><axis xyz="0 0 1"/>'
            f'<limit lower="{low}" upper="{high}" velocity="2" effort="1"/></joint>'
            f'<link name="f{k}"/><joint name="t{k}" type="fixed"><parent link="l{k}"/>'
            f'<child link="f{k}"/><origin xyz="{p[0]} {p[1]} {p[2]}" rpy="{turn} 0 0"/></joint>'
        )
    file = folder / "seven.urdf"
    file.write_text(f'<robot name="seven"><link name="base"/>{text}</robot>')
    return load_robot(file)


def test_a_pose_that_solvers_of_a_toolbox_miss_is_solved(tmp_path: Path) -> None:
    """robotics-toolbox-python#479, in either convention of its Euler angles, and beside it."""
    robot = seven_axes(tmp_path)
    angles = np.radians([-170.9, 6.0, -150.0])
    outer = pin.rpy.rpyToMatrix(*angles)
    inner = pin.rpy.rpyToMatrix(*angles[::-1])[::-1, ::-1]
    rng = np.random.default_rng(479)
    for R in (outer, np.ascontiguousarray(inner), pin.SE3.Random().rotation):
        for shift in (np.zeros(3), rng.normal(0.0, 0.05, 3)):
            T = pin.SE3(R, np.array([1.61637, 0.114284, -0.245724]) + shift)
            for method in ("lm", "ik-ba"):
                found = ikplan.solve_ik(robot, T, method=method)
                off = pin.log6(robot.fk(found.q).actInv(T)).vector
                assert np.linalg.norm(off) < 1e-6


@pytest.mark.parametrize("name", ["xarm7", "xarm6", "lite6"])
def test_a_line_from_the_zero_configuration_is_planned(name: str) -> None:
    """xArm-Python-SDK#153: stretched axes are parallel at zero, and the line leads out of it."""
    robot = load_robot(name)
    zero = np.clip(np.zeros(robot.dof), robot.lower, robot.upper)
    T = robot.fk(zero)
    singular = np.linalg.svd(robot.jacobian(zero), compute_uv=False)[-1]
    assert singular < 0.05
    end = T.translation + np.array([0.05, 0.0, 0.0])
    turned = pin.Quaternion(T.rotation).normalized().coeffs().tolist()
    plan = ikplan.plan(
        {
            "robot": name,
            "start": zero.tolist(),
            "path": {
                "segments": [
                    {"type": "line", "to": {"position": end.tolist(), "quaternion_xyzw": turned}}
                ]
            },
            "limits": {"tool_speed": 0.05},
            "sampling": {"rate_hz": 100},
            "scene": QUIET,
        }
    )
    p = robot.poses(plan.q)[1]
    off = p - T.translation
    across = off - np.outer(off @ (end - T.translation), end - T.translation) / 0.05**2
    assert np.linalg.norm(across, axis=1).max() <= 1e-4
    assert plan.certificate.valid


@pytest.mark.parametrize("free", [False, True])
def test_half_a_circle_about_the_base_ends_where_the_first_joint_does(free: bool) -> None:
    """Pilz, CIRCCmd6 and CIRCCmd2: the first joint turns by 2.967 rad, not by pi."""
    robot = load_robot("kuka_kr6_r700_sixx")
    assert robot.upper[0] == pytest.approx(np.radians(170.0), abs=1e-3)
    q = np.array([0.0, -1.2, 1.4, 0.0, 0.9, 0.0])
    T = robot.fk(q)
    radius = float(np.hypot(*T.translation[:2]))
    turned = pin.Quaternion(T.rotation).normalized().coeffs().tolist()
    # The axes of the maker turn downwards.
    sign = 1.0 if robot.fk(q + np.array([0.1, 0, 0, 0, 0, 0])).translation[1] > 0.0 else -1.0
    arc = {
        "type": "arc",
        "centre": [0.0, 0.0, float(T.translation[2])],
        "axis": [0.0, 0.0, 1.0],
        "angle": sign * np.pi,
        "orientation": "follow",
    }
    begin = {"begin": {"position": T.translation.tolist(), "quaternion_xyzw": turned}}
    request = {
        "robot": robot.name,
        "start": "free" if free else q.tolist(),
        "path": {"segments": [arc], **(begin if free else {})},
        "scene": QUIET,
    }
    with pytest.raises(Disconnected) as refused:
        ikplan.plan(request)
    assert robot.joint_names[0] in str(refused.value)
    assert f"{1e3 * radius * robot.upper[0]:.1f} mm of {1e3 * radius * np.pi:.1f} mm" in str(
        refused.value
    )
    arc["angle"] = sign * 0.99 * float(robot.upper[0])
    assert ikplan.plan(request).certificate.valid


def fk_seconds(robot: Robot) -> float:
    """Median time of one call of forward kinematics [s]."""
    times = []
    for _ in range(400):
        begin = time.thread_time_ns()
        robot.fk(robot.home)
        times.append(time.thread_time_ns() - begin)
    return 1e-9 * statistics.median(times)


def bent_edge(count: int) -> list[dict[str, Any]]:
    """Points on the edge of a bent sheet, written to a hundredth of a millimetre, tool normal."""
    s = np.linspace(0.0, 1.0, count)
    p = np.stack([0.55 + 0.06 * np.cos(7.0 * s), -0.2 + 0.4 * s, 0.35 + 0.03 * np.sin(9.0 * s)]).T
    lean = 0.25 * np.sin(5.0 * s)
    return [
        {
            "position": np.round(row, 5).tolist(),
            "quaternion_xyzw": [float(np.cos(0.5 * a)), 0.0, float(np.sin(0.5 * a)), 0.0],
        }
        for row, a in zip(p, lean, strict=True)
    ]


def test_the_points_of_a_bent_part_cost_little_each() -> None:
    """tesseract, puzzle_bent is of this kind: 437 points are planned within the default budget."""
    request = {
        "robot": "iiwa14",
        "start": "free",
        "path": {
            "waypoints": bent_edge(110),
            "interpolation": "line",
            "orientation_free": {"about": "tool_z"},
        },
        "limits": {"tool_speed": 0.02},
        "sampling": {"rate_hz": 50},
        "scene": QUIET,
        "budget_s": 60,
    }
    ikplan.plan(request)  # warm
    begin = time.thread_time()
    plan = ikplan.plan(request)
    spent = time.thread_time() - begin
    assert plan.certificate.valid
    assert plan.certificate.stops == []
    # 10 s for 437 points, on a machine with a call of 1.5 us.
    assert spent / 110 <= 15_000 * fk_seconds(load_robot("iiwa14"))
