"""Scenes on the command line: files of every kind, and how clearance and contact are printed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import ikplan
from ikplan.plans.summary import certificate_rows
from tests.service.test_scenes import UR5, request, tool_at, wall, written_mesh

from .conftest import Done

Ask = Callable[..., Done]
TABLE: dict[str, Any] = {"name": "table", "shape": {"type": "box", "size": [1.0, 1.0, 0.05]}}
TABLE |= {"position": [0.6, 0.0, -0.3]}


@pytest.fixture
def asked(tmp_path: Path) -> Path:
    file = tmp_path / "request.json"
    file.write_text(json.dumps(request()))
    return file


def written(folder: Path, scene: dict[str, Any]) -> Path:
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return file


MOVEIT = """
world:
  collision_objects:
    - id: table
      header: {frame_id: base_link}
      operation: 0
      primitives: [{type: 1, dimensions: [1.0, 1.0, 0.05]}]
      primitive_poses: [{position: {x: 0.6, y: 0.0, z: -0.3}, orientation: {w: 1.0}}]
"""
CELL = (
    '<robot name="cell"><link name="table"><collision><origin xyz="0.6 0 -0.3"/><geometry>'
    '<box size="1 1 0.05"/></geometry></collision></link></robot>'
)


def test_every_kind_of_scene_file_is_planned_beside(ask: Ask, asked: Path, tmp_path: Path) -> None:
    (tmp_path / "moveit.yaml").write_text(MOVEIT)
    (tmp_path / "cell.urdf").write_text(CELL)
    own = written(tmp_path, {"obstacles": [TABLE]})
    distances = []
    for scene in (own, tmp_path / "moveit.yaml", tmp_path / "cell.urdf"):
        done = ask("plan", asked, "--scene", scene, "-o", tmp_path / "plan.json")
        assert done.code == 0, done.err
        assert "nearest" in done.out
        clearance = ikplan.Plan.load((tmp_path / "plan.json").read_bytes()).certificate.clearance
        assert clearance is not None
        assert clearance.scene.pair is not None
        assert "table" in clearance.scene.pair
        distances.append(clearance.scene.least)
    assert distances == pytest.approx([distances[0]] * 3, abs=2e-3)


def test_the_clearance_told_is_the_least_proven_with_pair_and_time(
    ask: Ask, asked: Path, tmp_path: Path
) -> None:
    done = ask("plan", asked, "-o", tmp_path / "plan.json")
    plan = ikplan.Plan.load((tmp_path / "plan.json").read_bytes())
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert clearance.least is not None
    assert clearance.pair is not None
    (line,) = (line for line in done.out.splitlines() if line.startswith("  clearance "))
    told = float(line.split("at least ")[1].split(" mm")[0]) * 1e-3
    assert clearance.least - 1.01e-5 <= told <= clearance.least
    assert f"at {clearance.time:.2f} s" in line
    assert f"{clearance.pair[0]}, {clearance.pair[1]}" in done.out
    off = ask("plan", asked, "--set", "scene.self_collision=false")
    assert "clearance" not in off.out


def test_links_that_nobody_checked_are_told() -> None:
    plan = ikplan.plan(request())
    clearance = plan.certificate.clearance
    assert clearance is not None
    assert "not checked" not in dict(certificate_rows(plan))
    for links, told in ((["a", "b"], "a, b"), ([str(k) for k in range(11)], " and 3 more")):
        less = clearance.model_copy(update={"unchecked": links, "proven": False})
        certificate = plan.certificate.model_copy(update={"clearance": less})
        rows = dict(certificate_rows(plan.model_copy(update={"certificate": certificate})))
        assert told in rows["not checked"]
        assert rows["clearance"].startswith("not proven")
    none = clearance.model_copy(update={"least": None, "pair": None})
    certificate = plan.certificate.model_copy(update={"clearance": none})
    rows = dict(certificate_rows(plan.model_copy(update={"certificate": certificate})))
    assert rows["clearance"].startswith("nothing checked")


def test_a_contact_is_told_with_pair_place_and_depth(ask: Ask, asked: Path, tmp_path: Path) -> None:
    scene = written(tmp_path, {**wall([0.0, 0.0, 0.0]), "clearance": 0.01, "self_collision": False})
    done = ask("plan", asked, "--scene", scene)
    assert (done.code, done.out) == (1, "")
    first, *more = done.err.splitlines()
    assert first.startswith("ikplan: in-collision: ")
    told = dict(line.strip().split(": ", 1) for line in more if ": " in line)
    assert "wall" in told["bodies"]
    assert told["place"] == "the start"
    assert float(told["depth"].split()[0]) >= 10.0
    assert len(told["joint values there"].split()) == 6
    assert "  contact is proven there" in more


def test_poses_and_timings_take_a_scene(ask: Ask, tmp_path: Path) -> None:
    scene = written(tmp_path, wall([0.0, 0.0, 0.0]))
    position = ["--position", *tool_at([0.0, 0.0, 0.0])]
    assert ask("ik", "ur5", *position).code == 0
    done = ask("ik", "ur5", *position, "--scene", scene)
    assert done.code == 1
    assert "wall" in done.err
    q = UR5.home.tolist()
    rows = tmp_path / "rows.json"
    rows.write_text(json.dumps([q, [q[0] + 0.2, *q[1:]]]))
    free = written(tmp_path, {"obstacles": [TABLE]})
    done = ask("time", "ur5", rows, "--scene", free)
    assert done.code == 0
    assert "clearance" in done.out
    assert "clearance" not in ask("time", "ur5", rows).out
    done = ask("time", "ur5", rows, "--scene", written(tmp_path, wall([0.0, 0.0, 0.0])))
    assert done.code == 1
    assert " s of the motion" in done.err


def test_meshes_of_a_request_are_read_beside_it(
    ask: Ask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "cell"
    folder.mkdir()
    mesh = {"type": "mesh", "file": written_mesh(folder).name, "scale": 0.001}
    part = {"name": "part", "shape": mesh, "position": [0.6, 0.0, -0.3]}
    document = request(scene={"obstacles": [part]}, tool={"geometry": [{**part, "name": "jaw",
                       "position": [0.0, 0.0, 0.06]}]})  # fmt: skip
    (folder / "request.json").write_text(json.dumps(document))
    monkeypatch.chdir(tmp_path)
    done = ask("plan", "cell/request.json", "-o", "plan.json")
    assert done.code == 0, done.err
    made = ikplan.Plan.load((tmp_path / "plan.json").read_bytes())
    monkeypatch.chdir(folder)
    assert ikplan.plan(document).id == made.id


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("gone.yaml", None, "cannot be read"),
        ("scene.json", '{"obstacles": [{"name": "a"}]}', "obstacles[0].shape"),
        ("scene.yaml", "obstacles: [", "neither JSON nor YAML"),
        ("cell.urdf", "<robot", "cell.urdf"),
    ],
)
def test_a_wrong_scene_file_is_one_line(
    ask: Ask, asked: Path, tmp_path: Path, name: str, text: str | None, told: str
) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    done = ask("plan", asked, "--scene", tmp_path / name)
    assert done.code == 2
    assert told in done.err
    assert len(done.err.splitlines()) == 1
