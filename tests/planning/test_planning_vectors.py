"""The hard cases of tests/vectors/planning, each with the outcome that it states."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import Plan, Robot, errors, load_robot
from tests.measured import (
    asked_poses,
    check_motion,
    limit_ratios,
    off_circle,
    off_polyline,
    waypoint_errors,
)

FOLDER = Path(__file__).parents[1] / "vectors" / "planning"
VECTORS: dict[str, dict[str, Any]] = {
    path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))
}
GOOD = [name for name, vector in VECTORS.items() if "error" not in vector["expect"]]
BAD = [name for name, vector in VECTORS.items() if "error" in vector["expect"]]


def robot_of(request: Mapping[str, Any]) -> Robot:
    robot, tool = load_robot(request["robot"]), request.get("tool")
    if tool:
        robot = robot.with_tool(tool["position"], tool.get("quaternion_xyzw", [0, 0, 0, 1]))
    return robot


@functools.cache
def planned(name: str) -> Plan:
    # The cases are of kinematics: some of them stand with the arm in itself.
    return ikplan.plan({"scene": {"self_collision": False}, **VECTORS[name]["request"]})


def tool_positions(plan: Plan, request: Mapping[str, Any]) -> np.ndarray:
    return robot_of(request).poses(plan.q)[1]


def length(plan: Plan, request: Mapping[str, Any]) -> float:
    """Way of the tool over the samples and the waypoints between them [m]."""
    order = np.argsort(np.concatenate([plan.time, plan.waypoints.time]), kind="stable")
    q = np.vstack([plan.q, plan.waypoints.q])[order]
    steps = np.diff(robot_of(request).poses(q)[1], axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def duration(plan: Plan, _: Mapping[str, Any]) -> float:
    """Time of the motion before it was slowed to end at a sample [s]."""
    assert plan.timing is not None
    assert plan.time[-1] * plan.timing.rate_hz == pytest.approx(
        round(plan.time[-1] * plan.timing.rate_hz), abs=1e-6
    )
    return float(plan.time[-1]) / plan.timing.grid_factor


def elongation(plan: Plan, _: Mapping[str, Any]) -> float:
    """Joint distance from the start over the waypoints [deg]."""
    steps = np.diff(np.vstack([plan.q[0], plan.waypoints.q]), axis=0)
    return math.degrees(np.linalg.norm(steps, axis=1).sum())


def turn(plan: Plan, request: Mapping[str, Any]) -> float:
    """Angle between the tool's first and last orientation [rad]."""
    robot = robot_of(request)
    off = robot.fk(plan.q[0]).rotation.T @ robot.fk(plan.q[-1]).rotation
    return float(np.linalg.norm(pin.log3(off)))


def singular_value(plan: Plan, request: Mapping[str, Any]) -> float:
    """Least singular value of the whole Jacobian over the samples."""
    values = np.linalg.svd(robot_of(request).jacobians(plan.q), compute_uv=False)
    return float(values.min())


def gap(plan: Plan, _: Mapping[str, Any]) -> float:
    """Largest difference of a joint between the first and the last sample [rad or m]."""
    return float(np.abs(plan.q[-1] - plan.q[0]).max())


def off_path(plan: Plan, request: Mapping[str, Any]) -> float:
    """Largest distance of the tool from its lines or its circle [m]."""
    points, path = tool_positions(plan, request), request["path"]
    if "segments" in path:
        (circle,) = path["segments"]
        assert circle["type"] == "circle"
        return float(off_circle(points, circle["frame"]["position"], circle["radius"]).max())
    assert path["interpolation"] == "line"
    corners = [T.translation for T, _ in asked_poses(path)]
    if path.get("approach") == "joint":
        points = points[plan.time >= plan.waypoints.time[0]]
    else:
        corners.insert(0, points[0])
    return float(off_polyline(points, corners).max())


Figure = Callable[[Plan, Mapping[str, Any]], float]
FIGURES: dict[str, Figure] = {
    "length_m": length,
    "duration_s": duration,
    "elongation_deg": elongation,
    "turn_rad": turn,
    "singular_value": singular_value,
    "off_path_m": off_path,
    "closed": gap,
}
ABSOLUTE = {"singular_value", "turn_rad"}
FORMS = ({"is", "within"}, {"best", "over"}, {"most"}, {"within"})


def stated(expect: Mapping[str, Any]) -> Mapping[str, Any]:
    """What a vector expects, checked.

    Raises:
        ValueError: It states nothing, nothing that can be checked, or no reason.
    """
    if "error" in expect:
        if not expect.get("says"):
            raise ValueError("an error without its words")
        return expect
    if not expect:
        raise ValueError("no expectation")
    for kind, figure in expect.items():
        if kind not in FIGURES:
            raise ValueError(f"nothing measures {kind!r}")
        if set(figure) - {"because"} not in FORMS:
            raise ValueError(f"{kind}: no such form: {sorted(figure)}")
        if len(figure.get("because", "")) < 8:
            raise ValueError(f"{kind}: no reason")
    return expect


def holds(kind: str, figure: Mapping[str, Any], value: float) -> bool:
    """Whether a measured value is the one stated, to the margin stated."""
    if "best" in figure:
        return bool(value <= figure["best"] * (1.0 + figure["over"]))
    if "most" in figure:
        return bool(value <= figure["most"])
    exact = figure.get("is", 0.0)
    scale = 1.0 if kind in ABSOLUTE or "is" not in figure else abs(exact)
    return bool(abs(value - exact) <= figure["within"] * scale)


