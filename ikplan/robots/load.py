"""Loading a robot by name, from a URDF, or from a ``robot.yaml``."""

from __future__ import annotations

import functools
import math
import os
from dataclasses import replace
from pathlib import Path

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.chains import axes_tree, dh_tree
from ikplan.robots.definition.collision import FileOf
from ikplan.robots.definition.describe import describe_file
from ikplan.robots.definition.schema import RobotFile, read_robot_file
from ikplan.robots.description import ShapeSource
from ikplan.robots.folders import package_file, robot_folder
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.describe_urdf import describe_urdf
from ikplan.robots.urdf.safe_xml import MAX_BYTES
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["catalogue_documents", "catalogue_robot", "load_robot", "robot_from_urdf"]

_FILE = "robot.yaml"


def load_robot(
    source: str | Path,
    *,
    base: str | None = None,
    tip: str | None = None,
    name: str | None = None,
) -> Robot:
    """Load a robot by name or from a file.

    Args:
        source: A name of the catalogue; or a path (a Path, or text with a separator or ending in
            ``.urdf``, ``.xml`` or ``.yaml``) of a URDF, of a ``robot.yaml``, or of the folder
            of one.
        base: Base link. Absent: the root link of a URDF, or the catalogue's.
        tip: Tip link. Absent: the only leaf of a URDF, or the catalogue's.
        name: Name of the robot. Absent: the file's stem, or the catalogue's.

    Returns:
        The robot. Loading the same content again returns the same, immutable object.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: No such file, or a description that makes no sense.
    """
    if isinstance(source, str) and not _is_path(source):
        return catalogue_robot(source, base=base, tip=tip, rename=name)
    path = Path(source)
    if path.is_dir() or path.suffix in (".yaml", ".yml"):
        file = path / _FILE if path.is_dir() else path
        return _from_folder(file, base, tip, name)
    folder = str(path.absolute().parent)
    return _urdf_robot(_read(path, str(path)), base, tip, name or path.stem, folder)


def catalogue_robot(
    name: str, *, base: str | None = None, tip: str | None = None, rename: str | None = None
) -> Robot:
    """Load a robot of the catalogue; unlike :func:`load_robot`, never any other file.

    Args:
        name: Name in the catalogue.
        base: Another base link than the catalogue's.
        tip: Another tip link than the catalogue's.
        rename: Another name for the robot.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: Its description makes no sense.
    """
    folder = robot_folder(name)
    return _from_folder(folder / _FILE, base, tip, rename, expected=name)


def robot_from_urdf(
    document: str | bytes, *, base: str | None = None, tip: str | None = None, name: str = "robot"
) -> Robot:
    """Build a robot from the content of a URDF.

    Args:
        document: The URDF.
        base: Base link; None: the root link.
        tip: Tip link; None: the only leaf.
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
    description = describe_urdf(
        tree, base=base, tip=tip, name=name, title=name, source="the URDF file"
    )
    return Robot(replace(description, shapes=ShapeSource(urdf=document, folder=folder)))


def _from_folder(
    path: Path, base: str | None, tip: str | None, name: str | None, expected: str | None = None
) -> Robot:
    """The robot of a ``robot.yaml`` and the URDF it may name."""
    text, document = _documents(path, expected)
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
        shapes=collision.model_dump_json(exclude_defaults=True).encode(),
        file=_read_if_there(beside, path, file.name),
        srdf=_read_if_there(collision.srdf, path, file.name),
    )


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
    return _read(path, robot) if path.is_file() else b""


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
    return _documents(robot_folder(name) / _FILE, name)


def _documents(path: Path, expected: str | None) -> tuple[bytes, bytes]:
    text = _read(path, str(path))
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
        document = _read(urdf, file.name)
    return text, document


@functools.lru_cache(maxsize=64)
def _parsed_file(text: bytes, robot: str) -> RobotFile:
    try:
        return read_robot_file(text.decode(), robot=robot)
    except UnicodeDecodeError as error:
        raise InvalidRobot(f"{robot}: not UTF-8 text: {error}", robot=robot) from error


@functools.lru_cache(maxsize=64)
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


def _is_path(source: str) -> bool:
    separators = {"/", os.sep, os.altsep} - {None}
    return any(s in source for s in separators if s) or source.lower().endswith(
        (".urdf", ".xml", ".yaml", ".yml")
    )


def _read(path: Path, robot: str) -> bytes:
    """The bytes of a file, refused unread if it is too large."""
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InvalidRobot(
                f"{robot}: {size} bytes; a robot description may have {MAX_BYTES}",
                robot=robot,
                value=size,
            )
        return path.read_bytes()
    except (OSError, ValueError) as error:
        # ValueError: a null byte in the path.
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidRobot(f"{robot}: cannot be read: {reason}", robot=robot) from error
