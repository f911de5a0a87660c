"""Whose plans, jobs, robots and scenes they are."""

from __future__ import annotations

__all__ = ["EVERYONE", "scoped", "unscoped"]

EVERYONE = ""
"""The owner where keys share what is stored, and where there are no keys."""


def scoped(owner: str, name: str) -> str:
    """Return the name under which a file stores something of an owner.

    What belongs to everyone keeps its own name. An owner has no colon, so no name of one owner
    is that of another.

    Args:
        owner: The owner: the name of a key, or :data:`EVERYONE`.
        name: Id of a plan, or name of a robot or scene.
    """
    return f"{owner}:{name}" if owner or ":" in name else name


def unscoped(name: str) -> str:
    """Return the name that an owner knows; see :func:`scoped`."""
    return name.partition(":")[2] if ":" in name else name
