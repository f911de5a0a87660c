"""Formats that other packages bring."""

from __future__ import annotations

from pathlib import Path

import pytest

from ikplan import InvalidRequest
from ikplan.plans.export import FORMATS, encode, format_for, format_named, save

from .plans import rest_to_rest

_MODULE = """
from ikplan.plans.export.formats import Format

OURS = Format("ours", "as we like it", (".ours",), "text/x-ours", lambda plan: plan.id.encode())
TAKEN = Format("mine", "theirs", (".csv",), "text/x-mine", lambda plan: b"")
WRONG = 7
"""


def install(folder: Path, monkeypatch: pytest.MonkeyPatch, attribute: str) -> None:
    """Put a package with an entry point where Python finds it."""
    (folder / f"exporter_{attribute.lower()}.py").write_text(_MODULE)
    info = folder / f"exporter_{attribute.lower()}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: exporter-{attribute}\nVersion: 1.0\n"
    )
    (info / "entry_points.txt").write_text(
        f"[ikplan.exporters]\n{attribute.lower()} = exporter_{attribute.lower()}:{attribute}\n"
    )
    monkeypatch.syspath_prepend(folder)


def test_an_installed_package_brings_a_format(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InvalidRequest):
        format_named("ours")
    install(tmp_path, monkeypatch, "OURS")
    plan = rest_to_rest()
    file = tmp_path / "plan.ours"
    assert format_for(file) is format_named("ours")
    save(plan, file)
    assert file.read_bytes() == encode(plan, "ours") == plan.id.encode()
    assert format_for("plan.csv") in FORMATS


@pytest.mark.parametrize(
    ("attribute", "words"), [("TAKEN", "'.csv' is of"), ("WRONG", "it is a int, not a Format")]
)
def test_an_entry_point_that_is_no_format_of_its_own_is_refused(
    attribute: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, monkeypatch, attribute)
    with pytest.raises(InvalidRequest, match=words):
        format_named("csv")
