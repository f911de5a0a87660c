"""The page over HTTP: its headers, its parts, and what a checkout without it says."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest

from ikplan_api.routes import page

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def bundle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bundle as the build makes it, small."""
    (tmp_path / "index.html").write_text('<script src="page/app-X.js"></script>')
    (tmp_path / "app-X.js").write_text("1")
    (tmp_path / "notes.py").write_text("secret")
    (tmp_path.parent / "outside.js").write_text("secret")
    monkeypatch.setattr(page, "bundle_folder", lambda: tmp_path)
    return tmp_path


def test_a_checkout_without_the_page_says_how_to_make_it(
    http: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "bundle_folder", lambda: tmp_path / "none")
    answer = http.get("/")
    assert answer.status_code == 200
    assert page.BUNDLE_HINT in answer.text
    target = page.BUNDLE_HINT.removeprefix("make ")
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert http.get("/page/app-X.js").status_code == 404


def test_nothing_from_elsewhere_and_nothing_inline_may_run(http: httpx.Client) -> None:
    answer = http.get("/")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    policy = dict(
        directive.strip().split(" ", 1)
        for directive in answer.headers["content-security-policy"].split(";")
    )
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["connect-src"] == policy["style-src"] == "'self'"
    assert not re.search(r"unsafe|https?:|\*", " ".join(policy.values()))


def test_parts_are_kept_for_long_and_the_page_is_asked_for_again(http: httpx.Client) -> None:
    part = http.get("/page/app-X.js")
    assert part.text == "1"
    assert "immutable" in part.headers["cache-control"]
    assert http.get("/").headers["cache-control"] == "no-cache"


@pytest.mark.parametrize(
    "name", ["notes.py", "none.js", "../outside.js", "..%2foutside.js", "%2e%2e/outside.js", ""]
)
def test_no_other_file_is_a_part_of_the_page(http: httpx.Client, name: str) -> None:
    assert http.get(f"/page/{name}").status_code == 404


def test_the_lock_file_pins_everything_and_names_no_address() -> None:
    lock = (ROOT / "web/package-lock.json").read_text()
    assert "://" not in lock
    assert lock.count('"integrity"') >= 10
    for version in re.findall(r'"(?:three|urdf-loader|esbuild|typescript|@types/three)": "([^"]+)"',
                              (ROOT / "web/package.json").read_text()):  # fmt: skip
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)
