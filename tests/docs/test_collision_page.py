"""What docs/collision.md shows is so."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

import ikplan
from ikplan.cli import main
from ikplan.documents import parse
from ikplan.documents.clearance import Clearance
from ikplan.documents.scene import Scene
from ikplan.scene.allowed import SAMPLES
from ikplan.scene.model import collision_model

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "collision.md").read_text()


def blocks(language: str) -> list[str]:
    found = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert found
    return found


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs_and_prints(code: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(code, "collision.md", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out.strip()


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("line", [line for text in blocks("sh") for line in text.splitlines()])
def test_commands_run(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(line)[1:]) == 0
    assert capsys.readouterr().out


@pytest.mark.usefixtures("checkout")
def test_the_transcript_is_what_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    (shown,) = re.findall(r"^```\n(\$ ikplan.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    first, *rest = shown.splitlines()
    assert main(shlex.split(first.removeprefix("$ "))[1:]) == 0
    said = capsys.readouterr().out.splitlines()
    for line in rest:
        if line != "...":
            name, distance, *_ = [*re.split(r"\s{2,}", line.strip()), ""]
            (told,) = (x for x in said if re.split(r"\s{2,}", x.strip())[0] == name)
            # The last digit is the processor's, and so is when an extreme is reached.
            settled = [re.sub(r"at \d+\.\d+ s|\d\b", "", text).split() for text in (told, line)]
            assert settled[0] == settled[1], distance


@pytest.mark.parametrize("text", blocks("json"))
def test_the_scene_shown_is_one_of_the_robot(text: str) -> None:
    scene = parse(Scene, json.loads(text))
    model = collision_model(ikplan.load_robot("panda"), scene)
    assert {"table", "post", "part"} <= {body.name for body in model.bodies}
    assert ("table", "panda_link1") in {tuple(names[:2]) for names in model.allowed} | {
        (b, a) for a, b, _ in model.allowed
    }


def test_the_fields_shown_are_those_of_the_certificate() -> None:
    table = PAGE.partition("## What is proven")[2].partition("\n\nThe motion is cut")[0]
    rows = re.findall(r"^\| (`[^|]+`) \|", table, re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    fields = {field.alias or name for name, field in Clearance.model_fields.items()}
    assert fields - named == {"clearance", "pairs_checked", "undecided"}
    assert named <= fields


def test_the_shapes_shown_are_all_there_are() -> None:
    table = PAGE.partition("| shape |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| ([^|]+) \|", table, re.MULTILINE)
    shown = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    schema = Scene.model_json_schema()
    (shapes,) = {
        tuple(sorted(part["properties"]["shape"]["discriminator"]["mapping"]))
        for part in schema["$defs"].values()
        if "shape" in part.get("properties", {})
    }
    assert shown == set(shapes)


def test_the_number_of_configurations_is_the_one_used() -> None:
    assert f"each of {SAMPLES} configurations" in PAGE
