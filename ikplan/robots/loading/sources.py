"""A robot of a file or folder, in whatever form people have it: what it says, as one tree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import yaml

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.loading.dh_files import is_dh_document, read_dh_file
from ikplan.robots.loading.xacro_files import expand_xacro, is_xacro
from ikplan.robots.urdf.safe_xml import MAX_BYTES
from ikplan.robots.urdf.tree import KinematicTree
from ikplan.robots.urdf.urdf import parse_urdf
from ikplan.robots.yaml_text import load_yaml

__all__ = ["RobotSource", "find_description", "is_whole", "read_bytes", "read_source", "robot_yaml"]

SUFFIXES = (".urdf", ".xacro", ".xml", ".yaml", ".yml", ".csv", ".sdf", ".mjcf")
_FILE = "robot.yaml"
_MOST_FILES = 2_000


@dataclass(frozen=True)
class RobotSource:
    """What a file says of a robot.

    Attributes:
        file: The file.
        tree: The kinematics and inertias.
        urdf: The URDF, expanded; of a DH table, the one that it comes down to.
        kind: What the file is, in words: "the URDF file", "the xacro file", "the DH table".
        entries: Limits that the file gives beside the tree.
        arguments: The arguments that it was read with.
    """

    file: Path
    tree: KinematicTree
    urdf: bytes
    kind: str
    entries: tuple[JointEntry, ...] = ()
    arguments: Mapping[str, str] | None = None

    def __str__(self) -> str:
        said = " ".join(f"{k}:={v}" for k, v in sorted((self.arguments or {}).items()))
        return f"{self.kind} {self.file.name}" + (f" {said}" if said else "")


def robot_yaml(path: Path) -> Path | None:
    """Return the ``robot.yaml`` that a path is or holds; None: it is another description."""
    if path.is_dir():
        return path / _FILE if (path / _FILE).is_file() else None
    if path.suffix.lower() not in (".yaml", ".yml"):
        return None
    try:
        content = load_yaml(read_bytes(path, str(path)))
    except (yaml.YAMLError, RecursionError):
        return path  # its own reader says what is wrong
    return None if is_dh_document(content) else path


def read_source(path: Path, arguments: Mapping[str, str] | None = None) -> RobotSource:
    """Read a description: a URDF, a xacro file, a DH table, or a folder with one of them.

    Args:
        path: The file or folder.
        arguments: Arguments of a xacro file, settings of a DH table.

    Raises:
        InvalidRobot: It cannot be read, or makes no sense.
    """
    arguments = dict(arguments or {})
    file = find_description(path) if path.is_dir() else path
    document = read_bytes(file, str(file))
    name = file.name.split(".")[0] or "robot"
    if file.suffix.lower() in (".csv", ".yaml", ".yml"):
        tree, entries = read_dh_file(file, document, arguments, robot=name)
        urdf = tree.to_urdf({joint.name for joint in tree.joints if joint.kind != "fixed"})
        return RobotSource(file, tree, urdf.encode(), "the DH table", tuple(entries), arguments)
    kind = "the URDF file"
    if is_xacro(file, document):
        document, kind = expand_xacro(file, arguments), "the xacro file"
    elif arguments:
        raise InvalidRobot(
            f"{file}: takes no arguments ({', '.join(arguments)}): it is not a xacro file",
            robot=str(file),
            value=next(iter(arguments)),
        )
    return RobotSource(file, parse_urdf(document, robot=name), document, kind, (), arguments)


def find_description(folder: Path) -> Path:
    """Return the description in a folder or package.

    Of several the one named for the folder is taken; ``.urdf`` goes before ``.urdf.xacro`` of the
    same name; macros and parts (files that no robot is the outermost element of) are passed over.

    Raises:
        InvalidRobot: There is none, or there are several; they are listed.
    """
    found: dict[str, Path] = {}
    for pattern in ("*.urdf", "*.urdf.xacro", "*.xacro"):
        for place in (folder, folder / "urdf", folder / "robots"):
            for file in sorted(place.glob(pattern)):
                found.setdefault(file.name.split(".")[0], file)
        if not found and not pattern.startswith("*.xacro"):
            for file in sorted(folder.rglob(pattern))[:_MOST_FILES]:
                found.setdefault(file.name.split(".")[0], file)
    whole = {name: file for name, file in found.items() if is_whole(file)}
    if not whole:
        raise InvalidRobot(
            f"{folder}: {_FILE}: cannot be read: No such file or directory; and no .urdf, "
            ".urdf.xacro or DH table is in it or its urdf folder",
            robot=str(folder),
        )
    if len(whole) == 1:
        return next(iter(whole.values()))
    plain = folder.resolve().name.lower().removesuffix("_description").removesuffix("_support")
    for name, file in whole.items():
        if name.lower().removesuffix("_robot") in (plain, folder.resolve().name.lower()):
            return file
    files = [str(file.relative_to(folder)) for file in whole.values()]
    raise InvalidRobot(
        f"{folder}: name the file; there are {len(files)} descriptions: {', '.join(files[:40])}",
        robot=str(folder),
        valid=files,
    )


def is_whole(file: Path) -> bool:
    """Whether a file describes a robot, not only macros for others."""
    text = file.read_bytes()[:MAX_BYTES]
    if file.suffix.lower() != ".xacro":
        return True
    name = b"<robot " in text and b" name=" in text[text.find(b"<robot ") :].split(b">", 1)[0]
    after = text.split(b"</xacro:macro>")[-1]
    return name and (b"<xacro:" in after or b"<link" in after)


def read_bytes(path: Path, robot: str) -> bytes:
    """The bytes of a file, refused unread if it is too large.

    Raises:
        InvalidRobot: It cannot be read, or is too large.
    """
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
