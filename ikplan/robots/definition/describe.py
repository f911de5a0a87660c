"""From a tree and what a ``robot.yaml`` says about it to a checked description."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ikplan.documents.controller import Controller
from ikplan.errors import InvalidRobot
from ikplan.robots.definition.assumptions import default_assumptions
from ikplan.robots.definition.couplings import mimic_coupling
from ikplan.robots.definition.joint_spec import joint_spec
from ikplan.robots.definition.schema import JointEntry, RobotFile
from ikplan.robots.description import Coupling, JointSpec, LimitSource, RobotDescription
from ikplan.robots.urdf.rerooting import passes_upwards, rooted_for
from ikplan.robots.urdf.tree import MOVABLE, Joint, KinematicTree

__all__ = ["MAX_MOVABLE_JOINTS", "MOVING_BASE", "check_jerks", "describe_file", "moving_chain"]

MAX_MOVABLE_JOINTS = 64
MOVING_BASE = (
    "the way to the tip goes up from the base {base!r}, which moves with the joints above it, and "
    "gravity has no fixed direction in it"
)
"""What a user should know of a robot whose base is on another branch than its tip."""


def moving_chain(tree: KinematicTree, base: str, tip: str) -> tuple[Joint, ...]:
    """The joints that move between ``base`` and ``tip``, in that order, those that mimic included.

    The way may go up one branch of the tree and down another.

    Raises:
        InvalidRobot: There is none, or more than can be read; one is floating or planar, or has a
            zero axis; or a number of a joint of the chain makes no sense.
    """
    every = rooted_for(tree, base, tip).chain(base, tip)
    chain = [j for j in every if j.kind != "fixed"]
    if len(chain) > MAX_MOVABLE_JOINTS:
        raise InvalidRobot(
            f"{tree.name}: {len(chain)} movable joints; at most {MAX_MOVABLE_JOINTS} can be "
            f"between {base!r} and {tip!r}",
            robot=tree.name,
            value=len(chain),
        )
    for joint in every:
        if joint.faults:
            raise joint.faults[0]
    for joint in chain:
        if joint.kind not in MOVABLE:
            raise InvalidRobot(
                f"{tree.name}: joint {joint.name!r} between {base!r} and {tip!r} is "
                f"{joint.kind}; only {', '.join(MOVABLE)} joints can be on the chain",
                robot=tree.name,
                joint=joint.name,
                value=joint.kind,
                valid=MOVABLE,
            )
        if not any(joint.axis):
            raise InvalidRobot(
                f"{tree.name}: joint {joint.name!r} has a zero axis",
                robot=tree.name,
                joint=joint.name,
                value=list(joint.axis),
            )
    if not chain:
        raise InvalidRobot(
            f"{tree.name}: nothing moves between the base {base!r} and the tip {tip!r}",
            robot=tree.name,
            value=tip,
        )
    return tuple(chain)


def describe_file(
    file: RobotFile,
    tree: KinematicTree,
    *,
    base: str | None = None,
    tip: str | None = None,
    name: str | None = None,
) -> RobotDescription:
    """Describe a robot of a ``robot.yaml``; ``base``, ``tip`` and ``name`` replace its own.

    Raises:
        InvalidRobot: The file and its kinematics do not fit, or a limit makes no sense.
    """
    own_chain = base in (None, file.base) and tip in (None, file.tip)
    base, tip = base or file.base, tip or file.tip
    kinds = {e.name: e.type for e in file.joints if e.type == "continuous"}
    tree = tree.with_kinds(
        {j.name: kinds[j.name] for j in tree.joints if j.kind == "revolute" and j.name in kinds}
    )
    upwards = passes_upwards(tree, base, tip)
    tree = rooted_for(tree, base, tip)
    chain = moving_chain(tree, base, tip)
    if file.coupling is None and (mimic := mimic_coupling(tree.name, chain)):
        raise InvalidRobot(
            f"{tree.name}: a joint on the chain mimics another; give the coupling: "
            f"{[list(row) for row in mimic.matrix]}",
            robot=tree.name,
            value="coupling",
        )
    entries = {entry.name: entry for entry in file.joints}
    home = dict(zip(entries, file.home, strict=True)) if len(entries) == len(file.home) else {}
    if not home:
        raise InvalidRobot(f"{file.name}: joints: a name is given twice", robot=file.name)
    unit = math.radians(1.0) if file.angle_unit == "deg" else 1.0
    sources = _limit_sources(file)
    coupling = None
    joints: Sequence[Joint | None] = chain
    if file.coupling is not None:
        coupling = _coupling(file, chain)
        joints = [None] * len(file.joints)
        names = list(entries)
    else:
        names = [j.name for j in chain]
        if own_chain and names != list(entries):
            raise InvalidRobot(
                f"{file.name}: joints: {', '.join(entries)}; the chain from {base} to {tip} has "
                f"{', '.join(names)}, in that order",
                robot=file.name,
                value=list(entries),
                valid=names,
            )
    specs = tuple(
        joint_spec(entries.get(n, JointEntry(name=n)), joint, home.get(n), sources, file.name, unit)
        for n, joint in zip(names, joints, strict=True)
    )
    return RobotDescription(
        name=name or file.name,
        title=file.title,
        urdf=tree.to_urdf({j.name for j in chain}),
        base=base,
        tip=tip,
        joints=specs,
        coupling=coupling,
        limit_sources=sources,
        sources=tuple(str(s) for s in file.sources),
        notes=(*file.notes, *([MOVING_BASE.format(base=base)] if upwards else ())),
        inertias_sourced=file.inertias is not None and not upwards,
        controller=_controller(file, specs, unit, base),
        assumptions=default_assumptions(sources, [entries.get(n) for n in names], joints),
    )


def check_jerks(controller: Controller, joints: Sequence[str], robot: str) -> None:
    """Refuse jerk limits that are not one a joint.

    Raises:
        InvalidRobot: Names the joints.
    """
    if controller.jerk is not None and len(controller.jerk) != len(joints):
        raise InvalidRobot(
            f"{robot}: controller.jerk: give {len(joints)} numbers ({', '.join(joints)}), "
            f"not {len(controller.jerk)}",
            robot=robot,
            value="controller.jerk",
        )


def _controller(
    file: RobotFile, joints: Sequence[JointSpec], unit: float, base: str
) -> Controller | None:
    """The controller, as far as it moves a chain; None: the chain has joints that it does not."""
    names = [entry.name for entry in file.joints]
    if file.controller is None or any(joint.name not in names for joint in joints):
        return None
    check_jerks(file.controller, names, file.name)
    jerk = file.controller.jerk
    if jerk is not None:
        own = dict(zip(names, jerk, strict=True))
        jerk = [own[j.name] * (1.0 if j.kind == "prismatic" else unit) for j in joints]
    frame = file.controller.base_frame if base == file.base else None
    return file.controller.model_copy(update={"jerk": jerk, "base_frame": frame})


def _limit_sources(file: RobotFile) -> tuple[LimitSource, ...]:
    found = []
    for key in ("position", "velocity", "acceleration", "effort"):
        entry = getattr(file.limits, key)
        if entry is not None:
            found.append(LimitSource(key, entry.source, entry.default, entry.verified))
    return tuple(found)


def _coupling(file: RobotFile, chain: Sequence[Joint]) -> Coupling:
    assert file.coupling is not None
    matrix, offset = file.coupling.matrix, file.coupling.offset or [0.0] * len(chain)
    if len(matrix) != len(chain) or any(len(row) != len(file.joints) for row in matrix):
        raise InvalidRobot(
            f"{file.name}: coupling.matrix: {len(chain)} rows (serial joints) of "
            f"{len(file.joints)} numbers (joints) are required",
            robot=file.name,
            value="coupling.matrix",
        )
    if len(offset) != len(chain):
        raise InvalidRobot(
            f"{file.name}: coupling.offset: {len(chain)} numbers, one a joint",
            robot=file.name,
            value="coupling.offset",
        )
    return Coupling(
        tuple(j.name for j in chain), tuple(tuple(row) for row in matrix), tuple(offset)
    )
