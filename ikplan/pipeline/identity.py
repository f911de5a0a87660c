"""Under which id a request's plan is found: known before there is a plan."""

from __future__ import annotations

from typing import NamedTuple

from ikplan._version import __version__
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import UNCHECKED
from ikplan.documents.timing_request import TimingRequest
from ikplan.robots import Robot

__all__ = ["UNKNOWN", "KnownRequest", "plan_id"]


class KnownRequest(NamedTuple):
    """What is known of a request before it is planned: none of it is found out twice.

    Attributes:
        request: The request; None: its document is not parsed here.
        plan_id: The id of its plan, under this version; None: not known yet.
    """

    request: PlanRequest | TimingRequest | None = None
    plan_id: str | None = None


UNKNOWN = KnownRequest()
"""Nothing is known of the request."""


def plan_id(request: PlanRequest | TimingRequest, robot: Robot) -> str:
    """Return the id of a request's plan: a hash of the request, the robot and the version.

    Args:
        request: The request.
        robot: The robot, with the request's tool.

    Returns:
        32 hexadecimal digits.
    """
    context = [robot.fingerprint, __version__]
    if asks_for_checks(request):
        context.append(robot.description.shapes.fingerprint())
    return request.content_hash(*context)


def asks_for_checks(request: PlanRequest | TimingRequest) -> bool:
    """Whether a request has something checked for contact: plans do unless they switch it off."""
    if request.scene is None:
        return isinstance(request, PlanRequest)
    return request.scene != UNCHECKED
