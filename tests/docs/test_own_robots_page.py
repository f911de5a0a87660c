"""The transcript of the page about one's own robots is what the commands say."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from ikplan import load_robot
from ikplan.cli import main

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "own_robots.md").read_text()
TRANSCRIPT = "".join(re.findall(r"^```console\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))


def said_by_command() -> dict[str, list[str]]:
    said: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in TRANSCRIPT.splitlines():
        if line.startswith("$ ikplan "):
            lines = said[line.removeprefix("$ ikplan ")] = []
        else:
            lines.append(line)
    return said


def settled(line: str) -> str:
    """A line without figures of rounding, which differ between machines, and without folders."""
    line = re.sub(r"\d+(\.\d+)?e-\d+|[0-9a-f]{32}", "#", line)
    # Where an extreme is reached twice, rounding decides which of the two is named.
    line = re.sub(r"at \d+\.\d+ s", "at # s", line)
    return re.sub(r"wrote \S*/ikplan/robots/", "wrote ~/.config/ikplan/robots/", line)


def test_the_transcript_is_what_the_commands_say(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.delenv("IKPLAN_ROBOTS_PATH", raising=False)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    commands = said_by_command()
    assert [shlex.split(command)[0] for command in commands] == ["robots", "plan"]
    for command, lines in commands.items():
        assert main(shlex.split(command)) == 0
        out = capsys.readouterr().out.splitlines()
        assert [settled(line) for line in out] == [settled(line) for line in lines]


def test_the_table_of_the_page_is_read(tmp_path: Path) -> None:
    (table,) = re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    file = tmp_path / "table.yaml"
    file.write_text(table)
    assert load_robot(file).joint_names == ("J1", "J2")
