"""A plan's progress as server-sent events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

from fastapi import Request
from fastapi.sse import ServerSentEvent

from ikplan.documents.status import PlanStatus
from ikplan.errors import PlanNotFound
from ikplan_api.board import PlanBoard
from ikplan_api.making import Making
from ikplan_api.problems import request_id_of
from ikplan_api.stopping import Stopping

__all__ = ["Watched", "find_watched"]


class Watched:
    """What there is to watch under an id.

    Args:
        plan_id: The id.
        stopping: Tells when the service is to stop.
        making: The plan, if it is being made.
        problem: Why it failed, if it has.
        request_id: Id of the request to watch.
    """

    def __init__(
        self,
        plan_id: str,
        request_id: str,
        stopping: Stopping,
        making: Making | None = None,
        problem: dict[str, Any] | None = None,
    ) -> None:
        self._plan_id = plan_id
        self._request_id = request_id
        self._stopping = stopping
        self._making = making
        self._problem = problem

    async def events(self) -> AsyncIterator[ServerSentEvent]:
        """Tell the progress until the end, or until the service stops and the job with it."""
        if self._making is not None:
            async for status in self._stopping.until_begun(self._making.watch()):
                if not status.ended:
                    yield ServerSentEvent(event="progress", data=status)
                else:
                    yield self._last(status, self._making.problem)
        else:
            state = "finished" if self._problem is None else "failed"
            yield self._last(PlanStatus(id=self._plan_id, state=state), self._problem)

    def _last(self, status: PlanStatus, problem: dict[str, Any] | None) -> ServerSentEvent:
        if problem is None:
            return ServerSentEvent(event=status.state, data=status)
        instance = f"urn:ikplan:request:{self._request_id}"
        return ServerSentEvent(event="failed", data={**problem, "instance": instance})


async def find_watched(request: Request, plan_id: str) -> Watched:
    """Find what there is to watch.

    Raises:
        PlanNotFound: Nothing is known under that id.
    """
    board: PlanBoard = request.app.state.board
    stopping: Stopping = request.app.state.stopping
    request_id = request_id_of(request)
    if (making := board.under_way(plan_id)) is not None:
        return Watched(plan_id, request_id, stopping, making)
    if await board.find(plan_id) is not None:
        return Watched(plan_id, request_id, stopping)
    if (problem := await board.failure(plan_id)) is not None:
        return Watched(plan_id, request_id, stopping, problem=problem)
    raise PlanNotFound(id=plan_id)
