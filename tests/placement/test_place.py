"""Placement: what is moved, what is graded, and that the best is a certified plan."""

from __future__ import annotations

import csv
import json
import math
import pickle
from collections.abc import Generator, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import InvalidRequest
from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.executor import run_on
from ikplan.cli import main
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.placement.evaluation import Site
from ikplan.placement.moving import offset_of, replaced
from ikplan.placement.place import Placement, place
from ikplan.placement.save import save_placement
from ikplan.placement.work import PlacementWork
from ikplan.reach.along import poses_along
from ikplan.robots import load_robot

DOWN = [1.0, 0.0, 0.0, 0.0]


def pose(x: float, y: float, z: float = 0.2) -> dict[str, Any]:
    return {"position": [x, y, z], "quaternion_xyzw": DOWN}


def request(**changes: Any) -> dict[str, Any]:
    """A line away from a ur5, which ends out of its reach."""
    return {
        "robot": "ur5",
        "start": "free",
        "path": {"begin": pose(0.7, 0.1), "segments": [{"type": "line", "to": pose(1.1, 0.1)}]},
        **changes,
    }


def site(document: dict[str, Any], **changes: Any) -> Site:
    given: dict[str, Any] = {
        "robot": None, "move": "part", "names": ("x",), "lower": (-0.5,), "upper": (0.1,),
        "aim": "time", **changes,
    }  # fmt: skip
    return Site(parse(PlanRequest, document), **given).checked()


@pytest.fixture(scope="module")
def found() -> Placement:
    return place(request(), {"x": (-0.6, 0.1), "y": (-0.2, 0.2)}, evaluations=10, seed=2, keep=2)


def test_a_path_out_of_reach_is_brought_within_and_the_best_is_certified(found: Placement) -> None:
    assert found.given.outcome == "out-of-reach"
    assert math.isnan(found.given.value)
    assert math.isnan(found.gain)
    best = found.best[0]
    assert best.plan.certificate.valid
    assert best.plan.duration == best.value
    assert ikplan.plan(best.request).id == best.plan.id
    values = [each.value for each in found.best]
    assert values == sorted(values)
    planned = [row.value for row in found.rows if row.outcome == "planned"]
    assert best.value == min(planned)
    assert found.rows[0].values == (0.0, 0.0)


