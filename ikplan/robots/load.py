"""Loading a robot by name, from a URDF, or from a ``robot.yaml``."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from ikplan.errors import InvalidRobot, RobotNotFound
from ikplan.robots.description import ShapeSource
from ikplan.robots.folders import robot_folder, robot_names, searched_folders
from ikplan.robots.loading.changes import HomeGiven, with_changes
from ikplan.robots.loading.file_stamps import Stamp, stamp
from ikplan.robots.loading.from_source import Said, robot_of_source, robot_of_tree
from ikplan.robots.loading.given_limits import LimitsGiven, limit_entries
from ikplan.robots.loading.robot_file import (
    ROBOT_FILE,
    documents_of_file,
    files_beside,
    robot_of_file,
)
from ikplan.robots.loading.sources import SUFFIXES, read_bytes, read_source, robot_yaml
from ikplan.robots.names import known_name
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["catalogue_documents", "catalogue_robot", "is_path", "load_robot", "robot_from_urdf"]


def load_robot(
    source: str | Path,
    *,
    base: str | None = None,
    tip: str | None = None,
    name: str | None = None,
    args: Mapping[str, str] | None = None,
    limits: LimitsGiven | None = None,
    home: HomeGiven | None = None,
    coupling: Mapping[str, Mapping[str, float]] | None = None,
    velocity_default: str | None = None,
) -> Robot:
    """Load a robot by name or from a file or folder.

    Args:
        source: A name of the catalogue; or a path (a Path, or text with a separator or ending in
            ``.urdf``, ``.xacro``, ``.xml``, ``.yaml`` or ``.csv``) of a URDF, of a xacro file, of a
            DH table in YAML or CSV, of a ``robot.yaml``, or of the folder of one, such as a
            description package. A xacro file is expanded, which runs Python expressions in it:
            load files that you trust.
        base: Base link. Absent: the root link of a URDF, or the catalogue's.
        tip: Tip link. Absent: the tool frame of the only arm of a URDF, or the catalogue's.
        name: Name of the robot. Absent: the file's stem, or the catalogue's.
        args: Arguments of a xacro file, or settings of a DH table.
        limits: Limits that replace others, by joint: lower and upper [rad or m], velocity and
            acceleration [per second], effort [N m or N]; or the path of a ``joint_limits.yaml``.
            Absent: a ``joint_limits.yaml`` of the description's package is read.
        home: One value a joint, or values by joint [rad or m]. Absent: the SRDF's, if it is not
            singular; else a well conditioned posture near the middle of the ranges.
        coupling: For a controller that counts joints otherwise than the description: its joints as
            sums of factors times the controller's, as ``{"J3": {"J2": 1, "J3": 1}}`` for a FANUC.
        velocity_default: Name of the default for turning joints whose velocity limit is 0 or
            absent, ``"90-deg-per-s"``. Absent: they are refused.

    Returns:
        The robot. Loading the same URDF, or the same robot of the catalogue, again returns the
        same, immutable object.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: No such file, or a description that makes no sense.
    """
    if isinstance(source, str) and not is_path(source):
        _refuse_for_yaml(source, args, coupling, velocity_default)
        robot = catalogue_robot(source, base=base, tip=tip, rename=name)
        return _changed(robot, limits, home)
    path = Path(source)
    if not path.exists():
        read_bytes(path, str(path))  # says so
    if (file := robot_yaml(path)) is not None:
        _refuse_for_yaml(str(path), args, coupling, velocity_default)
        return _changed(robot_of_file(file, base, tip, name), limits, home)
    said = Said(base, tip, limits, home, coupling, velocity_default)
    found = read_source(path, args)
    return robot_of_source(found, said, name=name or found.file.name.split(".")[0] or "robot")


def _changed(robot: Robot, limits: LimitsGiven | None, home: HomeGiven | None) -> Robot:
    if limits is None and home is None:
        return robot
    entries = [] if limits is None else limit_entries(limits, robot=robot.name)
    return Robot(with_changes(robot.description, entries, home))


def _refuse_for_yaml(
    source: str,
    args: Mapping[str, str] | None,
    coupling: Mapping[str, Mapping[str, float]] | None,
    velocity_default: str | None,
) -> None:
    for key, value in (
        ("args", args),
        ("coupling", coupling),
        ("velocity_default", velocity_default),
    ):
        if value:
            raise InvalidRobot(
                f"{source}: {key} belongs to a URDF, xacro file or DH table; a robot.yaml says "
                "this itself",
                robot=source,
                value=key,
            )


def catalogue_robot(
    name: str, *, base: str | None = None, tip: str | None = None, rename: str | None = None
) -> Robot:
    """Load a robot of the catalogue; unlike :func:`load_robot`, never any other file.

    Args:
        name: Name in the catalogue, in whatever case and with whatever marks between its letters,
            or another name of the same arm.
        base: Another base link than the catalogue's.
        tip: Another tip link than the catalogue's.
        rename: Another name for the robot.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: Its description makes no sense.
    """
    found = functools.partial(_unchanged, searched_folders(), base=base, tip=tip, rename=rename)
    try:  # to list the whole catalogue takes a millisecond: only where the name is none of it
        return found(name=name)
    except RobotNotFound:
        return found(name=known_name(name, robot_names()))


def _unchanged(
    folders: tuple[str, ...], *, name: str, base: str | None, tip: str | None, rename: str | None
) -> Robot:
    """The robot of a name of the catalogue; what its files say is read anew once they change."""
    stamps = tuple(stamp(os.path.join(folder, name, ROBOT_FILE)) for folder in folders)
    files = _files_of(name, folders, stamps, tuple(sys.path))
    known = (*stamps, *(stamp(file) for file in files))
    return _catalogue_robot(name, base, tip, rename, folders, files, known)


@functools.lru_cache(maxsize=256)
def _files_of(
    name: str,
    folders: tuple[str, ...],  # noqa: ARG001 - part of the key: where it is looked for
    stamps: tuple[Stamp, ...],  # noqa: ARG001 - part of the key: the state of what is there
    search_path: tuple[str, ...],  # noqa: ARG001 - part of the key: where packages are found
) -> tuple[str, ...]:
    """The files beside its ``robot.yaml`` that a robot of the catalogue may be read from."""
    return files_beside(robot_folder(name) / ROBOT_FILE, name)


@functools.lru_cache(maxsize=256)
def _catalogue_robot(
    name: str,
    base: str | None,
    tip: str | None,
    rename: str | None,
    folders: tuple[str, ...],  # noqa: ARG001 - part of the key: where it is looked for
    files: tuple[str, ...],  # noqa: ARG001 - part of the key: what it is read from
    stamps: tuple[Stamp, ...],  # noqa: ARG001 - part of the key: the state of these files
) -> Robot:
    return robot_of_file(robot_folder(name) / ROBOT_FILE, base, tip, rename, expected=name)


def robot_from_urdf(
    document: str | bytes, *, base: str | None = None, tip: str | None = None, name: str = "robot"
) -> Robot:
    """Build a robot from the content of a URDF.

    Args:
        document: The URDF.
        base: Base link; None: the root link.
        tip: Tip link; None: the tool frame of the only arm.
        name: Name of the robot.

    Raises:
        InvalidRobot: Not a URDF, or a description that makes no sense.
    """
    data = document.encode() if isinstance(document, str) else bytes(document)
    return _urdf_robot(data, base, tip, name)


@functools.lru_cache(maxsize=64)
def _urdf_robot(
    document: bytes, base: str | None, tip: str | None, name: str, folder: str | None = None
) -> Robot:
    tree = parse_urdf(document, robot=name)
    return robot_of_tree(
        tree,
        Said(base, tip),
        name=name,
        source="the URDF file",
        shapes=ShapeSource(urdf=document, folder=folder),
    )


def catalogue_documents(name: str) -> tuple[bytes, bytes]:
    """Return the ``robot.yaml`` of a robot of the catalogue and the URDF it names.

    Args:
        name: Name in the catalogue.

    Returns:
        Both as they are; no bytes for a robot that names no URDF.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: A file cannot be read, or the ``robot.yaml`` makes no sense.
    """
    name = known_name(name, robot_names())
    return documents_of_file(robot_folder(name) / ROBOT_FILE, name)


def is_path(source: str) -> bool:
    """Whether a text is the path of a file or folder, not a robot's name."""
    separators = {"/", os.sep, os.altsep} - {None}
    return any(s in source for s in separators if s) or source.lower().endswith(SUFFIXES)
