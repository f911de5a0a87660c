"""A plan's progress as server-sent events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any

from fastapi import Request
from fastapi.sse import ServerSentEvent

from ikplan.documents.status import PlanStatus
from ikplan.errors import PlanNotFound
from ikplan_api.http.owner import owner_of
from ikplan_api.http.problems import request_id_of
from ikplan_api.jobs.job_service import JobService, WatchedJob
from ikplan_api.jobs.shutdown import Shutdown

__all__ = ["Watched", "find_watched"]


class Watched:
    """A plan to watch: in progress, finished or failed.

    Args:
        plan_id: Id of the plan.
        request_id: Id of the HTTP request.
        shutdown: Closes the event stream when the service stops.
        in_progress: The plan, if it is in progress.
        problem: The problem document, if it failed.
    """

    def __init__(
        self,
        plan_id: str,
        request_id: str,
        shutdown: Shutdown,
        in_progress: WatchedJob | None = None,
        problem: dict[str, Any] | None = None,
    ) -> None:
        self._plan_id = plan_id
        self._request_id = request_id
        self._shutdown = shutdown
        self._in_progress = in_progress
        self._problem = problem

    async def events(self) -> AsyncIterator[ServerSentEvent]:
        """Yield progress events until the plan ends or the service stops."""
        if self._in_progress is not None:
            async for status in self._shutdown.until_shutdown(self._in_progress.watch()):
                if not status.ended:
                    yield ServerSentEvent(event="progress", data=status)
                else:
                    yield self._last(status, self._in_progress.problem)
        else:
            state = "finished" if self._problem is None else "failed"
            yield self._last(PlanStatus(id=self._plan_id, state=state), self._problem)

    def _last(self, status: PlanStatus, problem: dict[str, Any] | None) -> ServerSentEvent:
        if problem is None:
            return ServerSentEvent(event=status.state, data=status)
        instance = f"urn:ikplan:request:{self._request_id}"
        return ServerSentEvent(event="failed", data={**problem, "instance": instance})


async def find_watched(request: Request, plan_id: str) -> Watched:
    """Find a plan to watch.

    Raises:
        PlanNotFound: No plan and no job has this id.
    """
    jobs: JobService = request.app.state.plan_jobs
    shutdown: Shutdown = request.app.state.shutdown
    request_id, owner = request_id_of(request), owner_of(request)
    if (in_progress := await jobs.in_progress(plan_id, owner)) is not None:
        return Watched(plan_id, request_id, shutdown, in_progress)
    if await jobs.find(plan_id, owner) is not None:
        return Watched(plan_id, request_id, shutdown)
    if (problem := await jobs.failure(plan_id, owner)) is not None:
        return Watched(plan_id, request_id, shutdown, problem=problem)
    if await jobs.find(plan_id, owner) is not None:  # finished meanwhile
        return Watched(plan_id, request_id, shutdown)
    raise PlanNotFound(id=plan_id)
