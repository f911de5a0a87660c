"""The commands, in this process."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.cli import main
from ikplan.documents.plan_request import json_schema
from tests.two_joints import URDF

REQUEST = {
    "robot": "iiwa14",
    "start": [0.0, 0.52, 0.0, -1.57, 0.0, 1.05, 0.0],
    "tool": {"position": [0.0, 0.0, 0.1]},
    "path": {"waypoints": [{"position": [0.6, 0.0, 0.4]}, {"position": [0.6, 0.1, 0.4]}]},
    "sampling": {"rate_hz": 50},
}
Command = Callable[..., str]

POINT = ["--position", "0.4", "0", "0.4"]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Command:
    """Run a command that must succeed; return what it wrote on standard output."""

    def go(*arguments: object) -> str:
        assert main([str(a) for a in arguments]) == 0
        return capsys.readouterr().out

    return go


@pytest.fixture
def fail(capsys: pytest.CaptureFixture[str]) -> Command:
    """Run a command that must fail; return its one line."""

    def go(*arguments: object, code: int = 2) -> str:
        capsys.readouterr()
        assert main([str(a) for a in arguments]) == code
        output = capsys.readouterr()
        assert output.out == ""
        assert output.err.endswith("\n")
        (line,) = output.err.splitlines()
        assert line.startswith("ikplan: ")
        return line.removeprefix("ikplan: ")

    return go


@pytest.fixture
def request_file(tmp_path: Path) -> Path:
    file = tmp_path / "request.json"
    file.write_text(json.dumps(REQUEST))
    return file


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    return file


def test_robots_lists_the_catalogue(run: Command) -> None:
    listing = run("robots")
    assert [line.split()[0] for line in listing.splitlines()[1:]] == ikplan.robot_names()
    names = [r["name"] for r in json.loads(run("robots", "--json"))["robots"]]
    assert names == ikplan.robot_names()


def test_a_robot_is_described_with_limits_in_degrees_and_metres(run: Command) -> None:
    robot = ikplan.load_robot("tiago")
    text = run("robots", "tiago")
    for name, slides, upper in zip(robot.joint_names, robot.prismatic, robot.upper, strict=True):
        (line,) = (row for row in text.splitlines() if row.split()[:1] == [name])
        assert line.endswith(" m" if slides else " deg")
        assert float(line.split()[3]) == pytest.approx(
            upper if slides else np.degrees(upper), abs=6e-3
        )
    document = json.loads(run("robots", "tiago", "--json"))
    assert {**document, "collision": None} == robot.info().model_dump(mode="json")
    for body in document["collision"]["bodies"]:
        rows = [row for row in text.splitlines() if row.split()[:1] == [body["name"]]]
        assert any(body["source"] in row for row in rows)
    for pair in document["collision"]["allowed"]:
        assert f"- {pair['pair'][0]}, {pair['pair'][1]}: {pair['reason']}" in text.splitlines()


def test_a_robot_of_a_file_is_described_too(run: Command, urdf: Path) -> None:
    assert "slide" in run("robots", urdf, "--base", "base", "--tip", "tip")


def test_solvers_are_listed_and_described(run: Command) -> None:
    assert "ik-ba" in run("solvers")
    assert "fmax" in run("solvers", "ik-ba")
    assert json.loads(run("solvers", "ik-ba", "--json"))["name"] == "ik-ba"
    names = [s["name"] for s in json.loads(run("solvers", "--json"))["solvers"]]
    assert {"ik-ba", "lm"} <= set(names)


@pytest.mark.parametrize("q", [
    ["-0.1", "-1.2", "1.5", "0", "1", "0.3"],
    ["-1e-3", "-1.2e+0", "+1.5", "-0", "-.5", "-5."],
])  # fmt: skip
def test_fk_takes_negative_numbers_in_every_spelling(q: list[str], run: Command) -> None:
    document = json.loads(run("fk", "ur5", *q, "--json"))
    pose = ikplan.load_robot("ur5").fk([float(v) for v in q])
    assert np.array_equal(document["position"], pose.translation)
    shown = run("fk", "ur5", *q).splitlines()[0].split()
    assert np.allclose([float(v) for v in shown[-3:]], pose.translation, atol=1e-6)


def test_ik_reaches_the_pose(run: Command) -> None:
    target = ["--position", "-0.4", "-1e-1", "0.4", "--quaternion", "0", "-1", "0", "0"]
    options = ["--start", "-3", "-1.2", "1.5", "-1.5", "-1.5", "0", "--method", "lm", "--seed", "3"]
    document = json.loads(run("ik", "ur5", *target, *options, "--json"))
    pose = ikplan.load_robot("ur5").fk(document["q"])
    assert np.allclose(pose.translation, [-0.4, -0.1, 0.4], atol=1e-6)
    text = run("ik", "ur5", *target, *options)
    assert all(f"{v:.6f}" in text for v in document["q"])


def test_plan_writes_what_it_says(run: Command, request_file: Path, tmp_path: Path) -> None:
    written = [tmp_path / f"plan.{s}" for s in ("json", "csv", "npz")]
    options = [word for file in written for word in ("-o", file)]
    text = run("plan", request_file, *options, "--plot", tmp_path / "plan.png")
    assert "velocity limits" in text
    assert [line.removeprefix("wrote ") for line in text.splitlines() if "wrote" in line] == [
        *map(str, written),
        str(tmp_path / "plan.png"),
    ]
    plan = ikplan.Plan.load(written[0].read_bytes())
    assert plan.id in text
    assert (tmp_path / "plan.png").read_bytes().startswith(b"\x89PNG")


def test_plan_reads_standard_input_and_prints_the_document(
    run: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream = io.TextIOWrapper(io.BytesIO(json.dumps(REQUEST).encode()))
    monkeypatch.setattr("sys.stdin", stream)
    assert ikplan.Plan.load(run("plan", "-", "--json")).robot == "iiwa14"


def test_plan_for_the_robot_of_a_file(run: Command, urdf: Path, tmp_path: Path) -> None:
    request = tmp_path / "request.json"
    path = {"waypoints": [{"position": [0.4, 0.2, 0.0]}]}
    request.write_text(json.dumps({"robot": "any", "start": [0.0, 0.1], "path": path}))
    out = tmp_path / "plan.json"
    options = ["--robot", urdf, "--base", "base", "--tip", "tip", "-o", out]
    run("plan", request, *options, "--plot", tmp_path / "plan.svg")
    plan = ikplan.Plan.load(out.read_bytes())
    assert plan.robot == "two"
    assert plan.joint_units == ["rad", "m"]
    x, y = 0.4, 0.2
    assert np.allclose(plan.waypoints.q[-1], [np.arctan2(y, x), np.hypot(x, y) - 0.3], atol=1e-6)


def test_a_joint_path_is_timed_for_the_robot_of_a_file(
    run: Command, fail: Command, urdf: Path, tmp_path: Path
) -> None:
    rows, document = tmp_path / "rows.csv", tmp_path / "request.json"
    rows.write_text("0,0.1\n1,0.4\n")
    waypoints = [[0.0, 0.1], [1.0, 0.4]]
    document.write_text(json.dumps({"robot": "any", "waypoints": waypoints}))
    options = ["--robot", urdf, "--base", "base", "--tip", "tip"]
    plot = tmp_path / "timing.svg"
    timed = [
        ikplan.Plan.load(run("time", file, *options, "--json", "--plot-timing", plot))
        for file in (rows, document)
    ]
    assert timed[0].id == timed[1].id
    assert timed[0].robot == "two"
    assert np.array_equal(timed[0].q[[0, -1]], waypoints)
    for limits in ({"torque": True}, {"torque": [5.0, 5.0]}):
        document.write_text(json.dumps({"robot": "any", "waypoints": waypoints, "limits": limits}))
        line = fail("time", document, *options)
        assert line.startswith("invalid-request: limits.torque: two has no sourced inertias")
    assert "a name, or --robot FILE" in fail("time", rows)
    assert "a name, or --robot FILE" in fail("time", "ur5", rows, *options)
    unreachable = fail("time", rows, *options, "-q", "--server", "http://127.0.0.1:1", code=3)
    assert unreachable.startswith("service-unavailable")


def test_schema_is_the_requests(run: Command) -> None:
    assert json.loads(run("schema")) == json_schema()


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_help_and_version_are_printed(option: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main([option])
    assert caught.value.code == 0
    assert "ikplan" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "slug", "words"),
    [
        ([], "invalid-request", "COMMAND"),
        (["fly"], "invalid-request", "fly"),
        (["fk", "ur5"], "invalid-request", "Q"),
        (["fk", "ur5", "x"], "invalid-request", "x"),
        (["fk", "ur5", "0", "0"], "invalid-request", "6"),
        (["fk", "ur5", *["nan"] * 6], "invalid-request", "q[0]"),
        (["fk", "ur5", *["-inf"] * 6], "invalid-request", "q[0]"),
        (["fk", "ur7", "0"], "robot-not-found", "ur5"),
        (["robots", "ur7"], "robot-not-found", "ur5"),
        (["robots", "/no/such.urdf"], "invalid-robot", "/no/such.urdf"),
        (["solvers", "ik-bat"], "invalid-request", "ik-ba"),
        (["ik", "ur5"], "invalid-request", "--position"),
        (["ik", "ur5", "--pos", "1", "2", "3"], "invalid-request", "--position"),
        (["ik", "ur5", "--position", "9", "0", "0"], "unreachable", "mm"),
        (["ik", "ur5", *POINT, "--method", "x"], "invalid-request", "ik-ba"),
        (["ik", "ur5", *POINT, "--seed", "-1"], "invalid-request", "seed"),
        (["plan", "/no/such.json"], "file-error", "/no/such.json: No such file"),
        (["plan", "/"], "file-error", "/: Is a directory"),
        (["plan", "x", "-o", "plan.xlsx"], "invalid-request", ".npz"),
        (["plan", "x", "--plot", "plan.bmp"], "invalid-request", ".png"),
        (["serve", "--port", "99999"], "invalid-request", "65535"),
        (["serve", "--port", "x"], "invalid-request", "x"),
        (["serve", "--host", "203.0.113.7"], "file-error", "cannot listen on 203.0.113.7"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_that_helps(
    arguments: list[str], slug: str, words: str, fail: Command
) -> None:
    line = fail(*arguments, code=1 if slug == "unreachable" else 2)
    assert line.startswith(f"{slug}: ")
    assert words in line


def test_mistakes_with_files_are_one_line_too(
    fail: Command, request_file: Path, urdf: Path
) -> None:
    assert fail("plan", request_file, "-o", "/no/such/folder/plan.json").startswith("file-error")
    nowhere = ("--server", "http://127.0.0.1:1")
    line = fail("plan", request_file, "--robot", urdf, *nowhere, code=3)
    assert line.startswith("service-unavailable")
    own = urdf.parent / "own"
    own.mkdir()
    (own / "robot.yaml").write_text("name: own")
    assert "its URDF can" in fail("plan", request_file, "--robot", own, *nowhere)
    assert "--robot" in fail("plan", request_file, "--tip", "tip")
    for url in ("http://127.0.0.1:1", "nowhere"):
        line = fail("plan", request_file, "--server", url, code=3)
        assert line.startswith("service-unavailable")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ((URDF, "this is no XML"), "not XML"),
        (('lower="-3" upper="3"', 'lower="3" upper="-3"'), "shoulder"),
        (('xyz="0 0 1"', 'xyz="0 0 0"'), "shoulder"),
        (('velocity="2"', 'velocity="0"'), "shoulder"),
    ],
)
def test_a_bad_robot_file_is_one_line_that_names_the_joint(
    change: tuple[str, str], words: str, fail: Command, request_file: Path, urdf: Path
) -> None:
    urdf.write_text(URDF.replace(*change))
    line = fail("plan", request_file, "--robot", urdf, "--base", "base", "--tip", "tip")
    assert line.startswith("invalid-robot: ")
    assert words in line


def test_a_tip_that_is_not_there_lists_those_that_are(
    fail: Command, request_file: Path, urdf: Path
) -> None:
    line = fail("plan", request_file, "--robot", urdf, "--base", "base", "--tip", "tipp")
    assert line.startswith("invalid-robot: ")
    assert "tipp" in line
    assert "arm" in line


def test_what_cannot_be_shown_is_not_shown(fail: Command) -> None:
    line = fail("robots", "ur\x1b[31m5\nx")
    assert "\x1b" not in line


def command(*arguments: str, **options: Any) -> subprocess.Popen[bytes]:
    started: subprocess.Popen[bytes] = subprocess.Popen(
        [sys.executable, "-m", "ikplan", *arguments], **options
    )
    return started


def test_a_reader_that_leaves_early_is_no_error() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with command("schema", stdout=writing, stderr=subprocess.PIPE) as process:
        os.close(writing)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 141
    assert said == b""


def test_output_fits_a_terminal_that_knows_only_ascii() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with command("robots", "nö", env=environment, **pipes) as process:
        _, said = process.communicate(timeout=60)
    assert process.returncode == 2
    assert b"robot-not-found" in said
    assert b"Traceback" not in said
