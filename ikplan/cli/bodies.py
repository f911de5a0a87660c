"""The bodies of a robot, as ``ikplan robots NAME`` shows them."""

from __future__ import annotations

from collections.abc import Iterator

from ikplan.cli.terminal.output import table
from ikplan.robots.info import CollisionInfo

__all__ = ["body_lines"]


def body_lines(collision: CollisionInfo) -> Iterator[str]:
    """Bodies with source and excess, pairs that may touch, and what is not checked."""
    rows = [
        (b.name, b.joint or "base", b.source, str(b.pieces), f"{1e3 * b.excess:.1f}")
        for b in collision.bodies
    ]
    yield from table(("body", "moved by", "source", "pieces", "excess mm"), rows, left=3)
    yield f"pairs of bodies kept apart: {collision.pairs_checked}"
    if collision.allowed:
        yield "may touch:"
        yield from (
            f"- {pair.pair[0]}, {pair.pair[1]}: {pair.reason}" for pair in collision.allowed
        )
    if collision.unchecked:
        yield "no shape known, not checked: " + ", ".join(collision.unchecked)
    if collision.fixed_joints:
        stand = (f"{name} {value:g}" for name, value in collision.fixed_joints.items())
        yield "joints beside the chain stand at: " + ", ".join(stand)
    yield from (f"- {note}" for note in collision.notes)
