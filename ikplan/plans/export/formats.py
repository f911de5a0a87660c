"""What a format is, and which arms it is for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ikplan.documents.controller import ControllerInfo

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot, RobotInfo

__all__ = ["Arm", "Format"]


@dataclass(frozen=True)
class Arm:
    """What decides whether an arm can have a plan in a format.

    Attributes:
        robot: Name of the robot.
        units: Units of its joint values, "rad" or "m", one a joint.
        controller: Its controller; None: none is known.
    """

    robot: str
    units: tuple[str, ...]
    controller: ControllerInfo | None

    @classmethod
    def of_plan(cls, plan: PlanDocument) -> Arm:
        """Return the arm that a plan is for."""
        return cls(plan.robot, tuple(plan.joint_units), plan.controller)

    @classmethod
    def of_robot(cls, robot: RobotInfo | Mapping[str, Any]) -> Arm:
        """Return the arm of a robot's description, or of the document that a service gives."""
        document = robot if isinstance(robot, Mapping) else robot.model_dump()
        units = ("m" if j["type"] == "prismatic" else "rad" for j in document["joints"])
        known = document.get("controller")
        controller = None if known is None else ControllerInfo.model_validate(known)
        return cls(document["name"], tuple(units), controller)


def _any(arm: Arm) -> None:
    """Refuse no arm."""


@dataclass(frozen=True)
class Format:
    """A way to write a plan.

    Attributes:
        name: Short name, such as ``csv``.
        title: One line for people.
        suffixes: File name endings that choose it, with the dot.
        media_type: Media type of the bytes.
        encode: From a plan to its bytes; the same plan gives the same bytes.
        check: Refuses, by InvalidRequest, an arm that can have no plan in this format.
        program: Of formats that thin a plan: from the plan, the name of the program, its robot
            (None: the catalogue's) and a tolerance [m] (None: the default) to the bytes.
        from_rest: Whether it holds only motions from rest to rest, as programs that a controller
            begins by itself do.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    media_type: str
    encode: Callable[[PlanDocument], bytes]
    check: Callable[[Arm], None] = _any
    program: Callable[[PlanDocument, str, Robot | None, float | None], bytes] | None = None
    from_rest: bool = False
