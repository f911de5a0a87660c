"""Writes what the container installs, with hashes: ``python docker/lock.py`` (``make lock``).

pip chooses the files, for the image's Python on x86_64, under ``constraints.txt``.
No address of a registry is written: the container's pip has its own.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PYTHON = "3.13"
"""As in the Dockerfile."""
FAMILIES = ("x86_64",)
"""Processor families of the image; toppra has no wheel for others."""
EXTRAS = ("otel", "postgres")
_TAGS = ("manylinux_2_41", "manylinux_2_34", "manylinux_2_28", "manylinux_2_17", "manylinux2014")
_HEAD = """\
# What the container installs{what}, file by file: made by `make lock` from pyproject.toml and
# constraints.txt for Python {python} on {families}. Do not edit.
"""

Locked = dict[str, tuple[str, set[str]]]


def main() -> None:
    """Write ``docker/requirements.txt``, and one file for what each extra adds."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted: list[str] = project["dependencies"]
    base = resolve(wanted)
    write(ROOT / "docker" / "requirements.txt", base, "")
    for extra in EXTRAS:
        more = resolve([*wanted, *project["optional-dependencies"][extra]])
        added = {name: entry for name, entry in more.items() if name not in base}
        write(ROOT / "docker" / f"requirements-{extra}.txt", added, f" in addition for [{extra}]")


def resolve(requirements: list[str]) -> Locked:
    """Return version and hashes of every package that pip would install."""
    found: dict[str, set[str]] = defaultdict(set)
    versions: dict[str, str] = {}
    for family in FAMILIES:
        for package in _chosen(requirements, family):
            name, version = package["metadata"]["name"], package["metadata"]["version"]
            if versions.setdefault(name, version) != version:
                raise SystemExit(f"{name}: {versions[name]} and {version}")
            found[name].add(package["download_info"]["archive_info"]["hashes"]["sha256"])
    return {name: (versions[name], found[name]) for name in found}


def _chosen(requirements: list[str], family: str) -> list[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        platforms = [word for tag in _TAGS for word in ("--platform", f"{tag}_{family}")]
        subprocess.run(
            [
                *(sys.executable, "-m", "pip", "install", "--quiet", "--dry-run"),
                *("--ignore-installed", "--only-binary", ":all:", "--python-version", PYTHON),
                *(*platforms, "--target", folder, "--report", str(report)),
                *("--constraint", str(ROOT / "constraints.txt"), *requirements),
            ],
            check=True,
        )
        chosen: list[dict[str, Any]] = json.loads(report.read_text())["install"]
        return chosen


def write(path: Path, locked: Locked, what: str) -> None:
    """Write a requirements file with hashes."""
    text = _HEAD.format(what=what, python=PYTHON, families=" and ".join(FAMILIES))
    for name in sorted(locked, key=str.lower):
        version, hashes = locked[name]
        lines = " \\\n".join(f"    --hash=sha256:{digest}" for digest in sorted(hashes))
        text += f"{name}=={version} \\\n{lines}\n"
    path.write_text(text)


if __name__ == "__main__":
    main()
