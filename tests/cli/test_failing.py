"""How commands fail: exit codes, repairs, problem documents; and what they tell beside."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import ikplan
from ikplan import errors
from ikplan.cli.terminal import failing
from ikplan.cli.terminal.failing import INTERNAL, NO_PLAN, WRONG_INPUT

from .conftest import Done

Ask = Callable[..., Done]

FAR = "x_m,y_m,z_m\n400,-100,300\n400,100,300\n"
NEAR = "x,y,z\n400,-100,300\n400,100,300\n"


@pytest.fixture
def far(tmp_path: Path) -> Path:
    file = tmp_path / "far.csv"
    file.write_text(FAR)
    return file


def test_a_refusal_prints_its_repairs_and_one_is_applied(ask: Ask, far: Path) -> None:
    refused = ask("plan", far, "--robot", "ur5")
    assert refused.code == NO_PLAN
    assert refused.out == ""
    assert "are the coordinates millimetres?" in refused.err
    assert "repair 1: read the coordinates as millimetres" in refused.err
    repaired = ask("plan", far, "--robot", "ur5", "--repair", "1", "--json")
    assert repaired.code == 0
    near = far.with_name("near.csv")
    near.write_text(NEAR)
    assert (
        ikplan.Plan.load(repaired.out).id
        == ikplan.Plan.load(ask("plan", near, "--robot", "ur5", "--json", "--repair", "1").out).id
    )
    missing = ask("plan", far, "--robot", "ur5", "--repair", "7")
    assert missing.code == NO_PLAN
    assert "there is no repair 7" in missing.err


def test_json_prints_the_problem_document_of_a_failure(ask: Ask, far: Path) -> None:
    refused = ask("plan", far, "--robot", "ur5", "--json")
    problem = json.loads(refused.out)
    assert problem["type"] == "urn:ikplan:unreachable"
    assert problem["status"] == 422
    assert problem["repairs"][0]["change"]["path"]["waypoints"][0]["position"] == [0.4, -0.1, 0.3]
    assert json.loads(ask("fk", "ur7", "0", "--json").out)["near"]
    assert json.loads(ask("fly", "--json").out)["type"] == "urn:ikplan:invalid-request"
    assert json.loads(ask("plan", "/no/such", "--json").out)["title"] == "File error"
    unreached = ask("ik", "ur5", "--position", "9", "0", "0", "--json")
    assert unreached.code == NO_PLAN
    assert json.loads(unreached.out)["position_error"] > 1.0


def test_a_fault_of_ours_has_its_own_exit_code_and_is_told_in_full(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_: object) -> None:
        raise ZeroDivisionError("no such luck")

    monkeypatch.setattr("ikplan.cli.catalogue.schema", broken)
    done = ask("schema")
    assert done.code == INTERNAL
    assert "Traceback" in done.err
    assert done.err.splitlines()[-1].startswith("ikplan: internal-fault: ZeroDivisionError")


ARGUMENTS: dict[str, dict[str, object]] = {
    "RobotNotFound": {"name": "x"},
    "PlanNotFound": {"id": "x"},
    "Unreachable": {
        "waypoint": 0, "position_error": 1.0, "orientation_error": None, "q": [], "reason": "",
    },
    "Disconnected": {"waypoints": [0, 1], "jump": 1.0},
    "BudgetExceeded": {"stage": "ik", "budget_s": 1.0},
    "MemoryExceeded": {"stage": "ik", "limit_bytes": 1},
    "WorkerLost": {"exit_code": 1},
    "CertificateViolated": {"certificate": {}},
    "RateLimited": {"limit": "x", "retry_after_s": 1.0},
}  # fmt: skip
CODES = {
    "InvalidRequest": WRONG_INPUT, "RobotNotFound": WRONG_INPUT, "InvalidRobot": WRONG_INPUT,
    "PlanNotFound": WRONG_INPUT,
    "Unreachable": NO_PLAN, "Disconnected": NO_PLAN, "TimingFailed": NO_PLAN,
    "BudgetExceeded": NO_PLAN, "InCollision": NO_PLAN,
    "AccessDenied": INTERNAL, "RateLimited": INTERNAL, "ServiceUnavailable": INTERNAL,
    "MemoryExceeded": INTERNAL, "WorkerLost": INTERNAL, "CertificateViolated": INTERNAL,
}  # fmt: skip


@pytest.mark.parametrize("name", [name for name in CODES if hasattr(errors, name)])
def test_every_class_of_error_has_its_exit_code(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    error = getattr(errors, name)("why", **ARGUMENTS.get(name, {}))
    assert failing.fail(error, as_json=False) == CODES[name]
    assert capsys.readouterr().err == f"ikplan: {error.slug}: why\n"


def test_fk_warns_of_values_that_seem_to_be_degrees(ask: Ask) -> None:
    degrees = ["0", "0", "0", "-90", "0", "90", "0"]
    done = ask("fk", "panda", *degrees)
    assert done.code == 0
    assert "panda_joint4 = -90 rad is outside its limits" in done.err
    assert "--angles deg" in done.err
    right = ask("fk", "panda", *degrees, "--angles", "deg")
    assert right.err == ""
    assert right.out != done.out
    slightly = ask("fk", "panda", "0", "0", "0", "0.5", "0", "1", "0")
    assert "panda_joint4 = 0.5 rad" in slightly.err
    assert "deg" not in slightly.err
    assert "--angles" in ask("fk", "panda", *degrees, "--angles", "grad").err


def test_silence_and_chatter(ask: Ask, far: Path) -> None:
    options = [far, "--robot", "ur5", "--units", "m", "--repair", "1"]
    quiet = ask("plan", *options, "-q")
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    told = ask("plan", *options, "-v")
    assert "loading ..." in told.err
    assert "took ik" in told.err
    assert "loading" not in ask("plan", *options).err  # stderr is no terminal


def test_people_get_a_sign_of_life(ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    pose = ["--position", "0.4", "0", "0.4"]
    assert ask("ik", "ur5", *pose).err == ""
    monkeypatch.setattr("ikplan.cli.terminal.telling.sys.stderr.isatty", lambda: True)
    assert ask("ik", "ur5", *pose).err == "ikplan: loading ...\n"
    assert ask("ik", "ur5", *pose, "-q").err == ""


def test_fk_does_not_load_the_planner() -> None:
    code = (
        "import sys; from ikplan.cli import main; main(['fk', 'ur5', *'000000']); "
        "print([m for m in sys.modules if m in ('numba', 'scipy', 'toppra', 'matplotlib')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=100
    )
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
def test_the_script_of_completion_is_one_of_its_shell(shell: str, ask: Ask) -> None:
    done = ask("completion", shell)
    assert done.code == 0
    assert "completion" in done.out
    if shutil.which(shell) is not None:
        checked = subprocess.run([shell, "-n"], input=done.out.encode(), capture_output=True)
        assert checked.returncode == 0, checked.stderr


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash completes")
def test_bash_completes_commands_options_and_files(ask: Ask, tmp_path: Path) -> None:
    script = tmp_path / "ikplan.bash"
    script.write_text(ask("completion", "bash").out)
    (tmp_path / "points.csv").touch()

    def completed(*words: str) -> set[str]:
        quoted = " ".join(f"'{w}'" for w in words)
        code = (
            f"source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; "
            '_shtab_ikplan; printf "%s\\n" "${COMPREPLY[@]}"'
        )
        done = subprocess.run(
            ["bash", "-c", code], capture_output=True, text=True, cwd=tmp_path, env={**os.environ}
        )
        return set(done.stdout.split())

    assert {"plan", "robots", "completion"} <= completed("ikplan", "")
    assert "--free-axis" in completed("ikplan", "plan", "--f")
    assert "points.csv" in completed("ikplan", "plan", "po")


def test_an_unknown_shell_is_refused(ask: Ask) -> None:
    done = ask("completion", "fish")
    assert done.code == WRONG_INPUT
    assert "bash, zsh, tcsh" in done.err
