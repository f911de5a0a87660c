"""The catalogue as a list, without building its robots."""

from __future__ import annotations

import contextlib
from typing import NamedTuple

import yaml

from ikplan.robots.folders import robot_folder, robot_names
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
    return [_listed(name) for name in robot_names()]


def _listed(name: str) -> ListedRobot:
    """What the list shows of a robot; a file that does not show it is read in full."""
    text = (robot_folder(name) / "robot.yaml").read_bytes()
    with contextlib.suppress(yaml.YAMLError):  # the full reader says what is wrong
        shown = glance_at_yaml(text)
        title, joints = shown.get("title"), shown.get("joints")
        if shown.get("name") == name and isinstance(title, str) and isinstance(joints, int):
            return ListedRobot(name, title, joints)
    from ikplan.robots.load import catalogue_robot

    robot = catalogue_robot(name)
    return ListedRobot(robot.name, robot.title, robot.dof)
