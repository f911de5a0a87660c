"""What the caller gave is wrong, or names what does not exist."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ikplan.errors.base import IkplanError

__all__ = [
    "InvalidInput",
    "InvalidRequest",
    "InvalidRobot",
    "PlanNotFound",
    "RobotNotFound",
    "near_names",
]


def near_names(name: str, valid: Iterable[str]) -> list[str]:
    """Return up to three of ``valid`` that look like ``name``, best first."""
    by_folded = {v.lower(): v for v in sorted(valid)}
    matches = difflib.get_close_matches(name.lower(), by_folded, n=3, cutoff=0.5)
    return [by_folded[m] for m in matches]


class InvalidInput(IkplanError):
    """What the caller gave is wrong, or names what does not exist: a group, to be caught."""


class InvalidRequest(InvalidInput):
    """A field is wrong, unknown, not finite or of the wrong length.

    Attributes:
        field: Path of the first wrong field, such as ``path.waypoints[3].position``.
        allowed: What is allowed there: a list of choices, a range in words, or None.
        errors: Every wrong field as ``{"field": ..., "detail": ...}``, the first one included.
    """

    slug = "invalid-request"
    title = "Invalid request"
    status = 422
    fields = ("field", "allowed", "errors")

    def __init__(
        self,
        detail: str,
        *,
        field: str = "",
        allowed: Any = None,
        errors: Sequence[Mapping[str, str]] | None = None,
    ) -> None:
        super().__init__(detail)
        self.field = field
        self.allowed = allowed
        self.errors = list(errors) if errors else [{"field": field, "detail": detail}]


class RobotNotFound(InvalidInput):
    """No robot of that name.

    Attributes:
        name: The name asked for.
        near: Valid names that look like it.
        valid: Every valid name.
    """

    slug = "robot-not-found"
    title = "Robot not found"
    status = 404
    fields = ("name", "near", "valid")

    def __init__(
        self,
        detail: str = "",
        *,
        name: str,
        valid: Sequence[str] = (),
        near: Sequence[str] | None = None,
    ) -> None:
        self.name = name
        self.valid = list(valid)
        self.near = near_names(name, valid) if near is None else list(near)
        if not detail:
            hint = f"; did you mean {' or '.join(self.near)}?" if self.near else "."
            detail = f"no robot named {name!r}{hint} Valid names: {', '.join(self.valid)}"
        super().__init__(detail)


class PlanNotFound(InvalidInput):
    """No plan of that id.

    Attributes:
        id: The id asked for.
    """

    slug = "plan-not-found"
    title = "Plan not found"
    status = 404
    fields = ("id",)

    def __init__(self, detail: str = "", *, id: str) -> None:
        super().__init__(detail or f"no plan with id {id!r} is kept here")
        self.id = id


class InvalidRobot(InvalidInput):
    """A robot description that makes no sense.

    Attributes:
        robot: Name or file of the description.
        joint: The joint at fault, or None.
        value: The value at fault, or None.
        valid: The choices there are instead (link names, fields), empty where there are none.
    """

    slug = "invalid-robot"
    title = "Invalid robot description"
    status = 422
    fields = ("robot", "joint", "value", "valid")

    def __init__(
        self,
        detail: str,
        *,
        robot: str = "",
        joint: str | None = None,
        value: Any = None,
        valid: Sequence[str] = (),
    ) -> None:
        # A description may put a megabyte where a number belongs; who reads this needs its start.
        super().__init__(_shortened(detail))
        self.robot = robot
        self.joint = joint
        self.value = _shortened(value) if isinstance(value, str) else value
        self.valid = list(valid)


def _shortened(text: str, length: int = 4000) -> str:
    return text if len(text) <= length else f"{text[:length]}..."
