"""How far arms reach, what is far beyond, and frames fixed to their bases."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan import InvalidRequest, Unreachable
from ikplan.documents.poses import Frame
from ikplan.robots import Robot, load_robot
from ikplan.robots.base_frames import base_links, frame_in_base
from ikplan.robots.reach import reach, unit_hint


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_no_tool_is_farther_than_the_reach(name: str) -> None:
    robot = load_robot(name).with_tool([0.1, 0.0, 0.2], [0.0, 0.0, 0.0, 1.0])
    lower, upper = np.maximum(robot.lower, -7.0), np.minimum(robot.upper, 7.0)
    rng = np.random.default_rng(1)
    q = rng.uniform(lower, upper, (500, robot.dof))
    q[::5] = np.where(rng.random(q[::5].shape) < 0.5, lower, upper)
    farthest = max(float(np.linalg.norm(robot.fk(row).translation)) for row in q)
    assert farthest <= reach(robot) < 2.5 * farthest


def test_coordinates_in_millimetres_are_named_where_all_are_beyond_reach() -> None:
    ur5 = load_robot("ur5")
    assert unit_hint(ur5, [[400.0, 0.0, 300.0], [0.0, 20.0, 0.0]]) is not None
    assert unit_hint(ur5, [[400.0, 0.0, 300.0], [0.0, 0.2, 0.0]]) is None
    assert unit_hint(ur5, []) is None
    with pytest.raises(Unreachable, match="are the coordinates millimetres"):
        ikplan.solve_ik(ur5, np.array([400.0, 0.0, 300.0]))
    with pytest.raises(Unreachable) as caught:
        ikplan.solve_ik(ur5, np.array([2.0, 0.0, 0.3]))
    assert "millimetres?" not in caught.value.detail


@pytest.mark.parametrize("interpolation", ["joint", "line", "spline"])
def test_the_repair_of_millimetres_is_the_plan_in_metres(interpolation: str) -> None:
    def request(scale: float) -> dict[str, Any]:
        waypoints = [
            {"position": [x * scale, y * scale, 300 * scale], "quaternion_xyzw": [1, 0, 0, 0]}
            for x, y in ((400, -100), (400, 100), (350, 100))
        ]
        frame = {"position": [0.0, 0.0, 0.05]}
        path = {"waypoints": waypoints, "frame": frame, "interpolation": interpolation}
        return {"robot": "ur5", "start": "free", "path": path}

    with pytest.raises(Unreachable, match="millimetres") as caught:
        ikplan.plan(request(1.0))
    (repair,) = caught.value.repairs
    repaired = request(1.0)
    repaired["path"] = {**repaired["path"], **repair["change"]["path"]}
    made = ikplan.plan(repaired)
    placed = [load_robot("ur5").fk(q).translation for q in made.waypoints.q]
    np.testing.assert_allclose(
        placed, [[0.4, -0.1, 0.35], [0.4, 0.1, 0.35], [0.35, 0.1, 0.35]], atol=1e-4
    )


def test_segments_are_repaired_where_they_have_no_other_lengths() -> None:
    def to(x: float, y: float) -> dict[str, object]:
        return {"position": [x, y, 300.0], "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}

    line, arc = {"type": "line", "to": to(400.0, 100.0)}, {"type": "arc", "to": to(400.0, 100.0)}
    spline = {"type": "spline", "through": [to(350.0, 0.0), to(350.0, -100.0)]}
    path = {"begin": to(400.0, -100.0), "segments": [line, spline]}
    with pytest.raises(Unreachable, match="millimetres") as caught:
        ikplan.plan({"robot": "ur5", "start": "free", "path": path})
    (repair,) = caught.value.repairs
    change = repair["change"]["path"]
    assert change["begin"]["position"] == [0.4, -0.1, 0.3]
    assert change["segments"][1]["through"][1]["position"] == [0.35, -0.1, 0.3]
    assert ikplan.plan({"robot": "ur5", "start": "free", "path": change}).certificate.valid
    path["segments"] = [{**arc, "via": [380.0, 0.0, 300.0]}]
    with pytest.raises(Unreachable, match="millimetres") as caught:
        ikplan.plan({"robot": "ur5", "start": "free", "path": path})
    assert caught.value.repairs == []


def test_links_fixed_to_the_base_are_frames_for_points() -> None:
    ur5 = load_robot("ur5")
    assert {"base_link", "base"} <= set(base_links(ur5))
    assert "shoulder_link" not in base_links(ur5)
    frame = frame_in_base(ur5, "base")
    R = pin.Quaternion(np.array(frame["quaternion_xyzw"])).matrix()
    np.testing.assert_allclose(R, np.diag([-1.0, -1.0, 1.0]), atol=1e-9)
    assert frame_in_base(ur5, "base_link")["position"] == [0.0, 0.0, 0.0]
    inside = {"position": [0.1, 0.2, 0.3]}
    np.testing.assert_allclose(
        frame_in_base(ur5, "base", inside)["position"], [-0.1, -0.2, 0.3], atol=1e-9
    )
    for name in ("shoulder_link", "nowhere"):
        with pytest.raises(InvalidRequest, match="base_link") as caught:
            frame_in_base(ur5, name)
        assert caught.value.field == "base_frame"


def test_the_base_of_the_controller_is_the_descriptions(monkeypatch: pytest.MonkeyPatch) -> None:
    known = Frame(position=[0.0, 0.0, 0.1], quaternion_xyzw=[0.0, 0.0, 1.0, 0.0])
    info = SimpleNamespace(controller=SimpleNamespace(base_frame=known))
    monkeypatch.setattr(Robot, "info", lambda _: info)
    frame = frame_in_base(load_robot("ur5"), "controller", {"position": [0.1, 0.2, 0.3]})
    np.testing.assert_allclose(frame["position"], [-0.1, -0.2, 0.4], atol=1e-12)
    info.controller = None
    with pytest.raises(InvalidRequest, match="controller's base is not known"):
        frame_in_base(load_robot("ur5"), "controller")


def test_the_base_of_a_chain_that_begins_elsewhere_is_the_origin() -> None:
    robot = load_robot("baxter_left")
    frame = frame_in_base(robot, robot.base_frame)
    np.testing.assert_allclose(frame["position"], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(frame["quaternion_xyzw"]), [0, 0, 0, 1], atol=1e-12)
