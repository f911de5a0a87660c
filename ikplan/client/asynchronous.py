"""The asynchronous client."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterable, Mapping
from datetime import datetime
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from httpx_sse import EventSource, SSEError

from ikplan.client import calls
from ikplan.client.jobs import AsyncPlanJob
from ikplan.client.retrying import Patience
from ikplan.client.streams import BATCH, batch_body, read_event, read_line
from ikplan.client.wire import EVENTS, PROBLEM, Call, client_headers, read, unreachable
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.pose_results import FkResult, IkBatchSolution, IkSolution
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan.documents.scene import Scene
from ikplan.documents.status import AuditEntry, Outcome, PlanStatus, PlanSummary
from ikplan.documents.timing_request import TimingRequest
from ikplan.documents.trajectory import PlanSeries
from ikplan.errors import IkplanError
from ikplan.plans.plan import Plan

__all__ = ["AsyncClient"]

T = TypeVar("T")

_SILENCE_S = 60.0
"""Longest time without any event, [s]; a service that lives sends at least a sign of it."""


class AsyncClient:
    """Talks to an ikplan service; its twin is :class:`~ikplan.Client`.

    Every method raises the errors of the library: the same class, with the same data, as the
    same call made locally; ServiceUnavailable when the service cannot be reached or does not
    answer like one.

    Args:
        base_url: Address of the service, such as ``http://127.0.0.1:8000``.
        key: The key that the service wants; None: the environment variable ``IKPLAN_KEY``.
        transport: How requests travel; None: over the network.
        timeout: Longest wait for an answer [s]; a plan may take as long as its ``budget_s``, and
            on a busy machine four times as long.
        retries: How often to ask again when the service is busy (429, 503: as late as its
            ``Retry-After`` says) or the connection fails.

    Raises:
        ServiceUnavailable: ``base_url`` is no address.
        InvalidRequest: ``key`` cannot be one.
    """

    def __init__(
        self,
        base_url: str = "http://127.0.0.1:8000",
        *,
        key: str | None = None,
        transport: httpx.AsyncBaseTransport | None = None,
        timeout: float | httpx.Timeout = 60.0,
        retries: int = 3,
    ) -> None:
        self.base_url = base_url.rstrip("/")
        self._retries = retries
        try:
            self._http = httpx.AsyncClient(
                base_url=self.base_url,
                headers=client_headers(self.base_url, key),
                transport=transport,
                timeout=timeout,
            )
        except httpx.InvalidURL as error:
            raise unreachable(error, base_url) from error

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.aclose()

    async def aclose(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def _send(self, call: Call[T]) -> T:
        try:
            response = await self._exchange(call)
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            raise unreachable(error, self.base_url + call.path) from error
        return read(call, response)

    async def _exchange(self, call: Call[Any]) -> httpx.Response:
        """One answer, asked for again while that makes sense."""
        patience = Patience(self._retries)
        while True:
            try:
                response = await self._http.request(
                    call.method, call.path, content=call.content, headers=call.headers
                )
            except httpx.HTTPError as error:
                if (wait_s := patience.wait_s(error)) is None:
                    raise
            else:
                if (wait_s := patience.wait_s(response)) is None:
                    return response
            await asyncio.sleep(wait_s)

    async def _watch(self, plan_id: str, left_s: float) -> AsyncIterator[PlanStatus | IkplanError]:
        """The events of a plan, for at most a time [s] without any."""
        call = calls.peek(plan_id)
        url = f"{self.base_url}{call.path}/events"
        timeout = httpx.Timeout(min(_SILENCE_S, left_s + 0.01))
        try:
            async with self._http.stream(
                "GET", f"{call.path}/events", headers=EVENTS, timeout=timeout
            ) as response:
                if not response.is_success:
                    await response.aread()
                    read(call, response)
                async for event in EventSource(response).aiter_sse():
                    yield read_event(event, url)
        except (httpx.HTTPError, SSEError) as error:
            raise unreachable(error, url) from error

    async def plan(self, request: Mapping[str, Any] | PlanRequest) -> Plan:
        """Make a plan.

        Args:
            request: The request, as for :func:`ikplan.plan`; arrays are welcome.

        Raises:
            IkplanError: As :func:`ikplan.plan` raises.
            ServiceUnavailable: The service cannot be reached, or is busy.
        """
        return await self._send(calls.plan(request))

    async def time(self, request: Mapping[str, Any] | TimingRequest) -> Plan:
        """Time a joint path, without planning.

        Args:
            request: Robot, waypoints, limits and sampling; arrays are welcome.

        Raises:
            IkplanError: As :func:`ikplan.time_request` raises.
            ServiceUnavailable: The service cannot be reached, or is busy.
        """
        return await self._send(calls.time(request))

    async def submit(self, request: Mapping[str, Any] | PlanRequest) -> AsyncPlanJob:
        """Ask for a plan without waiting for it; the service makes it even if it is restarted.

        Args:
            request: The request, as for :meth:`plan`.

        Raises:
            IkplanError: What is wrong with the request.
            ServiceUnavailable: The service cannot be reached, or accepts no jobs now.
        """
        return self._job(await self._send(calls.submit(request)))

    async def submit_time(self, request: Mapping[str, Any] | TimingRequest) -> AsyncPlanJob:
        """Ask for the timing of a joint path without waiting for it, see :meth:`submit`.

        Args:
            request: The request, as for :meth:`time`.

        Raises:
            IkplanError: What is wrong with the request.
            ServiceUnavailable: The service cannot be reached, or accepts no jobs now.
        """
        return self._job(await self._send(calls.submit_time(request)))

    def _job(self, answer: Plan | PlanStatus) -> AsyncPlanJob:
        return AsyncPlanJob(self, answer.id, answer if isinstance(answer, Plan) else None)

    def job(self, plan_id: str) -> AsyncPlanJob:
        """Return the job of a plan that was asked for before, by its id."""
        return AsyncPlanJob(self, plan_id)

    async def batch(
        self, requests: Iterable[Mapping[str, Any] | PlanRequest | bytes]
    ) -> AsyncIterator[Plan | IkplanError]:
        """Make many plans.

        Args:
            requests: The requests, each as for :meth:`plan`; bytes: JSON, sent as it is.

        Yields:
            For each, in their order and as soon as it is known, the plan, or the error that
            :meth:`plan` would have raised.

        Raises:
            InvalidRequest: There is none, or too many.
            ServiceUnavailable: The service cannot be reached, or stopped in between.
        """
        call: Call[Any] = Call("POST", "/v1/batches", Plan.load, batch_body(requests))
        headers = {**call.headers, "content-type": BATCH, "accept": f"{BATCH}, {PROBLEM}"}
        url = self.base_url + call.path
        try:
            async with self._http.stream(
                call.method, call.path, content=call.content, headers=headers
            ) as response:
                if not response.is_success:
                    await response.aread()
                    read(call, response)
                async for line in response.aiter_lines():
                    yield read_line(line, url)
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            raise unreachable(error, url) from error

    async def get_plan(self, plan_id: str) -> Plan:
        """Fetch a finished plan by its id.

        Raises:
            PlanNotFound: The service keeps no plan of that id.
            ServiceUnavailable: It is not finished yet.
        """
        return await self._send(calls.get_plan(plan_id))

    async def plans(
        self,
        *,
        robot: str | None = None,
        outcome: Outcome | None = None,
        since: datetime | str | None = None,
        until: datetime | str | None = None,
    ) -> AsyncIterator[PlanSummary]:
        """List plans and jobs of the service, the newest first.

        Args:
            robot: Name of their robot.
            outcome: ``"finished"``, ``"failed"`` or ``"unfinished"``.
            since: Earliest time; text as in RFC 3339.
            until: Time before which they were stored or accepted.

        Yields:
            Each, page after page, as far as it is asked for.

        Raises:
            InvalidRequest: A value is not allowed.
            ServiceUnavailable: The service cannot be reached.
        """
        after: str | None = None
        while True:
            page = await self._send(calls.plans(robot, outcome, since, until, after))
            for plan in page.plans:
                yield plan
            if (after := page.next) is None:
                return

    async def audit(self, *, owner: str | None = None) -> AsyncIterator[AuditEntry]:
        """Tell who planned what, the newest first; a key needs the role ``auditor``.

        Args:
            owner: Only what this key did.

        Yields:
            Each action, page after page, as far as it is asked for.

        Raises:
            AccessDenied: The key may not ask.
            ServiceUnavailable: The service cannot be reached.
        """
        before: int | None = None
        while True:
            page = await self._send(calls.audit(owner, before))
            for entry in page.entries:
                yield entry
            if (before := page.next) is None:
                return

    async def ik(self, request: Mapping[str, Any] | IkRequest) -> IkSolution:
        """Find joint values that bring the tool to a pose.

        Raises:
            Unreachable: There are none.
        """
        return await self._send(calls.ik(request))

    async def ik_batch(self, request: Mapping[str, Any] | IkBatchRequest) -> IkBatchSolution:
        """Find joint values for many poses, see :func:`ikplan.solve_ik_batch`."""
        return await self._send(calls.ik_batch(request))

    async def fk(self, request: Mapping[str, Any] | FkRequest) -> FkResult:
        """Place the tool of given joint values."""
        return await self._send(calls.fk(request))

    async def robots(self) -> list[dict[str, Any]]:
        """List the robots of the service: for each, what :meth:`robot` tells."""
        return await self._send(calls.robots())

    async def robot(self, name: str) -> dict[str, Any]:
        """Describe a robot: joints, limits, home, frames and sources.

        Raises:
            RobotNotFound: The service has no robot of that name.
        """
        return await self._send(calls.robot(name))

    async def formats(self, name: str) -> list[dict[str, Any]]:
        """List the formats of a robot's plans, programs of its controller among them.

        Raises:
            RobotNotFound: The service has no robot of that name.
        """
        return await self._send(calls.formats(name))

    async def series(self, request: Mapping[str, Any] | PlanRequest) -> PlanSeries:
        """Measure a plan over time: torques, deviation from the path, distances.

        Raises:
            PlanNotFound: The service has no plan of that request: :meth:`plan` makes it.
        """
        return await self._send(calls.series(request))

    async def upload_robot(self, urdf: str | bytes, **options: Any) -> dict[str, Any]:
        """Upload a robot of one's own.

        Args:
            urdf: The content of the URDF.
            **options: What goes with it: ``srdf``, ``group``, ``base``, ``tip``, ``title``,
                ``tool``, ``joints``, ``home``.

        Returns:
            What :meth:`robot` tells; its ``name`` is what requests call the robot.

        Raises:
            InvalidRobot: The description makes no sense: which joint or link, and why.
        """
        return await self._send(calls.upload_robot(urdf, options))

    async def delete_robot(self, name: str) -> None:
        """Forget an uploaded robot.

        Raises:
            RobotNotFound: The service keeps no robot of that name.
        """
        await self._send(calls.delete_robot(name))

    async def upload_scene(
        self, scene: Mapping[str, Any] | Scene, *, name: str | None = None
    ) -> dict[str, Any]:
        """Upload a scene, to name it by its id in requests.

        Args:
            scene: The scene, as in a request or from :func:`ikplan.read_scene`; meshes in files
                are read here, relative to the working folder.
            name: What it is called, for people.

        Returns:
            The scene with its ``id``, which stands for it in the field ``scene`` of requests.

        Raises:
            InvalidRequest: A field is wrong, or a mesh cannot be read.
        """
        return await self._send(calls.upload_scene(scene, name))

    async def scene(self, scene_id: str) -> dict[str, Any]:
        """Return an uploaded scene, with its ``id`` and ``name``.

        Raises:
            InvalidRequest: The service keeps no scene of that id.
        """
        return await self._send(calls.scene(scene_id))

    async def delete_scene(self, scene_id: str) -> None:
        """Forget an uploaded scene, but none of its plans.

        Raises:
            InvalidRequest: The service keeps no scene of that id.
        """
        await self._send(calls.delete_scene(scene_id))

    async def solvers(self) -> list[dict[str, Any]]:
        """List the solvers, with their parameters and defaults."""
        return await self._send(calls.solvers())

    async def version(self) -> dict[str, Any]:
        """Tell the version of the service."""
        return await self._send(calls.version())
