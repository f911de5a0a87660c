"""The site of the documentation: what the reference holds, and what the check of assets finds."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

import ikplan
from ikplan import errors

ROOT = Path(__file__).parents[2]
remote_assets = runpy.run_path(str(ROOT / "docs" / "build_site.py"))["remote_assets"]
REFERENCE = (ROOT / "docs" / "reference.rst").read_text()


def test_every_public_name_is_in_the_reference() -> None:
    shown = set(re.findall(r"^\.\. auto(?:class|function):: ikplan\.(\w+)$", REFERENCE, re.M))
    assert ".. automodule:: ikplan.errors\n   :members:" in REFERENCE
    assert shown | {*errors.__all__, "__version__"} >= set(ikplan.__all__)
    assert shown <= set(ikplan.__all__)


def test_every_page_is_in_the_contents() -> None:
    listed = re.findall(r"^[\w./-]+$", (ROOT / "docs" / "index.md").read_text(), re.M)
    pages = {(ROOT / "docs" / name).resolve() for name in listed}
    for page in (ROOT / "docs").glob("*.*"):
        if page.suffix in (".md", ".rst") and page.name != "index.md":
            assert page.with_suffix("") in pages, page.name
    for page in pages:
        assert page.with_suffix(".md").exists() or page.with_suffix(".rst").exists(), page


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.html", '<script src="https://host.example/x.js"></script>'),
        ("a.html", '<link rel="stylesheet" href="//host.example/x.css">'),
        ("a.html", '<img alt="" src="HTTP://host.example/x.png">'),
        ("a.html", "<style>@import 'https://host.example/x.css';</style>"),
        ("a.html", '<p style="background: url(https://host.example/x.png)">x</p>'),
        ("b.css", "@font-face { src: url('https://host.example/x.woff2') }"),
        ("b.css", "@import url(//host.example/x.css);"),
    ],
)
def test_what_a_page_loads_from_another_host_is_found(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / name).write_text(text)
    (found,) = remote_assets(tmp_path)
    assert found.startswith(f"sub/{name}: ")
    assert "//host.example/x" in found


def test_links_and_assets_of_the_site_are_let_be(tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<a href="https://host.example/">x</a><img alt="" src="../x.png">'
        '<link rel="icon" href="data:image/png;base64,//8="><script src="x.js?v=1"></script>'
        "<p>url(https://host.example/x.css) as text</p>"
    )
    (tmp_path / "b.css").write_text("/* see https://host.example/ */ a { src: url(x.woff2) }")
    assert remote_assets(tmp_path) == []
