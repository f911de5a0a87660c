"""What a scene makes of a robot: bodies, pairs, names; and distances at configurations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene, ToolGeometry
from ikplan.documents.shape import ConvexShape, MeshShape, SphereShape
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot, load_robot
from ikplan.scene.model import collision_model
from ikplan.scene.resolve import resolve_geometry, resolve_scene

BOX = {"type": "box", "size": [0.4, 0.4, 0.1]}
TABLE = {"name": "table", "shape": BOX, "position": [0.5, 0.0, 0.1]}
PART = {"name": "part", "shape": {"type": "sphere", "radius": 0.03}, "position": [0, 0, 0.2]}


@pytest.fixture(scope="module")
def panda() -> Robot:
    return load_robot("panda")


def names(robot: Robot, scene: dict[str, Any] | None = None) -> set[frozenset[str]]:
    """The pairs that are checked, by name."""
    model = collision_model(robot, None if scene is None else parse(Scene, scene))
    return {frozenset((model.bodies[i].name, model.bodies[j].name)) for i, j in model.pairs}


def test_obstacles_are_checked_against_all_that_moves(panda: Robot) -> None:
    alone, among = names(panda), names(panda, {"obstacles": [TABLE]})
    moving = {body.name for body in collision_model(panda).bodies if body.carrier}
    assert among - alone == {frozenset(("table", name)) for name in moving}
    assert alone <= among


def test_no_pair_is_on_one_carrier(panda: Robot) -> None:
    scene = {"obstacles": [TABLE, {**TABLE, "name": "other"}], "attached": [PART]}
    model = collision_model(panda, parse(Scene, scene))
    carrier = np.array([body.carrier for body in model.bodies])
    assert np.all(carrier[model.pairs[:, 0]] != carrier[model.pairs[:, 1]])


def test_without_self_collision_only_the_scene_is_checked(panda: Robot) -> None:
    scene = {"obstacles": [TABLE], "attached": [PART], "self_collision": False}
    assert all("table" in pair for pair in names(panda, scene))


def test_pairs_that_the_request_allows_are_left_out(panda: Robot) -> None:
    pair = frozenset(("table", "panda_hand"))
    scene = {"obstacles": [TABLE], "attached": [PART]}
    assert pair in names(panda, scene)
    assert pair not in names(panda, {**scene, "allow": [["panda_hand", "table"]]})
    touching = {**scene, "attached": [{**PART, "touches": ["table"]}]}
    assert names(panda, scene) - names(panda, touching) == {frozenset(("table", "part"))}
    reasons = collision_model(panda, parse(Scene, touching)).allowed
    assert ("part", "table", "the request: touches") in reasons


@pytest.mark.parametrize(
    ("scene", "field", "near"),
    [
        ({"obstacles": [TABLE], "allow": [["tabel", "panda_hand"]]}, "scene.allow[0]", "table"),
        ({"allow": [["panda_link1", "panda_hnad"]]}, "scene.allow[0]", "panda_hand"),
        ({"attached": [{**PART, "touches": ["tabl"]}], "obstacles": [TABLE]},
         "scene.attached[0].touches", "table"),
        ({"obstacles": [{**TABLE, "name": "panda_link8"}]}, "scene.obstacles", "a link"),
    ],
)  # fmt: skip
def test_unknown_and_taken_names_are_refused(
    panda: Robot, scene: dict[str, Any], field: str, near: str
) -> None:
    with pytest.raises(InvalidRequest, match=near) as caught:
        collision_model(panda, parse(Scene, scene))
    assert caught.value.field == field


def test_the_id_of_a_scene_is_refused_where_no_service_resolves_it(panda: Robot) -> None:
    request = parse(PlanRequest, {"robot": "panda", "scene": "scene-1",
                                  "path": {"waypoints": [{"position": [0, 0, 1]}]}})  # fmt: skip
    with pytest.raises(InvalidRequest, match="scene-1"):
        collision_model(panda, request.scene)


def test_tool_geometry_is_in_the_tip_frame_and_attached_bodies_in_the_tool_frame() -> None:
    robot = load_robot("panda").with_tool([0.0, 0.0, 0.2])
    part = ToolGeometry(
        name="jaw", shape=SphereShape(type="sphere", radius=0.01), position=[0, 0, 0.1]
    )
    model = collision_model(robot, parse(Scene, {"attached": [PART]}), None, [part])
    q = robot.random_configuration(np.random.default_rng(3))
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    T_tip = data.oMf[robot.tip_frame_id]
    for body in model.bodies:
        if body.kind in ("tool", "attached"):
            place = data.oMi[body.carrier].act(body.pieces[0].points[0])
            up = 0.1 if body.kind == "tool" else 0.4
            np.testing.assert_allclose(place, T_tip.act(np.array([0.0, 0.0, up])), atol=1e-12)


def test_padding_enlarges_on_every_side(panda: Robot) -> None:
    plain = {"name": "ball", "shape": {"type": "sphere", "radius": 0.1}, "position": [2.0, 0, 1]}
    gaps = []
    for padding in (0.0, 0.05):
        scene = {"obstacles": [{**plain, "padding": padding}], "self_collision": False}
        gaps.append(panda.clearance(panda.home, scene).distance)
    assert gaps[0] - gaps[1] == pytest.approx(0.05, abs=1e-5)


def test_the_clearance_of_a_sphere_on_the_tool_to_a_wall_is_the_closed_form() -> None:
    robot = load_robot("ur5e").with_tool([0.0, 0.0, 0.3])
    wall = {
        "name": "wall",
        "shape": {"type": "box", "size": [0.2, 20, 20]},
        "position": [5.1, 0, 0],
    }
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.05}}
    others = [body.name for body in collision_model(robot).bodies]
    scene = {
        "obstacles": [wall],
        "attached": [ball],
        "self_collision": False,
        "allow": [["wall", name] for name in others],
    }
    rng = np.random.default_rng(4)
    for _ in range(5):
        q = robot.random_configuration(rng)
        found = robot.clearance(q, scene)
        tool = robot.fk(q).translation
        assert found.pair == ("ball", "wall")
        assert found.distance == pytest.approx(5.0 - tool[0] - 0.05, abs=1e-5)
        np.testing.assert_allclose(found.points[0], tool + np.array([0.05, 0.0, 0.0]), atol=1e-3)
        assert found.points[1][0] == pytest.approx(5.0, abs=1e-5)


def test_a_body_inside_an_obstacle_overlaps(panda: Robot) -> None:
    """Pieces are solid: a small ball inside a link is not free, as it is inside a mesh."""
    hand = panda.fk(panda.home).translation
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.005}, "position": hand.tolist()}
    found = panda.clearance(panda.home, {"obstacles": [ball], "self_collision": False})
    assert found.distance < 0.0
    assert found.pair in {("panda_hand", "ball"), ("panda_link7", "ball")}


def write_cube(path: Path, size: float) -> None:
    """An ASCII STL of a cube from which one side is missing: not closed."""
    c = [(x, y, z) for x in (0, size) for y in (0, size) for z in (0, size)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
    lines = ["solid cube"]
    for a, b, d, e in quads:
        for triangle in ((a, b, d), (a, d, e)):
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += [f"vertex {c[k][0]} {c[k][1]} {c[k][2]}" for k in triangle]
            lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid cube", ""]))


def mesh_scene(**shape: Any) -> Scene:
    return parse(Scene, {"obstacles": [{"name": "cube", "shape": {"type": "mesh", **shape}}]})


def test_a_mesh_file_becomes_its_hull(tmp_path: Path) -> None:
    write_cube(tmp_path / "cube.stl", 200.0)
    (obstacle,) = resolve_scene(mesh_scene(file="cube.stl", scale=0.001), tmp_path).obstacles
    assert obstacle.shape.type == "convex"
    corners = [[x, y, z] for x in (0.0, 0.2) for y in (0.0, 0.2) for z in (0.0, 0.2)]
    np.testing.assert_allclose(sorted(obstacle.shape.points), sorted(corners), atol=1e-7)
    part = ToolGeometry(name="t", shape=MeshShape(type="mesh", file="cube.stl", scale=0.001))
    assert resolve_geometry([part], tmp_path)[0].shape.type == "convex"


def test_meshes_that_cannot_be_used_are_refused_by_field(tmp_path: Path) -> None:
    write_cube(tmp_path / "mm.stl", 20_000.0)
    (tmp_path / "bad.stl").write_bytes(b"solid nothing\n" * 3)
    (tmp_path / "cube.step").write_text("x")
    for shape, folder, part in (
        ({"file": "mm.stl"}, tmp_path, "millimetres"),
        ({"file": "none.stl"}, tmp_path, "cannot be read"),
        ({"file": "bad.stl"}, tmp_path, "file"),
        ({"file": "cube.step"}, tmp_path, ".stl"),
        ({"file": "mm.stl"}, None, "Python, the shell and the client only"),
    ):
        with pytest.raises(InvalidRequest, match=part) as caught:
            resolve_scene(mesh_scene(**shape), folder)
        assert caught.value.field.startswith("scene.obstacles[0].shape")


def test_a_mesh_that_was_not_read_is_no_body(panda: Robot) -> None:
    with pytest.raises(InvalidRequest, match="not read here"):
        collision_model(panda, mesh_scene(file="cube.stl"))


def test_the_urdf_of_a_cell_is_read_with_its_meshes(tmp_path: Path) -> None:
    write_cube(tmp_path / "cube.stl", 0.2)
    (tmp_path / "cell.urdf").write_text(
        '<robot name="cell"><link name="floor"/><link name="post"><collision>'
        '<geometry><box size="0.1 0.1 2"/></geometry></collision><collision>'
        '<origin xyz="0 0 1"/><geometry><mesh filename="cube.stl"/></geometry></collision></link>'
        '<joint name="j" type="fixed"><origin xyz="1 0 1"/><parent link="floor"/>'
        '<child link="post"/></joint></robot>'
    )
    scene = ikplan.read_scene(tmp_path / "cell.urdf")
    assert [o.name for o in scene.obstacles] == ["post[0]", "post[1]"]
    shapes = [o.shape for o in scene.obstacles]
    box, cube = (np.array(s.points) for s in shapes if isinstance(s, ConvexShape))
    np.testing.assert_allclose(
        [box.min(axis=0), box.max(axis=0)], [[0.95, -0.05, 0], [1.05, 0.05, 2]]
    )
    np.testing.assert_allclose(cube.min(axis=0), [1, 0, 2], atol=1e-7)
    (tmp_path / "cube.stl").unlink()
    with pytest.raises(InvalidRequest, match=r"cube\.stl"):
        ikplan.read_scene(tmp_path / "cell.urdf")


def test_our_own_scene_is_read_from_json(tmp_path: Path) -> None:
    document = parse(Scene, {"obstacles": [TABLE], "clearance": 0.01})
    (tmp_path / "scene.json").write_text(document.model_dump_json())
    assert ikplan.read_scene(str(tmp_path / "scene.json")) == document
