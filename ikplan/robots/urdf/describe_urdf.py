"""From a bare URDF, and what may be given with it, to a checked description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ikplan.documents.controller import Controller
from ikplan.errors import InvalidRobot
from ikplan.robots.definition.defaults import DEFAULT_ACCELERATION
from ikplan.robots.definition.describe import check_jerks, moving_chain
from ikplan.robots.definition.joint_spec import joint_spec
from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import LimitSource, RobotDescription, Tool
from ikplan.robots.urdf.inertias import inertia_faults
from ikplan.robots.urdf.tree import Joint, KinematicTree

__all__ = ["describe_urdf"]


def describe_urdf(
    tree: KinematicTree,
    *,
    base: str | None,
    tip: str | None,
    name: str,
    title: str,
    source: str,
    entries: Sequence[JointEntry] = (),
    home: Mapping[str, float] | None = None,
    tool: Tool | None = None,
    notes: Sequence[str] = (),
    controller: Controller | None = None,
) -> RobotDescription:
    """Describe the chain of a bare URDF; accelerations are the default, home is near zero.

    Args:
        tree: The URDF.
        base: Base link; None: the root.
        tip: Tip link; None: the only leaf.
        name: Name of the robot.
        title: Full name of the robot.
        source: Where the URDF comes from, in words.
        entries: Limits that replace the URDF's, by joint [rad or m, per second, N m or N].
        home: Home positions by joint [rad or m].
        tool: Tool frame in the tip frame; None: the tip frame.
        notes: What else a user should know.
        controller: The controller; None: not known.

    Raises:
        InvalidRobot: The chain or one of its limits makes no sense.
    """
    base = tree.root if base is None else tree.require_link(base, "base")
    tip = tree.default_tip(base) if tip is None else tip
    chain = moving_chain(tree, base, tip)
    names = [j.name for j in chain]
    given = {entry.name: entry for entry in entries}
    for key in (*given, *(home or ())):
        if key not in names:
            raise InvalidRobot(
                f"{name}: no joint {key!r} moves between {base!r} and {tip!r}; "
                f"there are {', '.join(names)}",
                robot=name,
                joint=key,
                valid=names,
            )
    merged = [given.get(n, JointEntry(name=n)) for n in names]
    if controller is not None:
        check_jerks(controller, names, name)
    sources = _urdf_sources(merged, chain, source)
    faults = inertia_faults(tree, chain)
    torques = [f"torques cannot be limited: {faults[0]}"] if faults else []
    return RobotDescription(
        name=name,
        title=title,
        urdf=tree.to_urdf({j.name for j in chain}),
        base=base,
        tip=tip,
        joints=tuple(
            joint_spec(entry, joint, (home or {}).get(joint.name), sources, name, 1.0)
            for entry, joint in zip(merged, chain, strict=True)
        ),
        tool=tool or Tool(),
        limit_sources=sources,
        sources=(f"kinematics and inertias: {source}",),
        notes=(
            *(() if home else ("home: zero, or the middle of the range where zero is outside it",)),
            *notes,
            *torques,
        ),
        inertias_sourced=not faults,
        controller=controller,
    )


def _urdf_sources(
    entries: Sequence[JointEntry], chain: Sequence[Joint], source: str
) -> tuple[LimitSource, ...]:
    """Where the limits come from: the URDF, what was given with it, or the default."""

    def of(key: str, *fields: str) -> LimitSource:
        given = any(getattr(entry, field) is not None for entry in entries for field in fields)
        return LimitSource(key, f"{source}, and what was given with it" if given else source, None)

    known = all(
        e.acceleration is not None or j.limit.acceleration is not None
        for e, j in zip(entries, chain, strict=True)
    )
    default = LimitSource("acceleration", None, DEFAULT_ACCELERATION)
    return (
        of("position", "lower", "upper"),
        of("velocity", "velocity"),
        of("acceleration", "acceleration") if known else default,
        of("effort", "effort"),
    )
