"""Identify requests: in this process if they are short, else in a worker."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ikplan_api.workers import tasks
from ikplan_api.workers.tasks import RequestIdentity, TaskInput

if TYPE_CHECKING:
    from ikplan_api.workers.planner import Planner

__all__ = ["identify"]

_SHORT = 8 * 1024
"""Longest document that this process parses itself, within a few milliseconds [bytes]."""


async def identify(
    planner: Planner,
    kind: str,
    document: bytes,
    robot: bytes | None = None,
    *,
    wait_if_full: bool = False,
) -> RequestIdentity:
    """Return the plan id and the time budget of a request.

    Args:
        planner: Parses documents that would block the event loop for too long.
        kind: ``"plan"`` or ``"time"``.
        document: The request document.
        robot: The uploaded robot that the request names; None: a robot of the catalogue.
        wait_if_full: If the queue is full, wait instead of raising.

    Raises:
        IkplanError: The request is invalid.
        ServiceUnavailable: The queue is full.
    """
    if len(document) <= _SHORT and robot is None:
        return tasks.identify(kind, TaskInput(document))
    result = await planner.run(f"identify-{kind}", document, robot=robot, wait_if_full=wait_if_full)
    return RequestIdentity(*json.loads(result.document))