def test_there_are_vectors_of_both_kinds() -> None:
    assert len(GOOD) >= 20
    assert len(BAD) >= 7


@pytest.mark.parametrize("name", VECTORS)
def test_every_vector_states_what_it_expects_and_why(name: str) -> None:
    assert stated(VECTORS[name]["expect"])
    assert VECTORS[name]["why"]


REASON = "of a known arm"


@pytest.mark.parametrize(
    ("expect", "words"),
    [
        ({}, "no expectation"),
        ({"error": "Unreachable", "says": []}, "without its words"),
        ({"smoothness": {"most": 1.0, "because": REASON}}, "nothing measures"),
        ({"length_m": {"is": 1.0, "because": REASON}}, "no such form"),
        ({"length_m": {"is": 1.0, "within": 0.1}}, "no reason"),
    ],
)
def test_a_vector_that_states_nothing_to_check_is_refused(
    expect: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        stated(expect)


@pytest.mark.parametrize(
    ("kind", "figure", "value", "kept"),
    [
        ("length_m", {"is": 2.0, "within": 0.01}, 2.019, True),
        ("length_m", {"is": 2.0, "within": 0.01}, 2.021, False),
        ("length_m", {"is": 2.0, "within": 0.01}, 1.979, False),
        ("turn_rad", {"is": 3.0, "within": 0.01}, 3.011, False),
        ("elongation_deg", {"best": 100.0, "over": 0.01}, 100.9, True),
        ("elongation_deg", {"best": 100.0, "over": 0.01}, 101.1, False),
        ("off_path_m", {"most": 1e-4}, 1.1e-4, False),
        ("closed", {"within": 1e-6}, 1.1e-6, False),
        ("closed", {"within": 1e-6}, 0.9e-6, True),
    ],
)
def test_a_figure_is_held_to_its_margin(
    kind: str, figure: dict[str, float], value: float, kept: bool
) -> None:
    assert holds(kind, figure, value) == kept


@pytest.mark.parametrize("name", GOOD)
def test_a_hard_path_is_planned_as_its_vector_states(name: str) -> None:
    request, plan = VECTORS[name]["request"], planned(name)
    measured = {
        kind: (FIGURES[kind](plan, request), figure)
        for kind, figure in stated(VECTORS[name]["expect"]).items()
    }
    off = {kind: m for kind, m in measured.items() if not holds(kind, m[1], m[0])}
    assert not off


@pytest.mark.parametrize("name", GOOD)
def test_a_hard_path_is_one_motion_that_meets_its_waypoints(name: str) -> None:
    request, plan = VECTORS[name]["request"], planned(name)
    path, robot, certificate = request["path"], robot_of(request), plan.certificate
    check_motion(plan.trajectory, robot)
    limits = request.get("limits", {})
    scales = [limits.get(f"{kind}_scale", 1.0) for kind in ("velocity", "acceleration")]
    for used, scale in zip(limit_ratios(plan.trajectory, robot), scales, strict=True):
        assert used <= scale * (1.0 + 1e-9)
    if request.get("start", "free") != "free":
        np.testing.assert_array_equal(plan.q[0], request["start"])
    if "waypoints" in path and "blend" not in path:
        # Corners between lines are rounded within the tolerance.
        lines = path.get("interpolation") == "line"
        allowed = path.get("tolerance", {}).get("position", 1e-4) if lines else 1e-8
        assert waypoint_errors(plan, path, robot)[:, 0].max() <= allowed
        assert waypoint_errors(plan, path, robot)[-1].max() <= 1e-8
    assert certificate.elongation_sum == pytest.approx(
        math.radians(elongation(plan, request)), rel=1e-9
    )
    assert certificate.elongation_lower_bound <= certificate.elongation_sum + 1e-12


@pytest.mark.parametrize("name", BAD)
def test_a_path_that_cannot_be_is_refused_with_its_cause(name: str) -> None:
    expected = VECTORS[name]["expect"]
    with pytest.raises(getattr(errors, expected["error"])) as caught:
        ikplan.plan(VECTORS[name]["request"])
    for words in expected["says"]:
        assert words in caught.value.detail
    for field, value in expected.get("data", {}).items():
        assert getattr(caught.value, field) == value
    check_place(caught.value, VECTORS[name]["request"])


def check_place(error: ikplan.IkplanError, request: dict[str, Any]) -> None:
    """The error's target, joint values and distance fit each other."""
    if not isinstance(error, errors.Unreachable | errors.Disconnected):
        return
    robot = robot_of(request)
    q = np.array(error.q)
    assert ((robot.lower <= q) & (q <= robot.upper)).all()
    if isinstance(error, errors.Disconnected):
        return
    pose, target = robot.fk(q), error.target
    assert target is not None
    distance = np.linalg.norm(pose.translation - target["position"])
    assert distance == pytest.approx(error.position_error, abs=1e-9)
    if error.orientation_error is not None:
        R = pin.Quaternion(np.array(target["quaternion_xyzw"])).matrix()
        angle = np.linalg.norm(pin.log3(R.T @ pose.rotation))
        assert angle == pytest.approx(error.orientation_error, abs=1e-6)
    for row in error.waypoints[:1]:
        assert row["target"] == target


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", [name for name in GOOD if name.startswith("helix_")])
def test_every_seed_comes_within_half_a_percent_of_the_best_known(name: str, seed: int) -> None:
    vector = VECTORS[name]
    plan = ikplan.plan({**vector["request"], "ik": {"seed": seed}})
    best = vector["expect"]["elongation_deg"]["best"]
    assert elongation(plan, vector["request"]) <= 1.005 * best
