"""Scenes as documents: what is refused, in bounded time, and what keeps its id."""

from __future__ import annotations

import time
from typing import Any

import pytest

from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.requests.ik import IkRequest
from ikplan.documents.scene import Scene
from ikplan.documents.timing_request import TimingRequest
from ikplan.errors import InvalidRequest

BOX = {"type": "box", "size": [1.0, 0.8, 0.05]}
PLAN = {"robot": "panda", "path": {"waypoints": [{"position": [0.5, 0, 0.5]}]}}
TIMING = {"robot": "panda", "waypoints": [[0.0] * 7]}


def refused(document: dict[str, Any]) -> InvalidRequest:
    with pytest.raises(InvalidRequest) as caught:
        parse(Scene, document)
    return caught.value


def obstacle(shape: dict[str, Any], **fields: Any) -> dict[str, Any]:
    return {"obstacles": [{"name": "thing", "shape": shape, **fields}]}


@pytest.mark.parametrize(
    ("document", "field"),
    [
        (obstacle({**BOX, "size": [1.0, 0.0, 1.0]}), "obstacles[0].shape.size[1]"),
        (obstacle({**BOX, "size": [1.0, -1.0, 1.0]}), "obstacles[0].shape.size[1]"),
        (obstacle({**BOX, "size": [1.0, 1.0]}), "obstacles[0].shape.size"),
        (obstacle({"type": "sphere", "radius": float("nan")}), "obstacles[0].shape.radius"),
        (obstacle({"type": "sphere", "radius": float("inf")}), "obstacles[0].shape.radius"),
        (obstacle({"type": "sphere", "radius": 1, "height": 2}), "obstacles[0].shape.height"),
        (obstacle({"type": "cylinder", "radius": 1}), "obstacles[0].shape.length"),
        (obstacle({"type": "cone", "radius": 1}), "obstacles[0].shape.type"),
        (obstacle({"type": "convex", "points": []}), "obstacles[0].shape.points"),
        (obstacle({"type": "mesh"}), "obstacles[0].shape.file"),
        (obstacle({"type": "mesh", "file": "a.stl", "id": "m"}), "obstacles[0].shape.id"),
        (obstacle(BOX, quaternion_xyzw=[0, 0, 0, 2]), "obstacles[0].quaternion_xyzw"),
        (obstacle(BOX, padding=-0.1), "obstacles[0].padding"),
        (obstacle(BOX, colour="red"), "obstacles[0].colour"),
        ({"obstacle": []}, "obstacle"),
        ({"clearance": -1.0}, "clearance"),
        ({"allow": [["a"]]}, "allow[0]"),
        ({"attached": [{"name": "p", "shape": BOX, "first_segment": 3, "last_segment": 2}]},
         "attached[0]"),
    ],
)  # fmt: skip
def test_a_wrong_scene_is_refused_by_field(document: dict[str, Any], field: str) -> None:
    assert refused(document).field == field


@pytest.mark.parametrize(
    "document",
    [
        obstacle({**BOX, "size": [1500.0, 1.0, 1.0]}),
        obstacle(BOX, position=[0.0, 1500.0, 0.0]),
        obstacle({"type": "convex", "points": [[0, 0, 1500.0]]}),
        obstacle({"type": "sphere", "radius": 1500.0}),
    ],
)
def test_millimetres_are_told_so(document: dict[str, Any]) -> None:
    assert "1500 looks like millimetres: 1.5 m" in refused(document).detail


def test_two_bodies_cannot_share_a_name() -> None:
    one = {"name": "a", "shape": BOX}
    assert "'a'" in refused({"obstacles": [one], "attached": [one]}).detail


@pytest.mark.parametrize(
    "document",
    [
        {"obstacles": [{"name": str(k), "shape": BOX} for k in range(100_000)]},
        {"obstacles": [{"name": str(k),
                        "shape": {"type": "convex", "points": [[0.0, 0.0, 0.0]] * 60_000}}
                       for k in range(2)]},
        obstacle({"type": "points", "radius": 0.1, "points": [[0.0, 0.0, 0.0]] * 100_001}),
    ],
    ids=["obstacles", "points in all", "points of one"],
)  # fmt: skip
def test_too_much_is_refused_soon(document: dict[str, Any]) -> None:
    began = time.process_time()
    assert "at most" in refused(document).detail or "may have" in refused(document).detail
    assert time.process_time() - began < 5.0


def test_ids_without_scene_fixed_joints_and_geometry_are_as_they_were() -> None:
    """The ids of these requests before there were such fields; plans switch the check off."""
    off = {"self_collision": False}
    plan = parse(PlanRequest, {**PLAN, "scene": off, "tool": {"position": [0, 0, 0.1]}})
    assert plan.content_hash("a") == "d6d6dc6d625d7ffc199db161a42193f4"
    assert parse(TimingRequest, TIMING).content_hash("a") == "0a1cf1fa93f9d4788beb83d8f0020485"


@pytest.mark.parametrize(("model", "document"), [(PlanRequest, PLAN), (TimingRequest, TIMING)])
def test_a_scene_fixed_joints_and_geometry_count_in_the_id(
    model: type[PlanRequest] | type[TimingRequest], document: dict[str, Any]
) -> None:
    geometry = [{"name": "gripper", "shape": BOX}]
    changes: list[dict[str, Any]] = [
        {},
        {"scene": {}},
        {"scene": "scene-1"},
        {"scene": {"clearance": 0.01}},
        {"scene": {"self_collision": False}},
        {"fixed_joints": {"panda_finger_joint1": 0.0}},
        {"tool": {"geometry": geometry}},
    ]
    ids = [parse(model, {**document, **change}).content_hash("a") for change in changes]
    # A plan without a scene is checked against itself, as with an empty one; a timing is not.
    same = 1 if model is PlanRequest else 0
    assert (ids[0] == ids[1]) == bool(same)
    assert len(set(ids)) == len(ids) - same
    assert parse(model, {**document, "scene": None}).content_hash("a") == ids[0]


def test_the_names_of_a_tool_are_its_own() -> None:
    part = {"name": "jaw", "shape": BOX}
    with pytest.raises(InvalidRequest, match="'jaw'") as caught:
        parse(IkRequest, {"robot": "panda", "position": [0, 0, 0],
                          "tool": {"geometry": [part, part]}})  # fmt: skip
    assert caught.value.field == "tool.geometry"
