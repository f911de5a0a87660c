"""A glance at a YAML document shows what the full reader reads of its texts and lists."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from ikplan.robots.folders import catalogue_folders
from ikplan.robots.yaml_text import glance_at_yaml, load_yaml

WRITTEN = """
name: arm   # a comment
title: "2024"
number: 2024
word: yes
nothing: ~
tagged: !!str 5
folded: >
  two
  lines
empty: []
"inline key": [1, [2, 3], {a: 4}, "5"]
block:
  - {name: A1}
  - - 1
    - 2
  - last
nested: {name: other, list: [1, 2]}
? [a, b]
: under a list
anchored: &x [1, 2]
again: *x
name: the last one counts
"""


def shown(content: dict[object, object]) -> dict[object, object]:
    kept = {k: v for k, v in content.items() if isinstance(k, str) and isinstance(v, str | list)}
    return {k: v if isinstance(v, str) else len(v) for k, v in kept.items()}


def test_texts_and_lengths_of_lists_are_those_of_the_full_reader() -> None:
    left_out = {"tagged", "again"}
    content = load_yaml(WRITTEN.replace("? [a, b]\n: under a list\n", ""))
    assert glance_at_yaml(WRITTEN) == {k: v for k, v in shown(content).items() if k not in left_out}


@pytest.mark.parametrize("folder", catalogue_folders()[-1:])
def test_the_catalogue_is_seen_as_it_is_read(folder: Path) -> None:
    files = sorted(folder.glob("*/robot.yaml"))
    assert len(files) > 50
    for file in files:
        text = file.read_bytes()
        assert glance_at_yaml(text) == shown(load_yaml(text)), file


@pytest.mark.parametrize("text", ["", "- 1\n", "text", "a: b\n---\nc: d\n", "a: b\n--- [\n"])
def test_what_is_no_mapping_or_not_alone_shows_nothing(text: str) -> None:
    assert glance_at_yaml(text) == {}


@pytest.mark.parametrize("text", ["a: [1\n", "a: b\nc: 'd\n", "a: b\n  c: d\n"])
def test_what_is_not_yaml_is_refused(text: str) -> None:
    with pytest.raises(yaml.YAMLError):
        glance_at_yaml(text)