class Here:
    """An executor whose worker is this process."""

    def __init__(self, work: PlacementWork) -> None:
        self.answer = work.answer

    def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
        yield from run_on([self], chunks)

    def close(self) -> None:
        """There is nothing to end."""


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers start in a minute on a busy machine: searches on the executor run here."""

    def executor(on: str, work: PlacementWork, workers: int) -> Here:
        assert pickle.loads(pickle.dumps(work)).site.names == work.site.names
        assert (on, workers) == ("local", 1)
        return Here(work)

    monkeypatch.setattr("ikplan.placement.place.executor_for", executor)


@pytest.mark.usefixtures("here")
def test_the_same_search_finds_the_same_on_an_executor(found: Placement) -> None:
    again = place(
        request(), {"x": (-0.6, 0.1), "y": (-0.2, 0.2)}, evaluations=10, seed=2, keep=2,
        on="local", workers=1,
    )  # fmt: skip
    assert str(again.rows) == str(found.rows)
    assert [each.plan.id for each in again.best] == [each.plan.id for each in found.best]


def test_a_map_has_a_row_for_every_placement(found: Placement, tmp_path: Path) -> None:
    save_placement(found, tmp_path / "map.csv")
    with (tmp_path / "map.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["x"]) for row in rows] == found.values[:, 0].tolist()
    assert [row["outcome"] for row in rows] == [row.outcome for row in found.rows]
    assert {row["value"] == "" for row in rows if row["outcome"] != "planned"} <= {True}
    pq = pytest.importorskip("pyarrow.parquet")
    save_placement(found, tmp_path / "map.parquet")
    table = pq.read_table(tmp_path / "map.parquet").to_pydict()
    assert table["y"] == found.values[:, 1].tolist()
    assert [v is None for v in table["value"]] == [row.outcome != "planned" for row in found.rows]
    with pytest.raises(InvalidRequest, match=r"\.parquet or \.csv"):
        save_placement(found, tmp_path / "map.txt")


def test_more_of_the_path_within_reach_scores_better() -> None:
    looked = [site(request()).evaluate([x]) for x in (0.1, 0.0, -0.4)]
    assert [row.outcome for row in looked] == ["out-of-reach", "out-of-reach", "planned"]
    assert looked[0].reached < looked[1].reached < 1.0
    assert looked[0].score > looked[1].score > looked[2].score == looked[2].value


def test_a_part_turns_about_the_middle_of_its_path_and_takes_its_fixture_along() -> None:
    scene = {
        "obstacles": [
            {"name": name, "shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": p}
            for name, p in (("fixture", [0.9, 0.1, 0.0]), ("wall", [0.0, 0.9, 0.0]))
        ]
    }
    given = site(
        request(scene=scene), names=("z", "yaw"), lower=(0, 0), upper=(1, 4), carried=("fixture",)
    )
    moved = given.at([0.3, math.pi / 2])
    robot = load_robot("ur5")
    before = poses_along(given.request, robot, 5)
    after = poses_along(parse(PlanRequest, moved), robot, 5)
    x = before.positions[:, 0]
    expected = np.column_stack([0.9 + 0.0 * x, 0.1 + x - 0.9, 0.2 + 0.3 + 0.0 * x])
    np.testing.assert_allclose(after.positions, expected, atol=1e-12)
    by_name = {each["name"]: each for each in moved["scene"]["obstacles"]}
    np.testing.assert_allclose(by_name["fixture"]["position"], [0.9, 0.1, 0.3], atol=1e-12)
    np.testing.assert_allclose(by_name["wall"]["position"], [0.0, 0.9, 0.0], atol=1e-12)


def test_a_base_that_moves_is_a_part_and_a_scene_that_move_the_other_way() -> None:
    scene = {"obstacles": [{"name": "wall", "shape": {"type": "sphere", "radius": 0.1},
                            "position": [0.0, 0.9, 0.0]}]}  # fmt: skip
    parsed = parse(PlanRequest, request(scene=scene))
    R, p = offset_of(("x", "y", "roll", "yaw"), (0.1, -0.2, 0.4, 0.7), np.zeros(3))
    moved = replaced(parsed, "base", R, p)
    back = replaced(parse(PlanRequest, moved), "part", R, p, ("wall",))
    for key in ("position", "quaternion_xyzw"):
        np.testing.assert_allclose(
            back["path"]["frame"][key], parsed.model_dump()["path"]["frame"][key], atol=1e-12
        )
    np.testing.assert_allclose(
        back["scene"]["obstacles"][0]["position"], [0.0, 0.9, 0.0], atol=1e-12
    )
    # In the world the wall stays: the base's place plus its turned view is where the wall was.
    seen = np.array(moved["scene"]["obstacles"][0]["position"])
    np.testing.assert_allclose(R @ seen + p, [0.0, 0.9, 0.0], atol=1e-12)


def test_poses_along_a_path_are_even_and_leave_the_way_to_it_out() -> None:
    document = request(start=None)
    found = poses_along(parse(PlanRequest, document), load_robot("ur5"), 5)
    np.testing.assert_allclose(found.positions[:, 0], np.linspace(0.7, 1.1, 5), atol=1e-4)
    np.testing.assert_allclose(found.positions[:, 1], 0.1, atol=1e-4)
    assert found.oriented.all()
    free = request()
    free["path"]["orientation_free"] = {"about": "tool_z"}
    assert not poses_along(parse(PlanRequest, free), load_robot("ur5"), 5).oriented.any()
    joints = {"robot": "ur5", "path": {"segments": [{"type": "joint", "q": [0.0] * 6}]}}
    with pytest.raises(InvalidRequest, match="follows nothing"):
        poses_along(parse(PlanRequest, joints), load_robot("ur5"), 5)


@pytest.mark.parametrize(
    ("bounds", "changes", "field"),
    [
        ({}, {}, "bounds"),
        ({"w": (0, 1)}, {}, "bounds.w"),
        ({"x": (1, 0)}, {}, "bounds.x"),
        ({"x": (0, math.inf)}, {}, "bounds.x"),
        ({"x": 1.0}, {}, "bounds.x"),
        ({"x": (0, 1)}, {"solver": "lm"}, "solver"),
        ({"x": (0, 1)}, {"minimise": "cost"}, "minimise"),
        ({"x": (0, 1)}, {"move": "robot"}, "move"),
        ({"x": (0, 1)}, {"evaluations": 0}, "evaluations"),
        ({"x": (0, 1)}, {"carried": ["jig"]}, "carried"),
        ({"x": (0, 1)}, {"on": "dask"}, "--on"),
    ],
)
def test_what_makes_no_sense_is_refused(
    bounds: dict[str, Any], changes: dict[str, Any], field: str
) -> None:
    with pytest.raises(InvalidRequest) as caught:
        place(request(), bounds, **changes)
    assert caught.value.field == field


@pytest.mark.usefixtures("here")
def test_the_shell_places_in_degrees_and_writes_the_map_and_the_request(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, table, best = (tmp_path / name for name in ("in.json", "map.csv", "best.json"))
    file.write_text(json.dumps(request()))
    words = ["place", str(file), "--x", "-0.5", "-0.4", "--yaw", "-20", "20", "--evaluations", "3"]
    words += ["--solver", "random", "--workers", "1", "-o", str(table), "--best", str(best)]
    assert main([*words, "--json", "--quiet"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["placements"] == 3
    assert summary["gain"] is None
    assert abs(summary["best"][0]["values"]["yaw"]) <= math.radians(20)
    assert ikplan.plan(json.loads(best.read_text())).id == summary["best"][0]["plan"]
    assert len(table.read_text().splitlines()) == 4
    assert main(["place", str(file), "--quiet"]) == 2
    far = ["place", str(file), "--x", "0.3", "0.4", "--evaluations", "2", "--workers", "1"]
    assert main([*far, "--quiet"]) == 1
    assert "no plan (out-of-reach" in capsys.readouterr().out
