"""The bar on a terminal, and the silence everywhere else."""

import io
import json
import sys
from pathlib import Path

import pytest

from ikplan.cli import main
from ikplan.cli.terminal.progress import progress_bar

REQUEST = {"robot": "iiwa14", "path": {"waypoints": [{"position": [0.5, 0.0, 0.5]}] * 3}}


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    made = Terminal()
    monkeypatch.setattr(sys, "stderr", made)
    return made


def test_a_bar_tells_stage_and_waypoints_and_leaves_nothing_behind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_a_terminal(monkeypatch)
    with progress_bar() as tell:
        assert tell is not None
        tell("ik", 1, 4)
        tell("ik", 3, 4)
        tell("timing", 0, 0)
    shown = terminal.getvalue()
    assert "ik 1/4" in shown
    assert "ik 3/4" in shown
    assert "timing " in shown
    assert shown.rpartition("\r")[0].rpartition("\r")[2].strip() == ""


def test_where_nobody_looks_nothing_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bar() as tell:
        assert tell is None
    assert capsys.readouterr().err == ""


def test_a_plan_made_on_a_terminal_shows_its_progress(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    terminal = on_a_terminal(monkeypatch)
    file = tmp_path / "request.json"
    file.write_text(json.dumps(REQUEST))
    assert main(["plan", str(file), "-o", str(tmp_path / "plan.json")]) == 0
    assert "/3" in terminal.getvalue()
    assert "certificate " in terminal.getvalue()
