"""Changes of a request document: overrides of the command line, and repairs."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from ikplan.documents.json_text import unique_keys
from ikplan.errors import InvalidRequest

__all__ = ["merged", "set_values"]

_PATH = re.compile(r"[A-Za-z_]\w*(\[\d+\])*(\.[A-Za-z_]\w*(\[\d+\])*)*")
_PART = re.compile(r"([A-Za-z_]\w*)|\[(\d+)\]")


def merged(document: Mapping[str, Any], change: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document with the fields of a change put in, object by object."""
    result = dict(document)
    for key, value in change.items():
        old = result.get(key)
        both = isinstance(value, Mapping) and isinstance(old, Mapping)
        result[key] = merged(old, value) if both else value  # type: ignore[arg-type]
    return result


def set_values(document: Any, assignments: Sequence[str]) -> None:
    """Set fields of a document, in place.

    Args:
        document: The document.
        assignments: As ``path.waypoints[0].position=[0.5, 0, 0.4]``: a value is JSON, or else text.

    Raises:
        InvalidRequest: An assignment has no such form, or leads through what is no object.
    """
    for assignment in assignments:
        path, equals, text = assignment.partition("=")
        if not equals or not _PATH.fullmatch(path):
            raise InvalidRequest(
                f"--set {assignment}: path.to.field=value is allowed, such as "
                "limits.tool_speed=0.25",
                field="--set",
            )
        _set(document, path, _value(text))


def _value(text: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=unique_keys)
    except ValueError:
        return text


def _set(document: Any, path: str, value: Any) -> None:
    parts: list[str | int] = [name or int(index) for name, index in _PART.findall(path)]
    place = document
    for k, part in enumerate(parts):
        fits = isinstance(place, dict) if isinstance(part, str) else isinstance(place, list)
        if not fits or (isinstance(part, int) and part >= len(place)):
            what = "an object" if isinstance(part, str) else "a list that is long enough"
            raise InvalidRequest(f"--set {path}: {part!r} needs {what} before it", field=path)
        if k == len(parts) - 1:
            place[part] = value
        elif isinstance(part, str):
            if place.get(part) is None:
                place[part] = {}
            place = place[part]
        else:
            place = place[part]
