"""Identify requests: in this process if they are short, else in a worker."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from typing import TYPE_CHECKING

from ikplan.pipeline.identity import UNKNOWN, KnownRequest
from ikplan_api.store.plan_store import Job
from ikplan_api.workers import tasks
from ikplan_api.workers.tasks import RequestIdentity, TaskInput

if TYPE_CHECKING:
    from ikplan_api.workers.planner import Planner

__all__ = ["RequestIdentifier", "identify"]

_MAX_SEEN = 4096
"""Number of recent requests that are recognised."""


class RequestIdentifier:
    """Makes jobs of requests.

    Args:
        planner: Parses long documents; its capacity bounds what is read.
        max_budget_s: Upper limit of every time budget [s].
    """

    def __init__(self, planner: Planner, max_budget_s: float) -> None:
        self._planner = planner
        self._max_budget_s = max_budget_s
        self._seen: OrderedDict[bytes, None] = OrderedDict()

    async def identify(
        self,
        kind: str,
        document: bytes,
        robot: bytes | None,
        known: KnownRequest = UNKNOWN,
        *,
        owner: str,
        wait_if_full: bool = False,
    ) -> Job:
        """Identify a request: its plan id and its time budget.

        Args:
            kind: ``"plan"`` or ``"time"``.
            document: The request document.
            robot: The uploaded robot that it names; None: a robot of the catalogue.
            known: What is known of it already.
            owner: Whose request it is.
            wait_if_full: If the queue is full, wait instead of raising.

        Raises:
            IkplanError: The request is invalid.
            ServiceUnavailable: The queue is full and the request was not seen before.
        """
        parts = (owner.encode(), kind.encode(), robot or b"", document)
        digest = hashlib.sha256(b"\0".join(parts)).digest()
        if digest not in self._seen and not wait_if_full:
            # A busy service reads a request only if its plan may be stored or in progress.
            self._planner.check_capacity()
        identity, known = await identify(
            self._planner, kind, document, robot, known, wait_if_full=wait_if_full
        )
        budget_s = min(identity.budget_s, self._max_budget_s)
        self._seen[digest] = None
        while len(self._seen) > _MAX_SEEN:
            self._seen.popitem(last=False)
        return Job(
            *(identity.plan_id, kind, document, robot, budget_s, known),
            owner=owner,
            robot_name=identity.robot,
        )


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
