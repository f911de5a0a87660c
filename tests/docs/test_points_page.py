"""What docs/points.md shows is so."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from ikplan.cli import main
from ikplan.points import JointName, Points, Reading, read_points
from ikplan_api.handlers.point_files import PARAMETERS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "points.md").read_text()
TRANSCRIPT = next(iter(re.findall(r"^```\n(\$ cat points.csv.*?)^```$", PAGE, re.M | re.S)))
VALUES = {
    "x": "0.1", "y": "0.2", "z": "0.3", "qw": "1", "q1": "1", "k": "1", "speed": "0.1",
    "zone": "0.01",
}  # fmt: skip


def table(after: str) -> list[list[str]]:
    """The rows of the first table after some words, without its head."""
    text = PAGE.split(after)[1]
    rows = re.findall(r"^\|(.*)\|$", text.partition("\n\n- ")[0].split("\n\n## ")[0], re.M)
    return [[cell.strip() for cell in row.split("|")] for row in rows[2:]]


@pytest.mark.parametrize("row", table("## Columns"), ids=lambda row: row[0])
def test_the_columns_shown_are_read_as_it_says(row: list[str]) -> None:
    names = row[0].strip("`").split(",")
    cells = ",".join(VALUES.get(name, "0") for name in names)
    points = read_points(f"{','.join(names)}\n{cells}\n".encode())
    said = " ".join(note.text for note in points.notes)
    for word in ("ABB", "Universal Robots", "KUKA", "FANUC", "ROS"):
        if word in row[1] and word != "ABB" and "zone" not in names:
            assert word in said
    kinds = {"j1": "joints", "speed": "speeds", "zone": "zones"}
    filled = {kind for name, kind in kinds.items() if name in names} or {"poses"}
    assert all(getattr(points, kind) for kind in filled)
    unit = row[2]
    if unit in ("rad", "deg"):
        assert f"in {unit}" in said


@pytest.mark.parametrize(("largest", "factor"), [("3", 1.0), ("30", 1e-3), ("565", 1e-3)])
def test_units_are_guessed_as_it_says(largest: str, factor: float) -> None:
    points = read_points(f"x,y,z\n{largest},0,0\n".encode())
    assert points.poses[0]["position"][0] == pytest.approx(float(largest) * factor)


def test_the_transcript_is_what_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shown = TRANSCRIPT.splitlines()
    commands = [k for k, line in enumerate(shown) if line.startswith("$ ")]
    assert len(commands) - 1 <= 3  # from install to program; cat only shows the file
    Path("points.csv").write_text("\n".join(shown[1 : commands[1]]) + "\n")
    last = commands[-1]
    assert main(shlex.split(shown[last])[2:]) == 0
    output = capsys.readouterr()
    said = [*output.err.splitlines(), *output.out.splitlines()]
    for line in shown[last + 1 :]:
        words = line.removesuffix("...").strip()
        assert any(s.startswith(words) for s in said), line
    assert Path("program.script").read_text().startswith("def ")


def test_every_option_and_parameter_shown_exists(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["plan", "--help"])
    text = capsys.readouterr().out
    rows = table("## The rest of the request")
    for shell, query, _ in rows:
        for option in re.findall(r"--[a-z-]+", shell):
            assert option in text
        for name in re.findall(r"`([a-z_]+)[=`]", query):
            assert name in PARAMETERS
    shown = {name for row in rows for name in re.findall(r"`([a-z_]+)[=`]", row[1])}
    assert shown == set(PARAMETERS)


def test_other_names_shown_are_known() -> None:
    joints = (JointName("elbow"),)
    spellings = [b"tx,ty,tz", b"pos_x,pos_y,pos_z", b"pose.position.x,pose.position.y,z"]
    for header in spellings:
        assert isinstance(read_points(header + b"\n0.1,0.2,0.3\n"), Points)
    assert read_points(b"/joint_states/elbow/position\n0.1\n", Reading(), joints).joints == [[0.1]]
