"""Files that belong to a description: its SRDF and its joint limits, found in the same package."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.loading.given_limits import read_joint_limits
from ikplan.robots.loading.packages import package_root
from ikplan.robots.urdf.safe_xml import MAX_BYTES
from ikplan.robots.urdf.srdf import Group, chain_groups
from ikplan.robots.urdf.tree import KinematicTree

__all__ = ["Companion", "find_home", "find_joint_limits"]

_FOLDERS = ("", "config", "srdf", "urdf")
_MOST_FILES = 400


@dataclass(frozen=True)
class Companion:
    """What was found beside a description.

    Attributes:
        file: The file; None: nothing that can be used was found.
        note: What was not used, and why; empty: nothing to say.
        entries: Limits by joint.
        group: The group of an SRDF.
    """

    file: Path | None = None
    note: str = ""
    entries: tuple[JointEntry, ...] = ()
    group: Group | None = None


def find_joint_limits(file: Path, tree: KinematicTree, joints: Sequence[str]) -> Companion:
    """Find the ``joint_limits.yaml`` of a description.

    Args:
        file: The description.
        tree: What it describes.
        joints: Names of the joints of its chain; a file that has none of them is passed over.
    """
    found: dict[Path, tuple[JointEntry, ...]] = {}
    for path in _near(file, "*joint_limits*.y*ml"):
        try:
            entries = read_joint_limits(path.read_bytes(), robot=path.name)
        except (InvalidRobot, OSError):
            continue
        ours = tuple(entry for entry in entries if entry.name in joints)
        if ours:
            found[path] = ours
    chosen = _one_of(list(found), tree, file)
    if isinstance(chosen, str):
        return Companion(note=f"joint limits: {chosen}" if chosen else "")
    return Companion(chosen, entries=found[chosen])


def find_home(file: Path, tree: KinematicTree, joints: Sequence[str]) -> Companion:
    """Find the home of a description in its SRDF.

    Args:
        file: The description.
        tree: What it describes.
        joints: Names of the joints of its chain, all of which the state must give.
    """
    found: dict[Path, Group] = {}
    for path in _near(file, "*.srdf"):
        try:
            groups = chain_groups(path.read_bytes(), tree, robot=path.name)
        except (InvalidRobot, OSError):
            continue
        for group in groups:
            if set(joints) <= set(group.home):
                home = {name: group.home[name] for name in joints}
                found.setdefault(path, Group(group.name, group.base, group.tip, home))
    chosen = _one_of(list(found), tree, file)
    if isinstance(chosen, str):
        return Companion(note=f"SRDF: {chosen}" if chosen else "")
    return Companion(chosen, group=found[chosen])


def _one_of(files: Sequence[Path], tree: KinematicTree, description: Path) -> Path | str:
    """The only file, or the one that is named for the robot; else why there is none, in words."""
    if len(files) == 1:
        return files[0]
    stem = description.name.split(".")[0].lower()
    named = [f for f in files if {tree.name.lower(), stem} & {*_words(f, description)}]
    if len(named) == 1:
        return named[0]
    if not files:
        return ""
    return f"{len(files)} files fit, none was used: {', '.join(f.name for f in files[:5])}"


def _words(file: Path, description: Path) -> Iterator[str]:
    """What a file is named for: its own name without what it is, and that of folders of its own."""
    name = file.name.lower().split(".")[0]
    yield name.removesuffix("joint_limits").rstrip("_")
    yield name
    shared = set(description.resolve().parents)
    for folder in list(file.parents)[:2]:
        if folder in shared:
            break
        yield folder.name.lower().removesuffix("_moveit_config")


def _near(file: Path, pattern: str) -> list[Path]:
    """Files of a pattern beside a description, and in its package or the folder above it."""
    folder = file.resolve().parent
    root = package_root(file)
    found: dict[Path, None] = {}
    for place in (folder, *([] if root is not None else [folder.parent])):
        for name in _FOLDERS:
            for path in sorted((place / name).glob(pattern)):
                found[path] = None
    if root is not None:
        for path in sorted(root.rglob(pattern))[:_MOST_FILES]:
            found[path] = None
    return [p for p in found if p.is_file() and p.stat().st_size <= MAX_BYTES][:_MOST_FILES]
