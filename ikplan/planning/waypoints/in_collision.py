"""The verdict on a waypoint or a motion for which every way found is in contact."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from ikplan.arrays import Array
from ikplan.collision.check import Contact, ContactCheck
from ikplan.errors import InCollision

__all__ = ["count_pairs", "in_collision", "motion_in_collision", "pose_in_collision"]

_MOST_PAIRS = 5
"""Pairs that a reason names."""


def count_pairs(pairs: Sequence[tuple[str, str] | None]) -> str:
    """Say which pairs hold how many configurations in contact, most first."""
    counted = Counter(pair for pair in pairs if pair is not None)
    ordered = sorted(counted.items(), key=lambda item: (-item[1], item[0]))
    named = [f"{a} and {b} ({count})" for (a, b), count in ordered[:_MOST_PAIRS]]
    return ", ".join(named) + (", ..." if len(ordered) > _MOST_PAIRS else "")


def in_collision(
    contact: ContactCheck,
    q: Array,
    waypoint: int,
    subject: str,
    segment: int | None,
    *,
    proven: bool = False,
) -> InCollision:
    """Return the verdict on a waypoint all of whose configurations are in contact.

    Args:
        contact: The check.
        q: The configurations, nearest to the one before first, shape (m, dof), m >= 1 [rad or m].
        waypoint: Row of the waypoint; -1: the start.
        subject: The waypoint in words.
        segment: Number of the segment that ends there.
        proven: Whether there are no other configurations.
    """
    pairs = contact.pairs_in_contact(q, segment)
    first = next((k for k, pair in enumerate(pairs) if pair is not None), 0)
    pair = pairs[first] or ("", "")
    depth = contact.shortfall(q[first], pair, segment)
    many = "" if len(q) == 1 else f"all {len(q)} configurations found for it are in contact: "
    what = f"{pair[0]} and {pair[1]} touch" if len(q) == 1 else count_pairs(pairs)
    return InCollision(
        f"{subject}: {many}{what}",
        waypoint=waypoint,
        pair=pair,
        depth=depth,
        q=q[first].tolist(),
        proven=proven,
        reason=count_pairs(pairs),
    )


def pose_in_collision(
    contact: ContactCheck,
    q: Array,
    waypoint: int,
    pair: tuple[str, str],
    segment: int | None,
) -> InCollision:
    """Return the verdict on a pose at which what moves with the tool is in contact.

    Args:
        contact: The check.
        q: A configuration that meets it, shape (dof,) [rad or m].
        waypoint: Row of the waypoint.
        pair: Names of the bodies.
        segment: Number of the segment that ends there.
    """
    depth = contact.shortfall(q, pair, segment)
    a, b = pair
    return InCollision(
        f"waypoint {waypoint}: {a} and {b} touch wherever the tool has this pose: no configuration "
        "of the arm meets it free of contact",
        waypoint=waypoint,
        pair=pair,
        depth=depth,
        q=q.tolist(),
        proven=True,
        reason=f"{a} and {b}",
    )


def motion_in_collision(
    contact: ContactCheck, found: Contact, waypoint: int, subject: str, segment: int | None
) -> InCollision:
    """Return the verdict on a motion for which no way clear of contact was found.

    Args:
        contact: The check.
        found: The contact met.
        waypoint: Row of the waypoint that the motion goes to.
        subject: The motion in words.
        segment: Number of its segment.
    """
    depth = contact.shortfall(found.q, found.pair, segment)
    a, b = found.pair
    return InCollision(
        f"{subject}: no way clear of contact was found; the one that gets farthest meets "
        f"{a} and {b}",
        waypoint=waypoint,
        pair=found.pair,
        depth=depth,
        q=found.q.tolist(),
        reason=f"{a} and {b}",
    )
