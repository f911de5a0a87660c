"""What the container installs: pinned by hash, as constrained, and on its bill of materials."""

from __future__ import annotations

import json
import re
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

from packaging.utils import canonicalize_name

from .test_licences import DEPENDENCIES, INSTALLED

ROOT = Path(__file__).parents[2]
FILES = [
    ROOT / "docker" / "requirements.txt",
    *(ROOT / "docker" / f"requirements-{extra}.txt" for extra in ("otel", "postgres")),
]
SBOM = runpy.run_path(str(ROOT / "docker" / "sbom.py"))
CONSTRAINTS = dict(
    line.split("==")
    for line in (ROOT / "constraints.txt").read_text().split()
    if "==" in line and not line.startswith("#")
)
PINNED: dict[str, str] = {canonicalize_name(name): version for name, version in CONSTRAINTS.items()}


def locked() -> dict[str, tuple[str, list[str]]]:
    return {
        canonicalize_name(name): (version, hashes)
        for path in FILES
        for name, version, hashes in SBOM["locked"](path)
    }


def test_the_lock_agrees_with_the_constraints() -> None:
    for name, (version, hashes) in locked().items():
        assert PINNED[name] == version, name
        assert hashes, name


def test_the_lock_holds_every_dependency() -> None:
    assert set(INSTALLED) - set(locked()) == set()


def test_every_line_of_the_lock_is_an_entry_and_none_an_address() -> None:
    for path in FILES:
        text = path.read_text()
        entries = [line for line in text.splitlines() if "==" in line]
        assert len(entries) == len(list(SBOM["locked"](path)))
        assert "//" not in text
        assert "index" not in text
        assert "find-links" not in text


def test_the_container_installs_by_hash_only() -> None:
    dockerfile = (ROOT / "docker" / "Dockerfile").read_text()
    assert "pip install --require-hashes" in dockerfile
    for path in FILES:
        assert f"docker/{path.name}" in dockerfile


def test_the_bill_of_materials_lists_what_is_locked_with_its_licences(tmp_path: Path) -> None:
    texts = []
    for name in ("a", "b"):
        command = [sys.executable, str(ROOT / "docker" / "sbom.py"), str(tmp_path / name)]
        subprocess.run(command, check=True)
        texts.append((tmp_path / name).read_bytes())
    assert texts[0] == texts[1]
    made: dict[str, Any] = json.loads(texts[0])
    assert (made["bomFormat"], made["specVersion"]) == ("CycloneDX", "1.6")
    entries = {canonicalize_name(n): v for n, v, _ in SBOM["locked"](FILES[0])}
    assert {c["name"]: c["version"] for c in made["components"]} == entries
    for component in made["components"]:
        assert component["purl"] == f"pkg:pypi/{component['name']}@{component['version']}"
        (licence,) = component["licenses"]
        assert licence["expression"] == DEPENDENCIES[component["name"]]["license"]
        assert component["externalReferences"][0]["hashes"]


def test_the_wheels_that_make_builds_are_of_this_checkout() -> None:
    """A bare name is a project of the package index to pip, whatever folder has it."""
    makefile = (ROOT / "Makefile").read_text()
    built = re.findall(r"pip wheel .* (\S+)$", makefile, re.MULTILINE)
    assert sorted(built) == ["./client", "./kernels"]
    assert all((ROOT / place / "pyproject.toml").is_file() for place in built)
