"""The catalogue as a list, without building its robots."""

from __future__ import annotations

from typing import Any, NamedTuple

import yaml

from ikplan.robots.folders import robot_folder, robot_names
from ikplan.robots.yaml_text import load_yaml

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
    try:
        content: Any = load_yaml(text)
        title, joints = content["title"], content["joints"]
        if content["name"] == name and isinstance(title, str) and isinstance(joints, list):
            return ListedRobot(name, title, len(joints))
    except (yaml.YAMLError, RecursionError, KeyError, TypeError):
        pass  # the full reader says what is wrong
    from ikplan.robots.load import catalogue_robot

    robot = catalogue_robot(name)
    return ListedRobot(robot.name, robot.title, robot.dof)
