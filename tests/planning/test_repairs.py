"""Repairs: each kind, applied to its request, is planned; what was not tried is no repair."""

from __future__ import annotations

import copy
import json
import math
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.planning.lines import line_request, random_lines
from ikplan import BudgetExceeded, Disconnected, Plan, Robot, Unreachable, load_robot
from ikplan.planning.repairs import find_repairs
from tests.measured import asked_poses, check_motion, off_polyline, waypoint_errors

from .planar import REACH, joints, level, level_hand, tool, two_links

FARTHEST = 0.5
"""The longest shift that a repair may be [m]."""
TOLERANCE = 1e-4
TRIAL = sys.modules[find_repairs.__module__]
VECTORS = Path(__file__).parents[1] / "vectors" / "planning"


def planar(start: Any, *points: tuple[float, float], **path: Any) -> dict[str, Any]:
    """A request for the planar arm: positions alone."""
    waypoints = [{"position": [x, y, 0.0]} for x, y in points]
    begin = start if isinstance(start, str) else [float(v) for v in start]
    return {"robot": "two", "start": begin, "path": {"waypoints": waypoints, **path}}


def refused(request: dict[str, Any], robot: Robot | None = None) -> Unreachable | Disconnected:
    with pytest.raises((Unreachable, Disconnected)) as caught:
        ikplan.plan(copy.deepcopy(request), robot=robot)
    assert isinstance(caught.value, Unreachable | Disconnected)
    return caught.value


def merged(document: Any, change: Any) -> Any:
    """A document with a change applied: fields are replaced, documents within it merged."""
    if not isinstance(document, dict) or not isinstance(change, dict):
        return copy.deepcopy(change)
    return {**document, **{k: merged(document.get(k), v) for k, v in change.items()}}


def kind_of(repair: dict[str, Any]) -> str:
    (field,) = repair["change"]
    if field == "path":
        (field,) = repair["change"]["path"]
    return str(field)


def repaired(request: dict[str, Any], robot: Robot | None = None) -> dict[str, Any]:
    """Every repair offered, by its kind, each planned and checked: change and plan."""
    error = refused(request, robot)
    found = {}
    for repair in error.repairs:
        again = merged(request, repair["change"])
        plan = ikplan.plan(again, robot=robot)
        own = robot or load_robot(request["robot"])
        check_motion(plan.trajectory, own, ends=(again["start"],) if "start" in again else ())
        if "waypoints" in request["path"]:
            check_waypoints(plan, again["path"], own)
        if kind_of(repair) == "frame":
            assert np.linalg.norm(shift_of(request, again)) <= FARTHEST
        assert kind_of(repair) not in found
        found[kind_of(repair)] = (again, plan, repair["detail"])
    return found


def check_waypoints(plan: Plan, path: dict[str, Any], robot: Robot) -> None:
    """Positions are met within tolerance, and of the orientation what is not free."""
    box = path.get("tolerance", {}).get("box", {"position": [0.0]})
    corner = float(np.linalg.norm(box["position"]))
    assert waypoint_errors(plan, path, robot)[:, 0].max() <= TOLERANCE + corner
    free = path.get("orientation_free")
    if isinstance(free, dict):
        axis = "xyz".index(free["about"][-1])
        for q, (want, _) in zip(plan.waypoints.q, asked_poses(path), strict=True):
            have = robot.fk(q).rotation[:, axis]
            np.testing.assert_allclose(have, want.rotation[:, axis], atol=1e-7)


def shift_of(request: dict[str, Any], again: dict[str, Any]) -> np.ndarray:
    before = request["path"].get("frame", {}).get("position", [0.0, 0.0, 0.0])
    shift: np.ndarray = np.subtract(again["path"]["frame"]["position"], before)
    return shift


# Another branch at the start.


BEGIN, END = [0.7, -0.4, 0.0], [0.65, 0.35, 0.0]


