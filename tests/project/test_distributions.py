"""What the wheel and the sdist hold: all that runs, its licences, and nothing else."""

from __future__ import annotations

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MADE = {"ikplan/kernels.pack"}
"""What a build may have put beside the code."""


def build(kind: str, source: Path, out: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(out)]
    subprocess.run(command, cwd=source, check=True, capture_output=True)
    (made,) = out.iterdir()
    return made


def files(folder: str, place: str) -> set[str]:
    """Files below a folder of the checkout, as they are named in a wheel."""
    found = (p for p in (ROOT / folder).rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    return {f"{place}/{p.relative_to(ROOT / folder).as_posix()}" for p in found}


def wheel_content(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("sdist", ROOT, tmp_path_factory.mktemp("sdist"))


def test_the_wheel_holds_the_packages_the_catalogue_and_nothing_else(wheel: Path) -> None:
    code = files("ikplan", "ikplan") | files("api/ikplan_api", "ikplan_api")
    catalogue = files("robots", "ikplan/robots/catalogue")
    page = {name for name in wheel_content(wheel) if name.startswith("ikplan_api/page/")}
    told = {name for name in wheel_content(wheel) if name.split("/")[0].endswith(".dist-info")}
    assert wheel_content(wheel) - told - page - MADE == (code | catalogue) - MADE
    assert "ikplan/py.typed" in code


def test_the_wheel_holds_its_licences_and_commands(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        (entry,) = (n for n in archive.namelist() if n.endswith(".dist-info/entry_points.txt"))
        assert "ikplan = ikplan.cli:main" in archive.read(entry).decode()
        licences = {n.partition("/licenses/")[2] for n in archive.namelist() if "/licenses/" in n}
    assert {"LICENSE", "NOTICE", "licenses/dependencies.toml"} <= licences


def test_the_sdist_makes_the_same_wheel_and_holds_no_tests(
    sdist: Path, wheel: Path, tmp_path: Path
) -> None:
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (source,) = tmp_path.iterdir()
    held = {path.name for path in source.iterdir()}
    assert {"LICENSE", "NOTICE", "README.md", "pyproject.toml", "licenses"} <= held
    assert not held & {"tests", "benchmarks", "docs", "docker", ".git", "constraints.txt"}
    again = build("wheel", source, tmp_path / "dist")
    assert wheel_content(again) == wheel_content(wheel)
    with zipfile.ZipFile(again) as first, zipfile.ZipFile(wheel) as second:
        names = [n for n in first.namelist() if not n.endswith("RECORD")]
        assert all(first.read(name) == second.read(name) for name in names)
