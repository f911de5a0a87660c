"""Formats of other packages: entry points of the group ``ikplan.exporters``."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import entry_points

from ikplan.errors import InvalidRequest
from ikplan.plans.export.formats import Format

__all__ = ["GROUP", "others"]

GROUP = "ikplan.exporters"


def others(taken: Sequence[Format]) -> tuple[Format, ...]:
    """Return the formats that installed packages offer, by the names of their entry points.

    Args:
        taken: Formats whose names and suffixes are taken.

    Raises:
        InvalidRequest: An entry point names something else, or a name or suffix that is taken.
    """
    known = list(taken)
    for point in sorted(entry_points(group=GROUP), key=lambda each: (each.name, each.value)):
        found = point.load()
        if not isinstance(found, Format):
            raise _refusal(point.value, f"it is a {type(found).__name__}, not a Format")
        for other in known:
            shared = {found.name, *found.suffixes} & {other.name, *other.suffixes}
            if shared:
                raise _refusal(point.value, f"{sorted(shared)[0]!r} is of {other.title!r}")
        known.append(found)
    return tuple(known[len(taken) :])


def _refusal(value: str, why: str) -> InvalidRequest:
    return InvalidRequest(
        f"the entry point {value!r} of the group {GROUP!r} is no format: {why}",
        field="format",
        allowed="a Format with a name and suffixes of its own",
    )
