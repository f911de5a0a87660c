"""A robot as its ``robot.yaml`` and the files that it names describe it."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from pathlib import Path

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.chains import axes_tree, dh_tree
from ikplan.robots.definition.collision import FileOf
from ikplan.robots.definition.describe import describe_file
from ikplan.robots.definition.schema import RobotFile, read_robot_file
from ikplan.robots.description import ShapeSource
from ikplan.robots.folders import package_file, package_places
from ikplan.robots.loading.sources import read_bytes
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["ROBOT_FILE", "documents_of_file", "files_beside", "robot_of_file"]

ROBOT_FILE = "robot.yaml"
"""Name of the file."""


def robot_of_file(
    path: Path, base: str | None, tip: str | None, name: str | None, expected: str | None = None
) -> Robot:
    """Return the robot of a ``robot.yaml`` and of the files that it names.

    Args:
        path: The ``robot.yaml``.
        base: Another base link; None: the file's.
        tip: Another tip link; None: the file's.
        name: Another name; None: the file's.
        expected: The name that the file must give; None: any.

    Raises:
        InvalidRobot: A file cannot be read, or the description makes no sense.
    """
    text, document = documents_of_file(path, expected)
    return _file_robot(text, document, _shape_source(path, text, document), base, tip, name)


def _shape_source(path: Path, text: bytes, document: bytes) -> ShapeSource:
    """Read, and do not parse, what gives the links their shapes."""
    file = _parsed_file(text, path.parent.name or str(path))
    fixed = tuple(sorted(file.fixed_joints.items()))
    folder, urdf = None, file.kinematics.urdf
    if urdf is not None and urdf.package is None:
        folder = str((path.parent / urdf.path).absolute().parent)
    source = ShapeSource(urdf=document, folder=folder, fixed_joints=fixed)
    collision = file.collision
    if collision is None:
        return source
    beside = None if collision.file is None else FileOf(path=collision.file)
    return replace(
        source,
        shapes=_shapes_text(text, file.name),
        file=_read_if_there(beside, path, file.name),
        srdf=_read_if_there(collision.srdf, path, file.name),
    )


@functools.lru_cache(maxsize=256)
def _shapes_text(text: bytes, robot: str) -> bytes:
    """The entry ``collision`` of a ``robot.yaml``, as JSON."""
    entry = _parsed_file(text, robot).collision
    return b"" if entry is None else entry.model_dump_json(exclude_defaults=True).encode()


def _read_if_there(file: FileOf | None, beside: Path, robot: str) -> bytes:
    """The bytes of a file; none where it is not installed.

    Kinematics do without it, and so do collision checks: a link takes its shape from the URDF
    then or is listed as unchecked, and without an SRDF more pairs are checked.
    """
    if file is None:
        return b""
    try:
        path = package_file(file.package, file.path) if file.package else beside.parent / file.path
    except InvalidRobot:
        return b""
    return read_bytes(path, robot) if path.is_file() else b""


def files_beside(path: Path, robot: str) -> tuple[str, ...]:
    """Return the files beside a ``robot.yaml`` that its robot may be read from, there or not.

    Args:
        path: The ``robot.yaml``.
        robot: The name to give in messages.

    Raises:
        InvalidRobot: It cannot be read, or makes no sense.
    """
    file = _parsed_file(read_bytes(path, str(path)), robot)
    collision = file.collision
    beside = None if collision is None or collision.file is None else FileOf(path=collision.file)
    places: list[Path] = []
    for named in (file.kinematics.urdf, beside, None if collision is None else collision.srdf):
        if named is not None and named.package is not None:
            places += package_places(named.package, named.path)
        elif named is not None:
            places.append(path.parent / named.path)
    return tuple(str(place) for place in places)


def documents_of_file(path: Path, expected: str | None) -> tuple[bytes, bytes]:
    """Return a ``robot.yaml`` and the URDF it names, no bytes where it names none.

    Args:
        path: The ``robot.yaml``.
        expected: The name that the file must give; None: any.

    Raises:
        InvalidRobot: A file cannot be read, or the ``robot.yaml`` makes no sense.
    """
    text = read_bytes(path, str(path))
    file = _parsed_file(text, expected or path.parent.name or str(path))
    if expected is not None and file.name != expected:
        raise InvalidRobot(
            f"{expected}: name: {file.name!r} in the folder {expected!r}",
            robot=expected,
            value=file.name,
        )
    document = b""
    if file.kinematics.urdf is not None:
        package, relative = file.kinematics.urdf.package, file.kinematics.urdf.path
        urdf = package_file(package, relative) if package else path.parent / relative
        document = read_bytes(urdf, file.name)
    return text, document


@functools.lru_cache(maxsize=256)
def _parsed_file(text: bytes, robot: str) -> RobotFile:
    try:
        return read_robot_file(text.decode(), robot=robot)
    except UnicodeDecodeError as error:
        raise InvalidRobot(f"{robot}: not UTF-8 text: {error}", robot=robot) from error


@functools.lru_cache(maxsize=256)
def _file_robot(
    text: bytes,
    document: bytes,
    shapes: ShapeSource,
    base: str | None,
    tip: str | None,
    name: str | None,
) -> Robot:
    """The robot of these very contents: pure, so that it can be kept."""
    file = read_robot_file(text.decode(), robot="")
    tree = _tree(file, document)
    description = describe_file(file, tree, base=base, tip=tip, name=name)
    if file.collision is not None:
        for link in file.collision.links:
            tree.require_link(link, "link of a shape")
    joints = [joint.name for joint in tree.joints]
    for joint in file.fixed_joints:
        if joint not in joints:
            raise InvalidRobot(
                f"{file.name}: fixed_joints: no joint {joint!r}; there are {', '.join(joints)}",
                robot=file.name,
                joint=joint,
                valid=joints,
            )
    return Robot(replace(description, shapes=shapes))


def _tree(file: RobotFile, document: bytes) -> KinematicTree:
    kinematics = file.kinematics
    radians = math.radians(1.0) if file.angle_unit == "deg" else 1.0
    if kinematics.axes is not None:
        return axes_tree(file.name, kinematics.axes, base=file.base, radians=radians)
    if kinematics.dh is None:
        return parse_urdf(document, robot=file.name)
    names = [joint.name for joint in file.joints]
    if len(kinematics.dh.rows) != len(names):
        raise InvalidRobot(
            f"{file.name}: kinematics.dh: {len(kinematics.dh.rows)} rows for {len(names)} joints",
            robot=file.name,
            value="kinematics.dh",
        )
    return dh_tree(file.name, kinematics.dh, names, base=file.base, tip=file.tip, radians=radians)
