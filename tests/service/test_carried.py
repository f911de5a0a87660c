"""What the arm carries and holds: windows of attached bodies, tools with a shape, fingers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import Client, InCollision, InvalidRequest
from ikplan.cli import main

from .test_scenes import request, tool_at

SPHERE = {"type": "sphere", "radius": 0.03}
PART: dict[str, Any] = {"name": "part", "shape": SPHERE, "position": [0.0, 0.0, 0.14]}
"""Carried 140 mm before the tool."""
PLACES = [tool_at([0.0, 0.0, 0.08]), tool_at([0.0, 0.1, 0.08]), tool_at([0.0, 0.2, 0.08])]
"""Segment k ends at place k, and is a straight line."""


def way(**more: Any) -> dict[str, Any]:
    full = ikplan.load_robot("ur5").fk(ikplan.load_robot("ur5").home)
    quaternion = _quaternion(full.rotation)
    waypoints = [{"position": p, "quaternion_xyzw": quaternion} for p in PLACES]
    return {"robot": "ur5", "path": {"waypoints": waypoints, "interpolation": "line"}, **more}


def _quaternion(R: np.ndarray) -> list[float]:
    coefficients: list[float] = pin.Quaternion(R).coeffs().tolist()
    return coefficients


def ahead(distance: float) -> np.ndarray:
    """From the tool to a point before it, in the base [m]."""
    robot = ikplan.load_robot("ur5")
    direction: np.ndarray = robot.fk(robot.home).rotation @ np.array([0.0, 0.0, distance])
    return direction


def post(segment: int) -> dict[str, Any]:
    """A ball that only the carried part meets, half-way along a segment."""
    ends = [tool_at([0.0, 0.0, 0.0]), *PLACES][segment : segment + 2]
    place = np.mean(ends, axis=0) + ahead(0.165)
    shape = {"type": "sphere", "radius": 0.01}
    return {"name": f"post {segment}", "shape": shape, "position": place.tolist()}


def scene(post_at: int, **carried: int) -> dict[str, Any]:
    return {"obstacles": [post(post_at)], "attached": [{**PART, **carried}]}


@pytest.mark.parametrize(
    ("post_at", "carried", "hits"),
    [
        (2, {}, True),
        (2, {"first_segment": 2}, True),
        (2, {"first_segment": 2, "last_segment": 2}, True),
        (2, {"last_segment": 1}, False),
        (1, {"first_segment": 1, "last_segment": 1}, True),
        (1, {"first_segment": 2}, False),
    ],
)
def test_a_part_hits_only_while_it_is_carried(
    client: Client, post_at: int, carried: dict[str, int], hits: bool
) -> None:
    document = way(scene=scene(post_at, **carried))
    if hits:
        with pytest.raises(InCollision) as caught:
            client.plan(document)
        assert set(caught.value.pair) == {"part", f"post {post_at}"}
        return
    plan = client.plan(document)
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.proven
    # Carried all the way, the same motion would hit: the window decides.
    robot = ikplan.load_robot("ur5")
    always = {**scene(post_at), "self_collision": False}
    assert min(robot.clearance(q, always).distance for q in plan.q[::4]) < 0.0


def test_an_obstacle_that_the_part_may_touch_is_no_contact(client: Client) -> None:
    document = way(scene={"obstacles": [post(1)], "attached": [{**PART, "touches": ["post 1"]}]})
    clearance = client.plan(document).certificate.clearance
    assert clearance is not None
    assert clearance.proven
    assert {"pair": ["part", "post 1"], "reason": "the request: touches"} in [
        row.model_dump() for row in clearance.allowed
    ]
    document["scene"]["attached"][0]["touches"] = ["post 7"]
    with pytest.raises(InvalidRequest, match="post 1") as caught:
        client.plan(document)
    assert caught.value.field == "scene.attached[0].touches"


def test_the_shape_of_a_tool_is_checked(client: Client) -> None:
    spindle = {"name": "spindle", "shape": SPHERE, "position": [0.0, 0.0, 0.14]}
    beside = way(scene={"obstacles": [post(2)]})
    bare = client.plan(beside)
    with pytest.raises(InCollision) as caught:
        client.plan({**beside, "tool": {"geometry": [spindle]}})
    assert set(caught.value.pair) == {"spindle", "post 2"}
    held = client.plan(way(tool={"geometry": [spindle]}))
    assert held.id not in (bare.id, client.plan(way()).id)
    assert np.array_equal(held.q, client.plan(way()).q)
    clearance = held.certificate.clearance
    assert clearance is not None
    assert "spindle" in [row.body for row in clearance.sources]


def panda(**more: Any) -> dict[str, Any]:
    robot = ikplan.load_robot("panda")
    place = (robot.fk(robot.home).translation + np.array([0.0, 0.05, 0.0])).tolist()
    return {"robot": "panda", "path": {"waypoints": [{"position": place}]}, **more}


def test_fingers_stand_where_the_request_puts_them(
    client: Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def least(document: dict[str, Any]) -> float:
        clearance = client.plan(document).certificate.clearance
        assert clearance is not None
        assert clearance.scene.least is not None
        return clearance.scene.least

    robot = ikplan.load_robot("panda")
    beside = robot.fk(robot.home).act(np.array([0.0, 0.08, 0.1])).tolist()
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.01}, "position": beside}
    scene = {"obstacles": [ball], "self_collision": False}
    still = {"robot": "panda", "waypoints": [robot.home.tolist(), (robot.home + 0.001).tolist()]}
    gaps = {}
    for opened in (0.0, 0.04):
        fingers = {"panda_finger_joint1": opened}  # the other one follows
        timed = client.time({**still, "scene": scene, "fixed_joints": fingers})
        assert timed.certificate.clearance is not None
        gaps[opened] = timed.certificate.clearance.scene.found or 0.0
    assert gaps[0.0] - gaps[0.04] > 0.005, gaps
    closed = panda(scene=scene, fixed_joints={"panda_finger_joint1": 0.0})
    assert client.plan(closed).id == ikplan.plan(closed).id != client.plan(panda(scene=scene)).id
    assert least(closed) > 0.0
    file = tmp_path / "request.json"
    file.write_text(json.dumps(closed))
    assert main(["plan", str(file)]) == 0
    assert ikplan.plan(closed).id in capsys.readouterr().out
    change = "fixed_joints.panda_finger_joint9=0.0"
    assert main(["plan", str(file), "--set", change]) == 2
    assert "panda_finger_joint1" in capsys.readouterr().err


def test_the_command_tells_a_carried_part_that_hits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "request.json"
    file.write_text(json.dumps(way(scene=scene(2))))
    assert main(["plan", str(file)]) == 1
    assert "part and post 2" in capsys.readouterr().err.replace(
        "post 2 and part", "part and post 2"
    )
    change = ["--set", "scene.attached[0].last_segment=1"]
    assert main(["plan", str(file), *change]) == 0
    assert "clearance" in capsys.readouterr().out


def test_a_request_without_a_scene_is_checked_against_the_tool(client: Client) -> None:
    """A tool that reaches back into the arm is refused without any scene."""
    back = {"name": "handle", "shape": {"type": "capsule", "radius": 0.02, "length": 0.6}}
    with pytest.raises(InCollision) as caught:
        client.plan(request(tool={"geometry": [{**back, "position": [0.0, 0.0, -0.3]}]}))
    assert "handle" in caught.value.pair
