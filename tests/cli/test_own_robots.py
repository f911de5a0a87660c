"""Robots of one's own in the shell: brought in one step, and taken as a file by every command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import ikplan
from ikplan.cli import main
from ikplan.cli.requests.robot import _SUFFIXES
from ikplan.robots.loading.sources import SUFFIXES
from tests.two_joints import URDF

CELL = Path(__file__).parents[2] / "examples" / "ur5e_cell" / "cell_description"
XACRO = str(CELL / "urdf" / "cell.urdf.xacro")
ARM = ["--arg", "arm:=ur5e"]


@pytest.fixture(autouse=True)
def own_settings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """An empty folder of settings; returns the folder of robots in it."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "settings"))
    monkeypatch.delenv("IKPLAN_ROBOTS_PATH", raising=False)
    return tmp_path / "settings" / "ikplan" / "robots"


def run(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    assert main(list(arguments)) == code
    output = capsys.readouterr()
    return output.out if code == 0 else output.err


def test_one_command_brings_a_package_and_a_plan_follows(
    capsys: pytest.CaptureFixture[str], own_settings: Path, tmp_path: Path
) -> None:
    said = run(capsys, "robots", "add", str(CELL), "arm:=ur5e")
    for words in (
        "floor -> tool0",
        "shoulder_pan_joint   revolute",
        "velocity: from the xacro file cell.urdf.xacro arm:=ur5e, and joint_limits.yaml",
        "acceleration limits of wrist_1_joint, wrist_2_joint, wrist_3_joint",
        "forward kinematics equal Pinocchio's",
        f"wrote {own_settings / 'cell'}; use it: ikplan plan FILE --robot cell",
    ):
        assert words in said
    assert "cell" in ikplan.robot_names()
    robot = ikplan.load_robot("cell")
    pose = robot.fk(robot.home)
    points = tmp_path / "points.csv"
    rows = ["x,y,z"] + [
        ",".join(f"{v:.6f}" for v in pose.translation + np.array([0, dy, 0])) for dy in (0.0, 0.05)
    ]
    points.write_text("\n".join(rows) + "\n")
    plan = tmp_path / "plan.json"
    run(capsys, "plan", str(points), "--robot", "cell", "--units", "m", "-o", str(plan))
    certificate = json.loads(plan.read_text())["certificate"]
    assert certificate["valid"]
    assert "wrist_1_joint" in certificate["assumptions"][0]


def test_a_robot_that_is_there_is_not_replaced_unasked(
    capsys: pytest.CaptureFixture[str], own_settings: Path, tmp_path: Path
) -> None:
    file = tmp_path / "Two Arm.urdf"
    file.write_text(URDF)
    run(capsys, "robots", "add", str(file))
    assert (own_settings / "two_arm" / "robot.yaml").is_file()
    assert "there is a robot 'two_arm'" in run(capsys, "robots", "add", str(file), code=2)
    assert "there is a robot 'ur5'" in run(
        capsys, "robots", "add", str(file), "--name", "ur5", code=2
    )
    run(capsys, "robots", "add", str(file), "--replace", "--home", "0.5,0.25")
    content = yaml.safe_load((own_settings / "two_arm" / "robot.yaml").read_text())
    assert content["home"] == [0.5, 0.25]
    assert "needs no adding" in run(capsys, "robots", "add", str(own_settings / "two_arm"), code=2)


def test_a_robot_goes_into_the_folder_that_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    done = json.loads(
        run(capsys, "robots", "add", str(file), "--folder", str(tmp_path / "mine"), "--json")
    )
    assert done["written"] == str(tmp_path / "mine" / "two")
    assert done["robot"]["dof"] == 2
    described = json.loads(run(capsys, "robots", done["written"], "--json"))
    assert described["fingerprint"] == done["robot"]["fingerprint"]


def test_every_command_takes_the_same_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    robot = ikplan.load_robot(XACRO, args={"arm": "ur5e"})
    q = [0.1, -1.2, 1.1, 0.2, 0.3, 0.4]
    values = [str(v) for v in q]
    place = robot.fk(q).translation
    assert "floor -> tool0" in run(capsys, "robots", XACRO, *ARM)
    pose = json.loads(run(capsys, "fk", XACRO, *values, *ARM, "--json"))
    np.testing.assert_allclose(pose["position"], place, atol=1e-12)
    found = json.loads(run(capsys, "ik", XACRO, "--position", *map(str, place), *ARM, "--json"))
    np.testing.assert_allclose(robot.fk(found["q"]).translation, place, atol=1e-6)
    rows, timed = tmp_path / "rows.json", tmp_path / "timed.json"
    rows.write_text(json.dumps([q, [v + 0.1 for v in q]]))
    run(capsys, "time", str(rows), "--robot", XACRO, *ARM, "-o", str(timed))
    assert json.loads(timed.read_text())["certificate"]["valid"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fk", XACRO, "0"], "give it as NAME:=VALUE"),
        (["fk", XACRO, "0", "--arg", "arm=ur5e"], "arguments are name:=value"),
        (["robots", "add", XACRO, "arm"], "arguments are name:=value"),
        (["robots", "ur5", "--velocity-default", "90-deg-per-s"], "velocity_default belongs to"),
        (["fk", "ur5", "0", "--home", "x"], "--home: expected numbers"),
        (["fk", "franka", "0"], "'franka' may be fr3 or panda"),
        (["robots", "./nothing.urdf"], "cannot be read"),
    ],
)
def test_what_is_wrong_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    line = run(capsys, *arguments, code=2)
    assert said in line
    assert line.count("\n") == 1


def test_options_of_a_file_need_one(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    request = tmp_path / "request.json"
    request.write_text('{"robot": "ur5"}')
    line = run(capsys, "plan", str(request), "--joint-limits", "x.yaml", code=2)
    assert "--joint-limits belongs to --robot FILE" in line


def test_the_shell_and_the_library_take_the_same_files() -> None:
    assert _SUFFIXES == SUFFIXES
