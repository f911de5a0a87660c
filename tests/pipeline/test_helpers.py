"""Where kernels have to be compiled, further processes help; they do what a request will need."""

from __future__ import annotations

import atexit
import importlib.util
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import pytest

import ikplan
from ikplan._kernels.turns import Turn
from ikplan.documents.limits import LimitOptions
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline import compile_ahead, helpers


class Process:
    """Stands for a process that was started."""

    started: ClassVar[list[tuple[list[str], Mapping[str, str]]]] = []

    def __init__(self, command: list[str], *, env: Mapping[str, str], **_: Any) -> None:
        self.started.append((command, env))
        self.ended: list[str] = []

    def terminate(self) -> None:
        self.ended.append("told")

    def wait(self) -> None:
        self.ended.append("gone")


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What a process is to do when it begins to compile."""
    calls: list[Any] = []
    monkeypatch.setattr(helpers, "when_compiling", calls.append)
    monkeypatch.setattr(helpers, "_arguments", [])
    monkeypatch.setattr(helpers, "_helpers", [])
    monkeypatch.setattr(Process, "started", [])
    monkeypatch.setattr(subprocess, "Popen", Process)
    monkeypatch.setattr(atexit, "register", lambda _: None)
    monkeypatch.delenv(helpers.VARIABLE, raising=False)
    return calls


@pytest.mark.parametrize(("processors", "count"), [(1, 0), (2, 1), (3, 2), (64, 3)])
def test_each_further_processor_has_a_helper_once_something_is_compiled(
    calls: list[Any], monkeypatch: pytest.MonkeyPatch, processors: int, count: int
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(processors)))
    helpers.helped_by("time")
    robot = ikplan.load_robot("iiwa14")
    options = LimitOptions.model_validate({"jerk": 100.0, "tool_speed": 1.0})
    helpers.helped_by("plan", "lm", (MotionLimits.of(robot, options),))
    assert len(calls) == 1
    assert Process.started == []
    calls[0]()
    assert len(Process.started) == count
    for number, (command, environment) in enumerate(Process.started):
        assert command[0] == sys.executable
        assert command[-6:] == ["plan", "lm", "1", "1", str(number), str(count)]
        assert importlib.util.find_spec(command[command.index("-m") + 1]) is not None
        assert environment[helpers.VARIABLE] == "0"  # a helper has no helpers
    begun: list[Any] = [*helpers._helpers]
    helpers._stop()
    assert [process.ended for process in begun] == [["told", "gone"]] * count


@pytest.mark.parametrize("executable", ["", "/opt/app/robot-cell"])
def test_a_program_that_is_no_python_starts_none(
    calls: list[Any], monkeypatch: pytest.MonkeyPatch, executable: str
) -> None:
    monkeypatch.setattr(sys, "executable", executable)
    helpers.helped_by("plan")
    assert calls == []


def test_helpers_can_be_switched_off(calls: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(helpers.VARIABLE, "0")
    helpers.helped_by("plan")
    assert calls == []


@pytest.mark.parametrize("kind", ["ik", "time", "plan"])
def test_a_helper_begins_with_what_a_request_uses_last(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[str] = []
    for name in ("plan", "time_request", "solve_ik_request", "_check", "_shorten"):
        monkeypatch.setattr(compile_ahead, name, lambda _, name=name: ran.append(name))
    monkeypatch.setattr(compile_ahead, "cache_folder", lambda: tmp_path)
    compile_ahead.main([kind, "ik-ba", "0", "0", "0", "1"])
    order = {"time": ["time_request"], "plan": ["time_request", "_check", "_shorten", "plan"]}
    assert ran == order.get(kind, ["solve_ik_request"] * len(ran))
    assert ran
    assert not list(tmp_path.iterdir())


def test_a_helper_leaves_the_work_to_one_that_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[object] = []
    monkeypatch.setattr(compile_ahead, "time_request", ran.append)
    monkeypatch.setattr(compile_ahead, "cache_folder", lambda: tmp_path)
    turn = Turn(tmp_path / "helper-0.lock")
    compile_ahead.main(["time", "ik-ba", "0", "0", "0", "1"])
    assert ran == []
    turn.give_back()
    compile_ahead.main(["time", "ik-ba", "0", "0", "0", "1"])
    assert ran != []


@pytest.mark.parametrize("loads", [False, True])
def test_a_helper_compiles_for_the_limits_that_are_asked_for(loads: bool) -> None:
    for run, request in compile_ahead._work("plan", "ik-ba", False, loads):
        assert ("torque" in request["limits"]) == loads, run


@pytest.mark.parametrize("place", [1, 2], ids=["checks motions", "shortens a sequence"])
def test_a_helper_calls_what_a_plan_calls_in_its_midst(place: int) -> None:
    """For a request that is checked as a plan is, in which nothing touches."""
    run, request = compile_ahead._work("plan", "ik-ba", False, False)[place]
    run(request)


def test_a_helper_compiles_for_the_arguments_of_a_plan() -> None:
    """Else it compiles what nobody calls: one set of types for each kernel that it calls itself."""
    code = (
        "import ikplan\n"
        "from ikplan.certificate.offset_kernels import offset_rows\n"
        "from ikplan.collision.motion import curve_contacts, motion_contact\n"
        "from ikplan.pipeline import compile_ahead\n"
        "from ikplan.planning.ladder.path_shortening import shorten_sequence\n"
        "work = compile_ahead._work('plan', 'ik-ba', False, False)\n"
        "for run, request in work[1:3]:\n"
        "    run(request)\n"
        "kernels = offset_rows, curve_contacts, motion_contact, shorten_sequence\n"
        "before = [{*each.overloads} for each in kernels]\n"
        "pose = {'position': [0.4, 0.1, 0.5], 'quaternion_xyzw': [1.0, 0.0, 0.0, 0.0]}\n"
        "path = {'waypoints': [pose, {**pose, 'position': [0.4, 0.0, 0.5]}]}\n"
        "request = {'robot': 'xarm7', 'path': path, 'limits': {'jerk': False}}\n"
        "ikplan.plan(request)\n"
        "assert all(before)\n"
        "assert before == [{*each.overloads} for each in kernels]\n"
    )
    environment = {**os.environ, helpers.VARIABLE: "0", "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)
