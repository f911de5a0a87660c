"""The id and the budget of a request, before any worker has time for it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ikplan_api import tasks
from ikplan_api.tasks import Identity, Work

if TYPE_CHECKING:
    from ikplan_api.planner import Planner

__all__ = ["identify"]

_SHORT = 8 * 1024
"""Length of a document that is read in a few milliseconds [bytes]."""


async def identify(
    planner: Planner,
    kind: str,
    document: bytes,
    robot: bytes | None = None,
    *,
    patient: bool = False,
) -> Identity:
    """Tell the id of a request's plan before it is made, and the time it may take.

    Args:
        planner: Reads what would keep the event loop too long.
        kind: ``"plan"`` or ``"time"``.
        document: The request document.
        robot: Upload of the robot that the request names; None: one of the catalogue.
        patient: Wait for room, instead of being refused.

    Raises:
        IkplanError: What is wrong with the request.
        ServiceUnavailable: No worker has room to read it.
    """
    if len(document) <= _SHORT and robot is None:
        return tasks.identify(kind, Work(document))
    answer = await planner.run(f"identify-{kind}", document, robot=robot, patient=patient)
    return Identity(*json.loads(answer.document))
