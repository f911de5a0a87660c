"""Planning scenes of MoveIt: what is read of them, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

import ikplan
from ikplan.documents.scene import Scene
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot, load_robot
from ikplan.scene.model import collision_model

MOVEIT = """
world:
  collision_objects:
    - id: table
      pose: {position: {x: 1.0, y: 0.0, z: 0.0}, orientation: {x: 0, y: 0, z: 0, w: 0}}
      primitives: [{type: 1, dimensions: [1.0, 2.0, 0.1]}]
      primitive_poses: [{position: {x: 0.0, y: 0.5, z: 0.0}}]
    - id: can
      primitives: [{type: cylinder, dimensions: [0.2, 0.03]}, {type: 2, dimensions: [0.05]}]
    - id: wedge
      meshes: [{vertices: [{x: 0, y: 0, z: 0}, {x: 1, y: 0, z: 0}, {x: 0, y: 1, z: 0}]}]
"""


def test_a_planning_scene_of_moveit_is_read(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(MOVEIT)
    scene = ikplan.read_scene(tmp_path / "scene.yaml")
    assert [o.name for o in scene.obstacles] == ["table", "can[0]", "can[1]", "wedge"]
    table, can, ball, wedge = (o.shape.model_dump() for o in scene.obstacles)
    assert table == {"type": "box", "size": [1.0, 2.0, 0.1]}
    assert can == {"type": "cylinder", "radius": 0.03, "length": 0.2}
    assert ball == {"type": "sphere", "radius": 0.05}
    assert wedge["type"] == "convex"
    assert scene.obstacles[0].position == [1.0, 0.5, 0.0]
    assert scene.obstacles[0].quaternion_xyzw == [0.0, 0.0, 0.0, 1.0]


def test_what_a_planning_scene_has_and_is_not_read_is_refused(tmp_path: Path) -> None:
    for text, part in (
        ("world: {collision_objects: [{id: p, planes: [{coef: [0, 0, 1, 0]}]}]}", "planes"),
        ("world: {collision_objects: [{primitives: []}]}", "id"),
        ("world: {collision_objects: [{id: p, primitives: [{type: 9, dimensions: [1]}]}]}", "9"),
        ("[1, 2", "neither JSON nor YAML"),
        ("obstacle: []", "unknown field"),
    ):
        (tmp_path / "scene.yaml").write_text(text)
        with pytest.raises(InvalidRequest, match=part):
            ikplan.read_scene(tmp_path / "scene.yaml")


NAMES = ["<octomap>", "panda_hand", "panda_link0", "panda_link4", "panda_link8", "shelf"]
ALLOWED = {
    ("panda_hand", "panda_link4"),
    ("panda_hand", "panda_link8"),
    ("panda_link0", "shelf"),
}
HEADER = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "panda_link0"}
BOX = {"type": 1, "dimensions": [0.4, 0.4, 0.05]}
POSE = {"position": {"x": 0.5, "y": 0.0, "z": 0.1}, "orientation": {"w": 1.0}}


def matrix(names: list[str], allowed: set[tuple[str, str]]) -> dict[str, Any]:
    rows = [[(a, b) in allowed or (b, a) in allowed for b in names] for a in names]
    return {
        "entry_names": names,
        "entry_values": [{"enabled": row} for row in rows],
        "default_entry_names": [],
        "default_entry_values": [],
    }


def planning_scene(**changes: Any) -> dict[str, Any]:
    """A message as ``ros2 service call /get_planning_scene`` and rosbridge write it."""
    empty: dict[str, Any] = {"header": HEADER, "octomap": {"id": "", "data": []}}
    joints = {"header": HEADER, "name": ["panda_joint1"], "position": [0.0]}
    return {
        "name": "(noname)+",
        "robot_state": {"joint_state": joints, "attached_collision_objects": [], "is_diff": False},
        "robot_model_name": "panda",
        "fixed_frame_transforms": [],
        "allowed_collision_matrix": matrix(NAMES, ALLOWED),
        "link_padding": [{"link_name": "panda_link0", "padding": 0.0}],
        "link_scale": [{"link_name": "panda_link0", "scale": 1.0}],
        "object_colors": [],
        "world": {
            "collision_objects": [
                {"header": HEADER, "pose": POSE, "id": name, "primitives": shapes, "operation": 0}
                for name, shapes in (("shelf", [BOX, BOX]), ("box", [BOX]))
            ],
            "octomap": empty,
        },
        "is_diff": False,
        **changes,
    }


@pytest.fixture(scope="module")
def panda() -> Robot:
    return load_robot("panda")


def read(folder: Path, **changes: Any) -> Scene:
    (folder / "scene.yaml").write_text(yaml.safe_dump(planning_scene(**changes)))
    return ikplan.read_scene(folder / "scene.yaml")


def allowed_pairs(scene: Scene) -> set[tuple[str, ...]]:
    return {tuple(sorted(pair)) for pair in scene.allow}


def test_pairs_of_the_allowed_collision_matrix_may_touch(tmp_path: Path, panda: Robot) -> None:
    scene = read(tmp_path)
    shelf = {("panda_link0", "shelf[0]"), ("panda_link0", "shelf[1]")}
    assert allowed_pairs(scene) == (ALLOWED - {("panda_link0", "shelf")}) | shelf
    model = collision_model(panda, scene)
    names = {frozenset((model.bodies[i].name, model.bodies[j].name)) for i, j in model.pairs}
    assert frozenset(("panda_hand", "shelf[0]")) in names
    assert not names & {frozenset(pair) for pair in allowed_pairs(scene)}
    link = frozenset(("panda_hand", "panda_link4"))
    assert link in {frozenset((a, b)) for a, b, why in model.allowed if why == "the request: allow"}
    alone = collision_model(panda)
    pairs = {frozenset((alone.bodies[i].name, alone.bodies[j].name)) for i, j in alone.pairs}
    assert link in pairs


def test_defaults_count_for_pairs_outside_the_matrix(tmp_path: Path) -> None:
    rows = matrix(["panda_hand", "panda_link0"], set())
    rows["default_entry_names"] = ["box", "shelf", "panda_link0", "panda_hand"]
    rows["default_entry_values"] = [True, True, False, True]
    scene = read(tmp_path, allowed_collision_matrix=rows)
    # panda_link0 says no to both; two obstacles are never checked against each other.
    assert allowed_pairs(scene) == {
        ("box", "panda_hand"), ("panda_hand", "shelf[0]"), ("panda_hand", "shelf[1]"),
    }  # fmt: skip
    rows["default_entry_names"], rows["default_entry_values"] = ["box"], [1]
    scene = read(tmp_path, allowed_collision_matrix=rows)
    assert allowed_pairs(scene) == {("box", "panda_hand"), ("box", "panda_link0")}


def test_an_unknown_name_of_the_matrix_is_refused_with_the_valid_ones(
    tmp_path: Path, panda: Robot
) -> None:
    rows = matrix(["panda_hnd", "box"], {("panda_hnd", "box")})
    scene = read(tmp_path, allowed_collision_matrix=rows)
    with pytest.raises(InvalidRequest, match=r"panda_hnd.*did you mean panda_hand") as caught:
        collision_model(panda, scene)
    assert {"panda_hand", "box", "shelf[0]"} <= set(caught.value.allowed)


def test_matrices_that_make_no_sense_are_refused_by_field(tmp_path: Path) -> None:
    good = matrix(["a", "b"], {("a", "b")})
    where = "allowed_collision_matrix"
    for change, field in (
        ({"entry_names": ["a", "a"]}, f"{where}.entry_names"),
        ({"entry_values": good["entry_values"][:1]}, f"{where}.entry_values"),
        (
            {"entry_values": [{"enabled": [False, True]}, {"enabled": [True]}]},
            f"{where}.entry_values[1].enabled",
        ),
        (
            {"entry_values": [{"enabled": [False, True]}, {"enabled": [False, False]}]},
            f"{where}.entry_values",
        ),
        ({"default_entry_names": ["a"]}, f"{where}.default_entry_values"),
        ({"entry_values": [{"enabled": [False, 7]}, {"enabled": [True, False]}]}, "scene"),
    ):
        with pytest.raises(InvalidRequest) as caught:
            read(tmp_path, allowed_collision_matrix={**good, **change})
        assert caught.value.field == field


def test_what_moveit_would_check_otherwise_is_refused(tmp_path: Path) -> None:
    attached = {"attached_collision_objects": [{"link_name": "panda_hand"}]}
    for change, part in (
        ({"robot_state": attached}, "attached objects are not read"),
        ({"link_padding": [{"link_name": "panda_hand", "padding": 0.01}]}, "link_padding.*0.01"),
        ({"link_scale": [{"link_name": "panda_hand", "scale": 1.1}]}, "link_scale.*1.1"),
    ):
        with pytest.raises(InvalidRequest, match=part):
            read(tmp_path, **change)
