"""Plans as files and bytes: one file a format, looked up by name, suffix or media type."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ikplan.errors import InvalidRequest
from ikplan.plans.export import (
    as_csv,
    as_drl,
    as_fanuc,
    as_franky,
    as_json,
    as_krl,
    as_npz,
    as_rapid,
    as_ros,
    as_ros_goal,
    as_urscript,
    as_xarm,
)
from ikplan.plans.export.entry_points import others
from ikplan.plans.export.formats import Arm

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.plans.export.formats import Format
    from ikplan.robots import Robot, RobotInfo

__all__ = [
    "FORMATS",
    "check_format",
    "encode",
    "format_for",
    "format_named",
    "known_formats",
    "save",
]

FORMATS: tuple[Format, ...] = (
    as_json.FORMAT,
    as_csv.FORMAT,
    as_npz.FORMAT,
    as_ros.FORMAT,
    as_ros_goal.FORMAT,
    as_urscript.FORMAT,
    as_rapid.FORMAT,
    as_krl.FORMAT,
    as_fanuc.FORMAT,
    as_drl.FORMAT,
    as_xarm.FORMAT,
    as_franky.FORMAT,
)
"""The formats of ikplan; a new one is a module with a ``FORMAT`` and a line here."""
_AT_REST = 1e-9  # velocity of a joint at rest, but for rounding [rad/s or m/s]


def known_formats() -> tuple[Format, ...]:
    """Return every format: those of ikplan, then those of installed packages.

    A package offers one by an entry point of the group ``ikplan.exporters`` that names a
    :class:`Format`.

    Raises:
        InvalidRequest: An entry point names something else, or a name or suffix that is taken.
    """
    return (*FORMATS, *others(FORMATS))


def format_for(path: str | Path) -> Format:
    """Return the format that a file's suffix names.

    Raises:
        InvalidRequest: No format has that suffix; lists those there are.
    """
    name = Path(path).name.lower()
    known = known_formats()
    matches = [f for f in known for suffix in f.suffixes if name.endswith(suffix)]
    if not matches:
        suffixes = [suffix for f in known for suffix in f.suffixes]
        raise InvalidRequest(
            f"cannot tell a format from the file name {str(path)!r}; "
            f"name it with one of {', '.join(suffixes)}",
            field="output",
            allowed=suffixes,
        )
    return max(matches, key=lambda f: max(len(s) for s in f.suffixes if name.endswith(s)))


def format_named(name: str) -> Format:
    """Return the format of that name.

    Raises:
        InvalidRequest: No such format; lists those there are.
    """
    formats = known_formats()
    for known in formats:
        if known.name == name:
            return known
    names = [f.name for f in formats]
    raise InvalidRequest(
        f"no format named {name!r}; known formats: {', '.join(names)}",
        field="format",
        allowed=names,
    )


def check_format(
    robot: RobotInfo | Mapping[str, Any], path: str | Path, name: str | None = None
) -> Format:
    """Return the format of a file for plans of a robot: to be asked before there is a plan.

    Args:
        robot: What is known of the robot: ``robot.info()``, or the document of a service.
        path: The file.
        name: Name of the format; None: the one that the file's suffix names.

    Raises:
        InvalidRequest: No such format, or no plan of this robot can be written in it.
    """
    chosen = format_for(path) if name is None else format_named(name)
    chosen.check(Arm.of_robot(robot))
    return chosen


def encode(
    plan: PlanDocument, name: str, *, robot: Robot | None = None, tolerance: float | None = None
) -> bytes:
    """Return the bytes of a plan in the format of that name.

    Args:
        plan: The plan.
        name: Name of the format.
        robot: The robot with its tool, for formats that thin the plan; None: the catalogue's.
        tolerance: How far such a program may be from the plan's path [m]; None: 0.1 mm.

    Raises:
        InvalidRequest: No such format, or it cannot hold this plan.
    """
    return _encoded(plan, format_named(name), "ikplan_trajectory", robot, tolerance)


def save(
    plan: PlanDocument,
    path: str | Path,
    name: str | None = None,
    *,
    robot: Robot | None = None,
    tolerance: float | None = None,
) -> None:
    """Write a plan to a file.

    Args:
        plan: The plan.
        path: The file; a program is named as it is.
        name: Name of the format; None: the one that the file's suffix names.
        robot: The robot with its tool, for formats that thin the plan; None: the catalogue's.
        tolerance: How far such a program may be from the plan's path [m]; None: 0.1 mm.

    Raises:
        InvalidRequest: No such format, or it cannot hold this plan.
        OSError: The file cannot be written.
    """
    chosen = format_for(path) if name is None else format_named(name)
    stem = Path(path).name.partition(".")[0]
    Path(path).write_bytes(_encoded(plan, chosen, stem, robot, tolerance))


def _encoded(
    plan: PlanDocument, chosen: Format, stem: str, robot: Robot | None, tolerance: float | None
) -> bytes:
    if chosen.from_rest:
        chosen.check(Arm.of_plan(plan))
        _refuse_moving_ends(plan, chosen)
    if chosen.program is not None:
        return chosen.program(plan, stem, robot, tolerance)
    if tolerance is not None:
        raise InvalidRequest(
            f"{chosen.name} is written as it is planned: no tolerance is needed",
            field="tolerance",
            allowed=[f.name for f in FORMATS if f.program is not None],
        )
    return chosen.encode(plan)


def _refuse_moving_ends(plan: PlanDocument, chosen: Format) -> None:
    speeds = np.abs(plan.trajectory.dq[[0, -1]])
    if speeds.max() <= _AT_REST:
        return
    end, joint = np.unravel_index(int(np.argmax(speeds > _AT_REST)), speeds.shape)
    raise InvalidRequest(
        f"a program in the format {chosen.name} begins and ends at rest, and this plan "
        f"{('begins', 'ends')[end]} in motion: {plan.joint_names[joint]} at "
        f"{plan.trajectory.dq[-int(end), joint]:.6g} {plan.joint_units[joint]}/s",
        field="format",
        allowed=[f.name for f in known_formats() if not f.from_rest],
    )
