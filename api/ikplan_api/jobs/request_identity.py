"""Identify requests: in this process if they are short, else in a worker."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.workers import tasks
from ikplan_api.workers.tasks import RequestIdentity, TaskInput

if TYPE_CHECKING:
    from ikplan_api.workers.planner import Planner

__all__ = ["identify"]


async def identify(
    planner: Planner,
    kind: str,
    document: bytes,
    robot: bytes | None = None,
    known: KnownRequest = UNKNOWN,
    *,
    wait_if_full: bool = False,
) -> tuple[RequestIdentity, KnownRequest]:
    """Return the plan id and the time budget of a request, and what is known of it from now on.

    A short document is parsed here, once, and its request goes on to the worker.

    Args:
        planner: Parses documents that would block the event loop for too long.
        kind: ``"plan"`` or ``"time"``.
        document: The request document.
        robot: The uploaded robot that the request names; None: a robot of the catalogue.
        known: What is known of it already.
        wait_if_full: If the queue is full, wait instead of raising.

    Raises:
        IkplanError: The request is invalid.
        ServiceUnavailable: The queue is full.
    """
    if known.request is None and len(document) <= tasks.SHORT:
        known = KnownRequest(tasks.parse_request(kind, document))
    if known.request is not None and robot is None:
        identity = tasks.identify(kind, TaskInput(document, known=known))
    else:
        result = await planner.run(
            f"identify-{kind}", document, robot=robot, known=known, wait_if_full=wait_if_full
        )
        identity = RequestIdentity(*json.loads(result.document))
    return identity, known._replace(plan_id=identity.plan_id)
