"""The catalogue as a list, without building its robots."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import NamedTuple

import yaml

from ikplan.robots.folders import robot_folders
from ikplan.robots.yaml_text import glance_at_yaml

__all__ = ["ListedRobot", "listed_robots"]


class ListedRobot(NamedTuple):
    """A robot of the list.

    Attributes:
        name: Short name.
        title: Full name.
        dof: Number of the user's joints.
    """

    name: str
    title: str
    dof: int


def listed_robots() -> list[ListedRobot]:
    """Return the robots of the catalogue, sorted by name.

    Raises:
        InvalidRobot: A description makes no sense.
    """
    return [_listed(name, folder) for name, folder in robot_folders().items()]


def _listed(name: str, folder: Path) -> ListedRobot:
    """What the list shows of a robot; a file that does not show it is read in full."""
    text = (folder / "robot.yaml").read_bytes()
    with contextlib.suppress(yaml.YAMLError):  # the full reader says what is wrong
        shown = glance_at_yaml(text)
        title, joints = shown.get("title"), shown.get("joints")
        if shown.get("name") == name and isinstance(title, str) and isinstance(joints, int):
            return ListedRobot(name, title, joints)
    from ikplan.robots.load import catalogue_robot

    robot = catalogue_robot(name)
    return ListedRobot(robot.name, robot.title, robot.dof)
