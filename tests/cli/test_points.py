"""From a file of points to a plan in the shell."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.cli.requests.changes import merged, set_values
from tests.two_joints import URDF

from .conftest import Done

Ask = Callable[..., Done]

POINTS = "x,y,z,rx,ry,rz\n400,-100,300,3.1415927,0,0\n400,100,300,3.1415927,0,0\n"


@pytest.fixture
def points(tmp_path: Path) -> Path:
    file = tmp_path / "points.csv"
    file.write_text(POINTS)
    return file


def test_a_file_of_points_becomes_a_program(ask: Ask, points: Path, tmp_path: Path) -> None:
    program = tmp_path / "program.script"
    document = tmp_path / "plan.json"
    options = ["--robot", "ur5", "--interpolation", "line", "-o", program, "-o", document]
    done = ask("plan", points, *options)
    assert done.code == 0
    assert program.read_text().startswith("def ")
    assert "lengths read as millimetres, because" in done.err
    assert "Universal Robots" in done.err
    plan = ikplan.Plan.load(document.read_bytes())
    ur5 = ikplan.load_robot("ur5")
    placed = [ur5.fk(q).translation for q in plan.waypoints.q]
    np.testing.assert_allclose(placed, [[0.4, -0.1, 0.3], [0.4, 0.1, 0.3]], atol=1e-4)
    path = {"waypoints": ikplan.read_waypoints(points), "interpolation": "line"}
    assert plan.id == ikplan.plan({"robot": "ur5", "path": path}).id


def test_standard_input_and_output_take_points_and_plans(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream = io.TextIOWrapper(io.BytesIO(POINTS.encode()))
    monkeypatch.setattr("sys.stdin", stream)
    done = ask("plan", "-", "--robot", "ur5", "--rate", "50", "-o", "-", "--format", "csv")
    assert done.code == 0
    rows = done.out.splitlines()
    assert rows[0].startswith("time [s],q shoulder_pan_joint [rad]")
    assert float(rows[2].split(",")[0]) == pytest.approx(0.02)
    assert "certified" in done.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "give one (--robot NAME)"),
        (["--robot", "ur7"], "ur5"),
        (["--robot", "ur5", "--units", "ft"], "m, mm, cm"),
        (["--robot", "ur5", "--units", "mm", "--columns", "x,y,z"], "6 values for 3 columns"),
        (["--robot", "ur5", "--interpolation", "arc"], "joint, line, spline"),
        (["--robot", "ur5", "--tool", "0", "0"], "not 2 numbers"),
        (["--robot", "ur5", "--start", "anywhere"], "home, free or joint values"),
        (["--robot", "ur5", "--base-frame", "bse"], "did you mean 'base'?"),
        (["--robot", "eod_arm", "--base-frame", "controller"], "base_link"),
        (["--robot", "ur5", "--set", "path"], "path.to.field=value"),
        (["--robot", "ur5", "--set", "path.waypoints.x=1"], "an object before it"),
        (["--robot", "ur5", "--set", "path.tolerence=1"], "did you mean 'tolerance'?"),
        (["--robot", "ur5", "--repair", "0"], "count from 1"),
        (["--robot", "ur5", "--format", "csv"], "-o FILE"),
        (["--robot", "ur5", "-o", "-", "--json"], "standard output takes one"),
        (["--robot", "ur5", "-q", "-v"], "not allowed with"),
    ],
)
def test_options_that_are_wrong_are_refused(
    arguments: list[str], words: str, ask: Ask, points: Path
) -> None:
    done = ask("plan", points, *arguments)
    assert done.code == 2
    assert words in done.err.splitlines()[-1]


def test_a_format_that_a_robot_cannot_have_is_refused_before_the_work(
    ask: Ask, points: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ikplan.cli.planning._make", pytest.fail)
    for output in (["-o", "x.script"], ["-o", "-", "--format", "urscript"]):
        done = ask("plan", points, "--robot", "panda", *output)
        assert done.code == 2
        assert "URScript program" in done.err


def test_the_frame_and_the_tool_of_a_pendant(ask: Ask, points: Path) -> None:
    tool = ["--tool", "0", "0.01", "0.1", "0.5", "-0.2", "0.1"]
    frame = ["--base-frame", "base", "--frame", "0", "0", "0.05"]
    done = ask("plan", points, "--robot", "ur5", *tool, *frame, "--start", "free", "--json")
    assert done.code == 0
    plan = ikplan.Plan.load(done.out)
    tip = pin.SE3(pin.exp3(np.array([0.5, -0.2, 0.1])), np.array([0.0, 0.01, 0.1]))
    # The pendant's base is turned by 180 degrees about z against that of the URDF.
    base = pin.SE3(np.diag([-1.0, -1.0, 1.0]), np.array([0.0, 0.0, 0.05]))
    asked = pin.SE3(pin.exp3(np.array([3.1415927, 0, 0])), np.array([0.4, -0.1, 0.3]))
    ur5 = ikplan.load_robot("ur5")
    placed = ur5.fk(plan.waypoints.q[0]) * tip
    assert np.linalg.norm(pin.log6((base * asked).actInv(placed)).vector) < 1e-6


def test_joint_values_by_name_become_a_plan_or_a_timing(ask: Ask, tmp_path: Path) -> None:
    ur5 = ikplan.load_robot("ur5")
    names = list(ur5.joint_names)
    file = tmp_path / "joints.csv"
    home = np.degrees(ur5.home)
    steps = ([0] * 6, [10, 0, 0, 0, 0, 20], [10, 5, 0, 0, 0, -20])
    rows = [home + np.array(step) for step in steps]
    order = [4, 2, 0, 1, 3, 5]
    lines = [",".join(["t [s]", *(f"{names[k]} [deg]" for k in order)])]
    lines += [",".join([str(t), *(str(row[k]) for k in order)]) for t, row in enumerate(rows)]
    file.write_text("\n".join(lines))
    planned = ask("plan", file, "--robot", "ur5", "--json")
    assert planned.code == 0
    assert "times are not kept" in planned.err
    plan = ikplan.Plan.load(planned.out)
    np.testing.assert_allclose(plan.waypoints.q, np.radians(rows), atol=1e-12)
    timed = ask("time", "ur5", file, "--json")
    assert timed.code == 0
    np.testing.assert_allclose(
        ikplan.Plan.load(timed.out).waypoints.q, np.radians(rows), atol=1e-12
    )


def test_a_robot_of_a_file_names_the_joints_of_the_points(ask: Ask, tmp_path: Path) -> None:
    urdf, file = tmp_path / "two.urdf", tmp_path / "joints.csv"
    urdf.write_text(URDF)
    file.write_text("slide [mm],shoulder [deg]\n100,0\n400,45\n")
    frames = ["--base", "base", "--tip", "tip", "--start", "0", "0.1"]
    done = ask("plan", file, "--robot", urdf, *frames, "--json")
    assert done.code == 0, done.err
    plan = ikplan.Plan.load(done.out)
    np.testing.assert_allclose(plan.waypoints.q, [[0, 0.1], [np.pi / 4, 0.4]], atol=1e-12)


def test_options_for_the_path_change_a_request_too(ask: Ask, tmp_path: Path) -> None:
    waypoints = [{"position": [0.4, y, 0.3], "quaternion_xyzw": [1, 0, 0, 0]} for y in (-0.1, 0.1)]
    file = tmp_path / "request.json"
    file.write_text(json.dumps({"robot": "iiwa14", "path": {"waypoints": waypoints}}))
    options = ["--robot", "ur5", "--interpolation", "line", "--free-axis", "z", "--start", "free"]
    options += ["--set", "limits.tool_speed=0.1", "--set", "path.waypoints[1].position=[0.4,0,0.3]"]
    done = ask("plan", file, *options, "--rate", "100", "--json")
    assert done.code == 0, done.err
    waypoints[1]["position"] = [0.4, 0, 0.3]
    same = ikplan.plan(
        {
            "robot": "ur5",
            "start": "free",
            "path": {
                "waypoints": waypoints,
                "interpolation": "line",
                "orientation_free": {"about": "tool_z"},
            },
            "limits": {"tool_speed": 0.1},
            "sampling": {"rate_hz": 100.0},
        }
    )
    assert ikplan.Plan.load(done.out).id == same.id
    assert "--units belongs to a file of points" in ask("plan", file, "--units", "mm").err


def test_values_are_set_where_their_path_leads() -> None:
    document = {"a": {"b": [1, {"c": 2}]}}
    set_values(document, ["a.b[1].c=[3, 4]", "d.e=text", 'f="1"', "g=null", "g.h=true"])
    assert document == {
        "a": {"b": [1, {"c": [3, 4]}]},
        "d": {"e": "text"},
        "f": "1",
        "g": {"h": True},
    }
    assert merged({"a": {"b": 1, "c": 2}, "d": 3}, {"a": {"b": {"x": 1}}, "e": 4}) == {
        "a": {"b": {"x": 1}, "c": 2},
        "d": 3,
        "e": 4,
    }
