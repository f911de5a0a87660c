"""Names of robots as people write them: another case, other marks, another name of the same arm."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from pathlib import Path

from ikplan.errors import RobotNotFound, near_names
from ikplan.robots.yaml_text import load_yaml

__all__ = ["known_name"]

_FILE = Path(__file__).with_name("aliases.yaml")


@functools.cache
def _aliases() -> tuple[dict[str, str], dict[str, list[str]]]:
    """Names of the same arm, and names that several answer to, both folded."""
    content = load_yaml(_FILE.read_text())
    same = {_folded(name): robot for name, robot in content["same"].items()}
    return same, {_folded(name): robots for name, robots in content["several"].items()}


def _folded(name: str) -> str:
    """A name without case and without the marks between its letters."""
    return re.sub(r"[\s_.\-/]+", "", name.casefold())


def known_name(name: str, valid: Sequence[str]) -> str:
    """Return the robot that a name means.

    Args:
        name: The name as it is written.
        valid: Names of the catalogue.

    Raises:
        RobotNotFound: No robot, or more than one, has that name; those that it may mean are named.
    """
    if name in valid:
        return name
    folded = _folded(name)
    meant = [v for v in valid if _folded(v) == folded]
    same, several = _aliases()
    if not meant and same.get(folded) in valid:
        meant = [same[folded]]
    if len(meant) == 1:
        return meant[0]
    near = meant or [robot for robot in several.get(folded, ()) if robot in valid]
    if near:
        raise RobotNotFound(
            f"{name!r} may be {' or '.join(near)}: name the one that you have",
            name=name,
            near=near,
            valid=valid,
        )
    # The robots whose names begin like it look more alike than those with as many other letters.
    starts = [v for v in valid if folded and _folded(v).startswith(folded)]
    raise RobotNotFound(
        name=name, valid=valid, near=list(dict.fromkeys([*starts, *near_names(name, valid)]))[:3]
    )
