"""Loading a robot by name, from a URDF, or from a ``robot.yaml``."""

from __future__ import annotations

import functools
import math
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from ikplan.errors import InvalidRobot, RobotNotFound
from ikplan.robots.definition.chains import axes_tree, dh_tree
from ikplan.robots.definition.collision import FileOf
from ikplan.robots.definition.describe import describe_file
from ikplan.robots.definition.schema import RobotFile, read_robot_file
from ikplan.robots.description import ShapeSource
from ikplan.robots.folders import package_file, robot_folder, robot_names
from ikplan.robots.loading.changes import HomeGiven, with_changes
from ikplan.robots.loading.from_source import Said, robot_of_source, robot_of_tree
from ikplan.robots.loading.given_limits import LimitsGiven, limit_entries
from ikplan.robots.loading.sources import SUFFIXES, read_bytes, read_source, robot_yaml
from ikplan.robots.names import known_name
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.urdf.urdf import parse_urdf

__all__ = ["catalogue_documents", "catalogue_robot", "is_path", "load_robot", "robot_from_urdf"]

_FILE = "robot.yaml"


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
        return _changed(_from_folder(file, base, tip, name), limits, home)
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
    try:  # to list the whole catalogue takes a millisecond: only where the name is none of it
        folder = robot_folder(name)
    except RobotNotFound:
        name = known_name(name, robot_names())
        folder = robot_folder(name)
    return _from_folder(folder / _FILE, base, tip, rename, expected=name)


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
    return _documents(robot_folder(name) / _FILE, name)


def _documents(path: Path, expected: str | None) -> tuple[bytes, bytes]:
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


def is_path(source: str) -> bool:
    """Whether a text is the path of a file or folder, not a robot's name."""
    separators = {"/", os.sep, os.altsep} - {None}
    return any(s in source for s in separators if s) or source.lower().endswith(SUFFIXES)
