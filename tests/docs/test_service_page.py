"""What docs/service.md says of the settings is true."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from pydantic.fields import FieldInfo

from ikplan_api.settings import Settings, unknown_variables

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "service.md").read_text()
README = (ROOT / "README.md").read_text()
NOT_OF_THE_SERVICE = {"CACHE_DIR", "COMPILE_AHEAD", "KERNELS", "KEY", "ROBOTS_PATH", "SERVER"}
"""Of the client and of the library: on the page below the table."""


def default(name: str, field: FieldInfo) -> str:
    """A default as the page shows it."""
    value: Any = field.get_default(call_default_factory=True)
    if name.endswith("_path"):
        return f"`{value}`".replace(str(Path.home()), "~")
    if name.endswith("_bytes"):
        unit, size = ("GiB", 2**30) if value >= 2**30 else ("MiB", 2**20)
        assert value % size == 0
        return f"{value // size} {unit}"
    if value in ((), ""):
        return "none"
    if isinstance(value, str):
        return f"`{value}`"
    return str(value) if name == "port" else f"{value:,g}"


def test_the_table_is_that_of_the_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    wanted = [
        f"| `IKPLAN_{name.upper()}` | {default(name, field)} | {field.description} |"
        for name, field in sorted(Settings.model_fields.items())
    ]
    assert [line for line in PAGE.splitlines() if line.startswith("| `IKPLAN_")] == wanted


def test_every_variable_named_anywhere_exists() -> None:
    known = {name.upper() for name in Settings.model_fields} | NOT_OF_THE_SERVICE
    for text in (PAGE, README, (ROOT / "docker" / "README.md").read_text()):
        assert set(re.findall(r"IKPLAN_([A-Z_]*[A-Z])", text)) <= known
    for name in NOT_OF_THE_SERVICE:
        assert f"`IKPLAN_{name}`" in PAGE


def test_a_variable_that_is_no_setting_is_told_with_the_one_meant() -> None:
    environment = {
        "IKPLAN_MAX_QUEUE": "3",
        "IKPLAN_ZZZ": "",
        "IKPLAN_WORKERS": "1",
        "ikplan_port": "9",
        **{f"IKPLAN_{name}": "x" for name in NOT_OF_THE_SERVICE},
        "PATH": "x",
    }
    unknown = unknown_variables(environment)
    assert unknown.keys() == {"IKPLAN_MAX_QUEUE", "IKPLAN_ZZZ"}
    assert unknown["IKPLAN_MAX_QUEUE"][0] == "IKPLAN_MAX_QUEUED"
    assert unknown["IKPLAN_ZZZ"] == []
