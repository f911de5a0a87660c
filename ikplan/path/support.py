"""What of the path language the planner does not do yet."""

from __future__ import annotations

from typing import Any

from ikplan.errors import InvalidRequest
from ikplan.request import PathRequest

__all__ = ["refuse_unsupported"]


def refuse_unsupported(path: PathRequest) -> None:
    """Refuse a path that the planner cannot plan, rather than plan another one.

    Raises:
        InvalidRequest: Naming the field and what is allowed there.
    """
    checks: list[tuple[bool, str, Any]] = [
        (path.segments is None, "segments", "null"),
        (path.interpolation == "joint", "interpolation", ["joint"]),
        (path.approach == "path", "approach", ["path"]),
        (path.orientation_free is None, "orientation_free", "null"),
        (path.tolerance.box is None, "tolerance.box", "null"),
    ]
    for supported, name, allowed in checks:
        if not supported:
            raise InvalidRequest(
                f"path.{name}: not planned by this version; allowed: {allowed}",
                field=f"path.{name}",
                allowed=allowed,
            )
