"""From a description and what is said with it to a robot: tip, limits and home are found here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ikplan.robots.definition.couplings import user_joints
from ikplan.robots.definition.describe import moving_chain
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import ShapeSource
from ikplan.robots.loading.changes import HomeGiven, home_by_joint
from ikplan.robots.loading.companions import Companion, find_home, find_joint_limits
from ikplan.robots.loading.given_limits import LimitsGiven, limit_entries
from ikplan.robots.loading.home import with_good_home
from ikplan.robots.loading.sources import RobotSource
from ikplan.robots.loading.tip import pick_chain
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.describe_urdf import Given, describe_urdf
from ikplan.robots.urdf.tree import KinematicTree

__all__ = ["Said", "robot_of_source", "robot_of_tree"]


@dataclass(frozen=True)
class Said:
    """What is said with a description, and replaces what it says or what a rule would find.

    Attributes:
        base: Base link.
        tip: Tip link.
        limits: Limits by joint, or the path of a ``joint_limits.yaml``.
        home: Home, one value a joint or by joint [rad or m].
        coupling: Joints as sums of factors times the controller's.
        velocity_default: Name of the default for turning joints without a velocity limit.
    """

    base: str | None = None
    tip: str | None = None
    limits: LimitsGiven | None = None
    home: HomeGiven | None = None
    coupling: Mapping[str, Mapping[str, float]] | None = None
    velocity_default: str | None = None


def robot_of_source(source: RobotSource, said: Said, *, name: str) -> Robot:
    """Build the robot of a description, with the files of its package.

    Args:
        source: The description.
        said: What replaces what it says.
        name: Name of the robot.

    Raises:
        InvalidRobot: There are several arms and no tip; or the chain, a limit or the home makes
            no sense.
    """
    tree = replace(source.tree, name=name)
    base, tip, _ = _chain(tree, said)
    joints = [joint.name for joint in user_joints(moving_chain(tree, base, tip))]
    limits = (
        Companion() if said.limits is not None else find_joint_limits(source.file, tree, joints)
    )
    home = Companion() if said.home is not None else find_home(source.file, tree, joints)
    return robot_of_tree(
        tree,
        said,
        name=name,
        source=str(source),
        entries=[*source.entries, *limits.entries],
        entries_of=str(source) if limits.file is None else limits.file.name,
        found_home=home,
        notes=[note for note in (limits.note, home.note) if note],
        shapes=ShapeSource(
            urdf=source.urdf,
            folder=str(source.file.absolute().parent),
            srdf=b"" if home.file is None else home.file.read_bytes(),
        ),
    )


def robot_of_tree(
    tree: KinematicTree,
    said: Said,
    *,
    name: str,
    source: str,
    entries: list[JointEntry] | None = None,
    entries_of: str = "",
    found_home: Companion | None = None,
    notes: list[str] | None = None,
    shapes: ShapeSource | None = None,
) -> Robot:
    """Build the robot of a tree.

    Args:
        tree: The kinematics and inertias.
        said: What replaces what it says.
        name: Name of the robot.
        source: Where the tree comes from, in words.
        entries: Limits that were found with it.
        entries_of: Where those come from, in words.
        found_home: The home that was found with it.
        notes: What a user should know.
        shapes: Where the shapes of the links are; None: nothing is known of them.

    Raises:
        InvalidRobot: As :func:`robot_of_source`.
    """
    base, tip, chosen = _chain(tree, said)
    merged = {entry.name: _strictest(tree, entry) for entry in entries or []}
    where = [entries_of] if merged else []
    if said.limits is not None:
        where.append("what was given with it")
        for entry in limit_entries(said.limits, robot=name):
            update = entry.model_dump(exclude_none=True)
            before = merged.get(entry.name, JointEntry(name=entry.name))
            merged[entry.name] = before.model_copy(update=update)
    home, given_home = None, ""
    if said.home is not None:
        chain = user_joints(moving_chain(tree, base, tip))
        home = home_by_joint(said.home, [joint.name for joint in chain], robot=name)
    elif found_home is not None and found_home.group is not None and found_home.file is not None:
        home, given_home = found_home.group.home, f"the home of {found_home.file.name}"
    described = describe_urdf(
        tree,
        base=base,
        tip=tip,
        name=name,
        title=name,
        source=source,
        given=Given(
            entries=list(merged.values()),
            loose=not isinstance(said.limits, Mapping),
            source=" and ".join(where),
            home=home,
            coupling=said.coupling,
            velocity_default=said.velocity_default,
        ),
        notes=[*chosen, *(notes or [])],
    )
    if shapes is not None:
        described = replace(described, shapes=shapes)
    if said.home is not None:
        return Robot(described)
    return with_good_home(described, given_home)


def _chain(tree: KinematicTree, said: Said) -> tuple[str, str, list[str]]:
    if said.tip is None:
        return pick_chain(tree, said.base)
    return said.base or tree.root, said.tip, []


def _strictest(tree: KinematicTree, entry: JointEntry) -> JointEntry:
    """Of a limit in a file beside a description and in itself, the narrower one."""
    own = next((joint.limit for joint in tree.joints if joint.name == entry.name), None)
    if own is None:
        return entry
    changes: dict[str, float] = {}
    for key in ("upper", "velocity", "acceleration", "effort", "lower"):
        theirs, ours = getattr(entry, key), getattr(own, key)
        if theirs is None or ours is None or (key not in ("lower", "upper") and ours <= 0):
            continue
        changes[key] = max(theirs, ours) if key == "lower" else min(theirs, ours)
    return entry.model_copy(update=changes)
