"""Every dependency and every robot has its licence on record, as its source states it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from email.message import Message
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from ikplan.robots import robot_names
from ikplan.robots.folders import package_file

ROOT = Path(__file__).parents[2]
NOTICE = (ROOT / "NOTICE").read_text()
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
DEPENDENCIES = tomllib.loads((ROOT / "licenses" / "dependencies.toml").read_text())
ROBOTS = tomllib.loads((ROOT / "licenses" / "robots.toml").read_text())
OSI = "License :: OSI Approved :: "


def installed() -> Iterator[tuple[str, Message]]:
    """What the dependencies of ikplan bring in on this platform: name and metadata of each."""
    pending: list[str] = list(PROJECT["dependencies"])
    seen: set[str] = set()
    while pending:
        requirement = Requirement(pending.pop())
        name = canonicalize_name(requirement.name)
        needed = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
        if needed and name not in seen:
            seen.add(name)
            found = distribution(name)
            yield name, found.metadata  # type: ignore[misc]
            pending += found.requires or []


def stated(metadata: Message) -> str:
    """What a package says of its licence, in its own words."""
    field = (metadata.get("License") or "").strip().splitlines()
    classifiers = metadata.get_all("Classifier", [])
    approved = [c.removeprefix(OSI) for c in classifiers if c.startswith("License ::")]
    return metadata.get("License-Expression") or (
        field[0].strip() if field else "; ".join(approved)
    )


INSTALLED = dict(installed())


@pytest.mark.parametrize("name", sorted(INSTALLED))
def test_a_dependency_has_the_licence_that_it_states(name: str) -> None:
    assert DEPENDENCIES[name]["stated"] == stated(INSTALLED[name])
    assert DEPENDENCIES[name]["license"]


def test_the_list_holds_pinned_packages_only() -> None:
    lines = (ROOT / "constraints.txt").read_text().split()
    assert DEPENDENCIES.keys() <= {canonicalize_name(line.split("==")[0]) for line in lines}
    assert len(INSTALLED) > len(PROJECT["dependencies"])


@pytest.mark.parametrize("name", sorted(DEPENDENCIES))
def test_the_notice_names_what_asks_for_more_than_its_text(name: str) -> None:
    shares = re.search(r"GPL|MPL|Qhull", DEPENDENCIES[name]["license"])
    words = {canonicalize_name(word) for word in re.findall(r"[\w-]+", NOTICE)}
    assert not shares or name in words


def test_every_robot_of_the_catalogue_is_in_the_list_and_in_the_notice() -> None:
    folders = {file.parent.name for file in (ROOT / "robots").glob("*/robot.yaml")}
    assert ROBOTS.keys() == folders
    assert folders <= set(re.findall(r"\w+", NOTICE))
    assert folders <= set(robot_names())


@pytest.mark.parametrize("name", sorted(ROBOTS))
def test_a_robot_has_the_licences_of_its_sources(name: str) -> None:
    sources: list[dict[str, Any]] = ROBOTS[name]["sources"]
    for source in sources:
        assert source["license"] == "not stated" or source["where"]
    document = yaml.safe_load((ROOT / "robots" / name / "robot.yaml").read_text())
    urdf = document["kinematics"].get("urdf")
    if urdf:
        description = Path(urdf["path"]).parts[0]
        (source,) = (s for s in sources if s["name"] == f"{urdf['package']}: {description}")
        read_me = package_file(urdf["package"], f"{description}/README.md").read_text()
        licence = re.search(r"^license: (\S+)$", read_me, re.MULTILINE)
        assert licence
        assert source["license"].startswith(licence[1])
        header = package_file(urdf["package"], urdf["path"]).read_text()[:2000]
        assert ("license" in header.lower()) == ("but" in source)
