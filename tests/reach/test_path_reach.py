"""How much of a path is reached: against the map of single poses, and where it is shifted."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.cli import main
from ikplan.errors import InvalidRequest
from ikplan.reach.path_reach import path_reach
from ikplan.reach.save import save_path_reach


def request(**changes: Any) -> dict[str, Any]:
    """A line outwards, with the tool down."""
    begin, to = (
        {"position": [x, 0.1, 0.2], "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]} for x in (0.5, 0.9)
    )
    path = {"begin": begin, "segments": [{"type": "line", "to": to}], **changes}
    return {"robot": "ur5", "start": "free", "path": path}


SHIFTS = [[0.0, 0.0, 0.0], [-0.2, 0.0, 0.0], [0.2, 0.0, 0.1], [2.0, 0.0, 0.0]]


def test_poses_along_a_shifted_path_are_those_of_the_reach_map() -> None:
    found = path_reach(request(), SHIFTS, poses=9)
    robot = ikplan.load_robot("ur5")
    down = np.diag([1.0, -1.0, -1.0])
    for shift, reached, quality in zip(SHIFTS, found.reached, found.manipulability, strict=True):
        places = np.linspace([0.5, 0.1, 0.2], [0.9, 0.1, 0.2], 9) + shift
        alone = ikplan.reach_map(robot, places, [down])
        np.testing.assert_array_equal(reached, alone.reached[:, 0])
        np.testing.assert_allclose(quality, alone.manipulability[:, 0], equal_nan=True, atol=1e-6)
    assert found.share[1] == 1.0 > found.share[0] > found.share[2] > found.share[3] == 0.0


def test_a_free_orientation_reaches_no_less_and_a_wall_no_more() -> None:
    fixed = path_reach(request(), SHIFTS[:3], poses=9)
    free = path_reach(request(orientation_free="all"), SHIFTS[:3], poses=9)
    assert (free.share >= fixed.share).all()
    assert free.share.sum() > fixed.share.sum()
    wall = {"name": "wall", "shape": {"type": "box", "size": [0.1, 2.0, 2.0]}}
    scene = {"obstacles": [{**wall, "position": [0.6, 0.0, 0.0]}]}
    blocked = path_reach(request(), SHIFTS[:3], poses=9, scene=scene)
    assert (blocked.reached <= fixed.reached).all()
    assert (blocked.in_contact == (fixed.reached & ~blocked.reached)).all()
    assert blocked.in_contact.any()


def test_the_shell_maps_the_shifts_of_a_path(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, table = tmp_path / "in.json", tmp_path / "map.parquet"
    file.write_text(json.dumps(request()))
    words = ["reach", "ur5", "--along", str(file), "--poses", "5", "--quiet", "-o", str(table)]
    words += ["--lower", "-0.2", "0", "0", "--upper", "0.2", "0", "0.1", "--spacing", "0.1"]
    assert main([*words, "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["shifts"] == 10
    assert summary["best"]["reached"] == 1.0
    pq = pytest.importorskip("pyarrow.parquet")
    rows = pq.read_table(table).to_pydict()
    assert len(rows["x"]) == 10
    assert sum(share == 1.0 for share in rows["reached"]) == summary["reached_whole"]
    whole = [value is not None for value in rows["manipulability"]]
    assert whole == [share == 1.0 for share in rows["reached"]]
    assert main(["reach", "ur5", "--along", str(file), "--quiet"]) == 2


def test_what_makes_no_sense_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest, match="poses"):
        path_reach(request(), SHIFTS, poses=1)
    with pytest.raises(InvalidRequest, match="not an id"):
        path_reach({**request(), "scene": "scene-1"}, SHIFTS)
    with pytest.raises(InvalidRequest, match="parquet"):
        save_path_reach(path_reach(request(), SHIFTS[:1], poses=2), tmp_path / "map.csv")
