"""From a bare URDF, and what may be given with it, to a checked description."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ikplan.documents.controller import Controller
from ikplan.errors import InvalidRobot
from ikplan.robots.definition.assumptions import default_assumptions
from ikplan.robots.definition.couplings import given_coupling, mimic_coupling, user_joints
from ikplan.robots.definition.defaults import (
    DEFAULT_ACCELERATION,
    FIRST_ACCELERATION,
    VELOCITY_DEFAULTS,
)
from ikplan.robots.definition.describe import MOVING_BASE, check_jerks, moving_chain
from ikplan.robots.definition.joint_spec import joint_spec
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import Coupling, LimitSource, RobotDescription, Tool
from ikplan.robots.urdf.inertias import inertia_faults
from ikplan.robots.urdf.rerooting import passes_upwards, rooted_for
from ikplan.robots.urdf.tree import Joint, KinematicTree

__all__ = ["Given", "describe_urdf"]


@dataclass(frozen=True)
class Given:
    """What is said with a URDF.

    Attributes:
        entries: Limits that replace the URDF's, by joint [rad or m, per second, N m or N]; what
            is said of joints off the chain has no effect if ``loose``.
        loose: Whether entries may be of joints that are not on the chain.
        source: Where the entries come from, in words.
        home: Home positions by joint [rad or m].
        tool: Tool frame in the tip frame; None: the tip frame.
        controller: The controller; None: not known.
        coupling: Joints of the URDF as sums of factors times the controller's; see
            :func:`~ikplan.robots.definition.couplings.given_coupling`.
        velocity_default: Name of the default for turning joints without a velocity limit; None:
            they are refused.
        first_rules: Whether the defaults are those of the first uploads.
    """

    entries: Sequence[JointEntry] = ()
    loose: bool = False
    source: str = "what was given with it"
    home: Mapping[str, float] | None = None
    tool: Tool | None = None
    controller: Controller | None = None
    coupling: Mapping[str, Mapping[str, float]] | None = None
    velocity_default: str | None = None
    first_rules: bool = False


def describe_urdf(
    tree: KinematicTree,
    *,
    base: str,
    tip: str,
    name: str,
    title: str,
    source: str,
    given: Given | None = None,
    notes: Sequence[str] = (),
) -> RobotDescription:
    """Describe the chain of a bare URDF; its home, where none is given, is near zero.

    Args:
        tree: The URDF.
        base: Base link.
        tip: Tip link.
        name: Name of the robot.
        title: Full name of the robot.
        source: Where the URDF comes from, in words.
        given: What is said with it.
        notes: What else a user should know.

    Raises:
        InvalidRobot: The chain or one of its limits makes no sense.
    """
    given = given or Given()
    _check_velocity_default(given.velocity_default, name)
    tree.require_link(base, "base")
    said = {entry.name: entry for entry in given.entries}
    upwards = passes_upwards(tree, base, tip)
    tree = rooted_for(_endless(tree, said), base, tip)
    serial = moving_chain(tree, base, tip)
    chain = user_joints(serial)
    names = [j.name for j in chain]
    for key in (*(() if given.loose else said), *(given.home or ())):
        if key not in names:
            raise InvalidRobot(
                f"{name}: no joint {key!r} moves between {base!r} and {tip!r}; "
                f"there are {', '.join(names)}",
                robot=name,
                joint=key,
                valid=names,
            )
    merged = [said.get(n, JointEntry(name=n)) for n in names]
    if given.controller is not None:
        check_jerks(given.controller, names, name)
    coupling = (
        mimic_coupling(name, serial)
        if given.coupling is None
        else given_coupling(name, serial, given.coupling)
    )
    sources = _urdf_sources(merged, chain, source, given)
    # Gravity has no fixed direction in a base that moves.
    moving = [MOVING_BASE.format(base=base)] if upwards else []
    faults = [
        *moving,
        *inertia_faults(tree, serial),
        *(f.detail for j in tree.joints for f in j.faults),
    ]
    home = given.home or {}
    return RobotDescription(
        name=name,
        title=title,
        urdf=tree.to_urdf({j.name for j in serial}),
        base=base,
        tip=tip,
        joints=tuple(
            joint_spec(entry, joint, home.get(joint.name), sources, name, 1.0)
            for entry, joint in zip(merged, chain, strict=True)
        ),
        coupling=coupling,
        tool=given.tool or Tool(),
        limit_sources=sources,
        sources=(f"kinematics and inertias: {source}",),
        notes=(*notes, *_notes(tree, serial, coupling, faults)),
        inertias_sourced=not faults,
        controller=given.controller,
        assumptions=default_assumptions(sources, merged, chain),
    )


def _check_velocity_default(default: str | None, robot: str) -> None:
    if default is not None and default not in VELOCITY_DEFAULTS:
        raise InvalidRobot(
            f"{robot}: no velocity default {default!r}; there is {', '.join(VELOCITY_DEFAULTS)}",
            robot=robot,
            value=default,
            valid=list(VELOCITY_DEFAULTS),
        )


def _endless(tree: KinematicTree, said: Mapping[str, JointEntry]) -> KinematicTree:
    """Let joints turn without end whose limits are beyond any range, unless others are given."""
    kinds = {}
    for joint in tree.joints:
        entry = said.get(joint.name)
        limited = entry is not None and (entry.lower is not None or entry.upper is not None)
        endless = joint.limit.lower == -math.inf and joint.limit.upper == math.inf
        if joint.kind == "revolute" and endless and not limited:
            kinds[joint.name] = "continuous"
    return tree.with_kinds(kinds)


def _notes(
    tree: KinematicTree,
    serial: Sequence[Joint],
    coupling: Coupling | None,
    faults: Sequence[str],
) -> list[str]:
    notes = []
    if coupling is not None:
        notes.append(
            "joints are coupled: "
            + "; ".join(
                f"{joint} = "
                + " + ".join(
                    f"{factor:g} {user.name}"
                    for factor, user in zip(row, user_joints(serial), strict=True)
                    if factor
                )
                + (f" + {offset:g}" if offset else "")
                for joint, row, offset in zip(
                    coupling.serial, coupling.matrix, coupling.offset, strict=True
                )
                if sum(map(bool, row)) != 1 or 1.0 not in row or offset
            )
            + "; limits are those of the joints that are given"
        )
    else:
        notes.append(
            "joint values count as in the URDF; a controller that counts otherwise (FANUC's J3 "
            "goes with J2) needs a coupling"
        )
    off = [f for j in tree.joints for f in j.faults]
    if off:
        notes.append(
            f"{len(off)} faults of joints off the chain were passed over; the first: "
            f"{off[0].detail}"
        )
    if faults:
        notes.append(f"torques cannot be limited: {faults[0]}")
    return notes


def _urdf_sources(
    entries: Sequence[JointEntry], chain: Sequence[Joint], source: str, given: Given
) -> tuple[LimitSource, ...]:
    """Where the limits come from: the URDF, what was given with it, or a default."""

    def of(key: str, *fields: str) -> LimitSource:
        replaced = any(getattr(entry, field) is not None for entry in entries for field in fields)
        return LimitSource(key, f"{source}, and {given.source}" if replaced else source, None)

    def known(key: str) -> bool:
        return all(
            getattr(e, key) is not None or getattr(j.limit, key) is not None
            for e, j in zip(entries, chain, strict=True)
        )

    name = FIRST_ACCELERATION if given.first_rules else DEFAULT_ACCELERATION
    acceleration = LimitSource("acceleration", None, name)
    velocity = of("velocity", "velocity")
    turning = [(e, j) for e, j in zip(entries, chain, strict=True) if j.kind != "prismatic"]
    if given.velocity_default is not None and any(
        e.velocity is None and not j.limit.velocity for e, j in turning
    ):
        velocity = LimitSource("velocity", None, given.velocity_default)
    return (
        of("position", "lower", "upper"),
        velocity,
        of("acceleration", "acceleration") if known("acceleration") else acceleration,
        of("effort", "effort"),
    )