def held_by_the_shoulder(lowest: float = -2.9) -> tuple[dict[str, Any], Robot]:
    """A line along which the shoulder comes to its limit on the branch that the arm starts in."""
    waypoint = {"position": END, "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    path = {"waypoints": [waypoint], "interpolation": "line"}
    request = {"robot": "level", "start": level(BEGIN, -1.0).tolist(), "path": path}
    return request, level_hand(shoulder=(lowest, 0.3))


def test_another_branch_to_start_in_is_that_of_the_closed_form() -> None:
    request, robot = held_by_the_shoulder()
    assert isinstance(refused(request, robot), Disconnected)
    again, plan, detail = repaired(request, robot)["start"]
    np.testing.assert_allclose(again["start"], level(BEGIN, 1.0), atol=1e-8)
    R, p = robot.poses(plan.q)
    assert off_polyline(p, [BEGIN, END]).max() <= 1e-4
    np.testing.assert_allclose(R, np.broadcast_to(np.eye(3), R.shape), atol=1e-3)
    assert "another branch" in detail


def test_no_repair_names_a_branch_that_is_held_too() -> None:
    """The other branch has its shoulder 1.35 rad down at the begin, and more on the way."""
    request, robot = held_by_the_shoulder(lowest=float(level(BEGIN, 1.0)[0]) + 0.1)
    error = refused(request, robot)
    assert "start" not in [kind_of(repair) for repair in error.repairs]


# A shift of the path.


@pytest.mark.parametrize("beyond", [1e-3, 0.03, 0.2, 0.45])
@pytest.mark.parametrize("interpolation", ["joint", "line"])
def test_the_shift_is_about_what_the_arm_lacks(beyond: float, interpolation: str) -> None:
    angle = 0.6
    far = (REACH + beyond) * np.array([math.cos(angle), math.sin(angle)])
    start = joints([0.6, 0.3, 0.0], 1.0)
    approach = {"approach": "joint"} if interpolation == "line" else {}
    request = planar(start, tuple(0.8 * far), tuple(far), interpolation=interpolation, **approach)
    again, plan, detail = repaired(request, two_links())["frame"]
    shift = shift_of(request, again)
    length = float(np.linalg.norm(shift))
    assert length >= beyond - TOLERANCE
    assert length <= 1.04 * beyond
    # Straight inwards, as far as it is one place alone that is out of reach.
    assert abs(shift[2]) <= 0.05 * length
    assert shift[:2] @ far / np.linalg.norm(far) <= -0.95 * length
    told = re.fullmatch(r"move the path by ([\d.]+) mm in the base", detail)
    assert told is not None
    assert float(told[1]) == pytest.approx(1e3 * length, abs=0.051)
    np.testing.assert_allclose(tool(plan.q[-1])[:2], far + shift[:2], atol=TOLERANCE)


def test_the_shift_is_in_the_base_whatever_the_frame_of_the_path() -> None:
    frame = pin.SE3(pin.exp3(np.array([0.0, 0.0, 1.1])), np.array([0.1, -0.2, 0.0]))
    near, far = frame.actInv(np.array([0.7, 0.1, 0.0])), frame.actInv(np.array([1.0, 0.1, 0.0]))
    request = planar(
        joints([0.6, 0.3, 0.0], 1.0), tuple(near[:2]), tuple(far[:2]),
        frame={
            "position": frame.translation.tolist(),
            "quaternion_xyzw": pin.Quaternion(frame.rotation).coeffs().tolist(),
        },
    )  # fmt: skip
    again, plan, _ = repaired(request, two_links())["frame"]
    shift = shift_of(request, again)
    assert shift @ [1.0, 0.1, 0.0] < 0.0
    want = np.array([1.0, 0.1, 0.0]) + shift
    np.testing.assert_allclose(tool(plan.q[-1]), want, atol=TOLERANCE)
    assert again["path"]["frame"]["quaternion_xyzw"] == request["path"]["frame"]["quaternion_xyzw"]


@pytest.mark.parametrize("beyond", [0.6, 2.0, 60.0])
def test_no_path_is_shifted_by_more_than_half_a_metre(beyond: float) -> None:
    request = planar(joints([0.6, 0.3, 0.0], 1.0), (0.7, 0.1), (REACH + beyond, 0.0))
    error = refused(request, two_links())
    assert isinstance(error, Unreachable)
    assert error.position_error == pytest.approx(beyond, abs=1e-6)
    assert error.repairs == []


def test_no_shift_repairs_a_path_wider_than_the_reach() -> None:
    """What brings one end within reach takes the other farther away."""
    request = planar(joints([0.6, 0.3, 0.0], 1.0), (1.1, 0.0), (-1.1, 0.0))
    error = refused(request, two_links())
    assert isinstance(error, Unreachable)
    assert error.position_error == pytest.approx(0.2, abs=1e-6)
    assert error.repairs == []


# A free tool axis, or free orientation.


def tilted(turn: list[float]) -> dict[str, Any]:
    """A pose of the Dobot, whose tool stays level, turned."""
    robot = load_robot("dobot_magician")
    T = robot.fk([0.2, 0.6, 0.5, 0.0])
    x = pin.SE3ToXYZQUAT(pin.SE3(T.rotation @ pin.exp3(np.array(turn)), T.translation)).tolist()
    waypoint = {"position": x[:3], "quaternion_xyzw": x[3:]}
    return {"robot": robot.name, "start": robot.home.tolist(), "path": {"waypoints": [waypoint]}}


@pytest.mark.parametrize(
    ("turn", "free"),
    [
        ([0.5, 0.0, 0.0], {"about": "tool_x"}),
        ([0.0, 0.5, 0.0], {"about": "tool_y"}),
        ([0.4, 0.3, 0.0], "all"),
    ],
)
def test_the_repair_is_the_least_freedom_that_makes_a_pose_feasible(
    turn: list[float], free: Any
) -> None:
    again, _, detail = repaired(tilted(turn))["orientation_free"]
    assert again["path"]["orientation_free"] == free
    assert ("any orientation" if free == "all" else free["about"]) in detail


@pytest.mark.parametrize("path", [{"orientation_free": {"about": "tool_z"}}, {"tolerance": {"box": {
    "position": [1e-3, 0.0, 0.0], "orientation": [0.0, 0.0, 0.0]}}}])  # fmt: skip
def test_a_freedom_asked_for_is_not_taken_back(path: dict[str, Any]) -> None:
    request = merged(tilted([0.5, 0.0, 0.0]), {"path": path})
    for repair in refused(request).repairs:
        assert kind_of(repair) != "orientation_free"


HARD: dict[str, set[str]] = {
    "iiwa_line_past_the_edge_of_reach": {"frame"},
    "iiwa_waypoint_inside_the_arm": {"frame"},
    "ur5_line_out_of_reach": set(),
    "ur5_line_through_the_base": set(),
    "ur5_wrist_singular_start_across": {"start", "orientation_free"},
    "ur5_wrist_turns_to_its_limit": {"start", "orientation_free"},
}
"""Vectors, and the kinds of repairs that they have at least."""


@pytest.mark.parametrize("name", HARD)
def test_every_repair_of_a_hard_path_is_planned(name: str) -> None:
    request = json.loads((VECTORS / f"{name}.json").read_text())["request"]
    assert set(repaired(request)) >= HARD[name]


# Every repair has planned before.

Lay = Callable[[Any], Any]


@pytest.fixture
def trials(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The plans that are tried for repairs: each ends as ``fails`` of its problem says."""
    tried: dict[str, Any] = {"problems": [], "fails": lambda _: False}
    lay: Lay = TRIAL.plan_joint_path

    def trial(problem: Any) -> Any:
        tried["problems"].append(problem)
        if tried["fails"](problem):
            raise Disconnected("planted", waypoints=[-1, 0], jump=1.0, reason="planted", q=[])
        return lay(problem)

    monkeypatch.setattr(TRIAL, "plan_joint_path", trial)
    return tried


REPAIRABLE: dict[str, Callable[[], tuple[dict[str, Any], Robot | None]]] = {
    "start": held_by_the_shoulder,
    "frame": lambda: (planar(joints([0.6, 0.3, 0.0], 1.0), (0.7, 0.1), (1.0, 0.1)), two_links()),
    "orientation_free": lambda: (tilted([0.5, 0.0, 0.0]), None),
}


@pytest.mark.parametrize("kind", REPAIRABLE)
def test_no_repair_fails_to_plan(kind: str, trials: dict[str, Any]) -> None:
    request, robot = REPAIRABLE[kind]()
    assert kind in [kind_of(repair) for repair in refused(request, robot).repairs]
    assert trials["problems"]
    trials["problems"].clear()
    trials["fails"] = lambda _: True
    assert refused(request, robot).repairs == []
    assert trials["problems"]


@pytest.mark.parametrize("kind", REPAIRABLE)
def test_the_trials_planned_just_what_the_repair_says(kind: str, trials: dict[str, Any]) -> None:
    request, robot = REPAIRABLE[kind]()
    (repair,) = [r for r in refused(request, robot).repairs if kind_of(r) == kind]
    again = merged(request, repair["change"])
    path = again["path"]
    told: Callable[[Any], bool] = {
        "start": lambda p: np.array_equal(p.q_start, again["start"]),
        "frame": lambda p: p.path.frame.position == path.get("frame", {}).get("position"),
        "orientation_free": lambda p: (
            p.path.orientation_free is not None
            and p.path.orientation_free.about == path["orientation_free"]["about"]
        ),
    }[kind]
    assert any(told(problem) for problem in trials["problems"])


def test_the_repair_is_the_next_branch_where_the_nearest_does_not_plan(
    trials: dict[str, Any],
) -> None:
    request = json.loads((VECTORS / "ur5_wrist_turns_to_its_limit.json").read_text())["request"]
    start = np.array(request["start"])
    first = next(r for r in refused(request).repairs if kind_of(r) == "start")["change"]["start"]
    trials["fails"] = lambda problem: np.array_equal(problem.q_start, first)
    second = next(r for r in refused(request).repairs if kind_of(r) == "start")["change"]["start"]
    assert np.linalg.norm(second - start) >= np.linalg.norm(first - start)
    plan = ikplan.plan({**request, "start": second})
    check_motion(plan.trajectory, load_robot("ur5"), ends=(second,))


def test_a_budget_that_runs_out_on_the_way_leaves_what_was_found(
    trials: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clock jumps past the budget as soon as one repair has been tried."""
    request = json.loads((VECTORS / "ur5_wrist_singular_start_across.json").read_text())["request"]
    assert len(refused(request).repairs) == 4
    now = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    seen: list[Any] = []

    def after_the_first(problem: Any) -> bool:
        if seen and not np.array_equal(seen[-1].q_start, problem.q_start):
            now[0] = 1e9
        seen.append(problem)
        return False

    trials["fails"] = after_the_first
    error = refused({**request, "budget_s": 10.0})
    assert isinstance(error, Disconnected)
    assert [kind_of(repair) for repair in error.repairs] == ["start"]
    now[0] = 0.0
    trials["fails"] = lambda _: now.__setitem__(0, 1e9)
    with pytest.raises((Unreachable, Disconnected, BudgetExceeded)) as caught:
        ikplan.plan({**request, "budget_s": 10.0})
    assert isinstance(caught.value, Disconnected)
    assert caught.value.repairs == []


def test_as_many_repairs_are_looked_for_as_asked() -> None:
    robot = load_robot("ur5")
    line = line_request(robot, random_lines(robot, 12)[9], 1e-3)
    every = refused(line).repairs
    assert len(every) > 1
    none, one = refused({**line, "repairs": 0}), refused({**line, "repairs": 1})
    assert none.repairs == []
    assert none.reason == one.reason
    assert one.repairs == every[:1]
    with pytest.raises(ikplan.InvalidRequest, match="repairs"):
        ikplan.plan({**line, "repairs": -1})
