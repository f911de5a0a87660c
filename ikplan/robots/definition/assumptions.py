"""What a description assumes where no source says it, in words."""

from __future__ import annotations

from collections.abc import Sequence

from ikplan.robots.definition.schema import JointEntry
from ikplan.robots.description import LimitSource
from ikplan.robots.urdf.tree import Joint

__all__ = ["default_assumptions", "is_assumed", "without_assumptions"]


def default_assumptions(
    sources: Sequence[LimitSource],
    entries: Sequence[JointEntry | None],
    joints: Sequence[Joint | None],
) -> tuple[str, ...]:
    """Return a sentence for each default that is used, naming the joints.

    Args:
        sources: Where each kind of limit comes from, with the names of the defaults.
        entries: What is said of each joint of the user; None: nothing.
        joints: The joint of the URDF of each; None: there is none.
    """
    said = []
    for source in sources:
        if source.default is None:
            continue
        names = [
            entry.name if entry is not None else joint.name if joint is not None else ""
            for entry, joint in zip(entries, joints, strict=True)
            if not _known(source.limit, entry, joint)
        ]
        if names:
            said.append(
                f"{source.limit} limits of {', '.join(names)}: {source.default}; no source gives "
                "them"
            )
    return tuple(said)


def without_assumptions(assumptions: Sequence[str], limit: str) -> tuple[str, ...]:
    """Return the assumptions that do not concern a kind of limit, such as ``"velocity"``."""
    return tuple(a for a in assumptions if not a.startswith(f"{limit} limits of "))


def is_assumed(assumptions: Sequence[str], limit: str, joint: str) -> bool:
    """Whether a limit of a joint is one of the assumptions."""
    start = f"{limit} limits of "
    return any(
        joint in assumption.removeprefix(start).rpartition(": ")[0].split(", ")
        for assumption in assumptions
        if assumption.startswith(start)
    )


def _known(limit: str, entry: JointEntry | None, joint: Joint | None) -> bool:
    given = getattr(entry, limit, None) if entry is not None else None
    if given is not None:
        return True
    own = getattr(joint.limit, limit, None) if joint is not None else None
    return bool(own) if limit == "velocity" else own is not None
