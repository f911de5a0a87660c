"""How long requests wait, how they are refused, and what happens when a worker dies."""

from __future__ import annotations

import asyncio
import json
import shutil
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import httpx
import pytest

from ikplan import InvalidRequest, ServiceUnavailable, WorkerLost
from ikplan_api.app import create_app
from ikplan_api.jobs.plan_jobs import PlanJobs
from ikplan_api.settings import Settings
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.process_planner import ProcessPlanner

from .bad_requests import GOOD
from .conftest import ADDRESS
from .serving import WAIT_S
from .stand_in import StandIn
from .test_jobs import served, until


class Busy(StandIn):
    """Has work for 40 s before the next request."""

    @property
    def load(self) -> Load:
        return Load(1, 1, 3, 40.0)


async def post(app: Any, **headers: str) -> httpx.Response:
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as http:
        return await http.post("/v1/plans", json=GOOD, headers=headers)


def asked(planner: StandIn, deadline: str) -> httpx.Response:
    async def run() -> httpx.Response:
        app = create_app(Settings(store_path=":memory:"), planner=planner)
        async with asyncio.timeout(WAIT_S), app.router.lifespan_context(app):
            return await post(app, **{"ikplan-deadline": deadline})

    return asyncio.run(run())


def test_a_request_that_would_wait_beyond_its_deadline_is_refused_at_once() -> None:
    planner = Busy()
    answer = asked(planner, "30")
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "40")
    assert "is expected to be free in 40 s" in answer.json()["detail"]
    assert planner.asked == []


def test_a_request_ends_at_its_deadline_and_frees_its_worker() -> None:
    planner = StandIn()
    answer = asked(planner, "0.2")
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "1")
    assert len(planner.asked) == len(planner.cancelled) == 1


@pytest.mark.parametrize("deadline", ["soon", "0", "-1", "nan", "inf", "x" * 9000])
def test_a_deadline_that_is_no_time_is_refused(deadline: str) -> None:
    answer = asked(StandIn(), deadline)
    assert answer.status_code == InvalidRequest.status
    assert len(answer.content) < 1000


def test_no_task_waits_longer_than_the_bound_unless_it_is_to_wait() -> None:
    async def run() -> None:
        planner = ProcessPlanner(1, 5, max_wait_s=0.1)
        planner._ready = True  # with a worker that is never free
        planner._mean_s = 7.0
        waiting = [asyncio.create_task(planner.run("fk", b"")) for _ in range(3)]
        patient = asyncio.create_task(planner.run("fk", b"", wait_if_full=True))
        await asyncio.sleep(0)
        assert planner.load == Load(1, 0, 4, 35.0)
        for task in waiting:
            with pytest.raises(ServiceUnavailable, match="no worker was free") as told:
                await task
            assert told.value.retry_after_s in (35.0, 28.0, 21.0)
        assert not patient.done()
        patient.cancel()

    asyncio.run(run())


def test_a_job_whose_worker_dies_is_tried_once_more() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        accepted = await http.post("/v1/plans", json=GOOD, headers={"prefer": "respond-async"})
        place = accepted.headers["location"]
        await until(lambda: planner.asked)
        planner.fail(WorkerLost("the worker process ended by SIGKILL", exit_code=-9))
        await until(lambda: len(planner.asked) == 2)
        planner.answer()
        await until(lambda: not jobs._running)
        assert (await http.get(place)).status_code == 200

    served(use)


def test_a_job_that_ends_every_worker_ends_with_its_verdict() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: Any) -> None:
        accepted = await http.post("/v1/plans", json=GOOD, headers={"prefer": "respond-async"})
        for attempt in (1, 2):
            await until(lambda attempt=attempt: len(planner.asked) == attempt)
            planner.fail(WorkerLost("the worker process ended by SIGKILL", exit_code=-9))
            await until(lambda attempt=attempt: len(planner.asked) > attempt or not planner._open)
        answer = await http.get(accepted.headers["location"])
        while answer.status_code == 202:
            await asyncio.sleep(0.01)
            answer = await http.get(accepted.headers["location"])
        assert answer.status_code == WorkerLost.status
        assert "tried 2 times" in answer.json()["detail"]
        assert len(planner.asked) == 2

    served(use)


@pytest.mark.parametrize(("exit_code", "status"), [(-9, 503), (-15, 503), (-11, 500), (1, 500)])
def test_a_request_is_tried_twice_and_ends_with_503_unless_it_crashes_workers(
    exit_code: int, status: int
) -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: Any) -> None:
        asking = asyncio.create_task(http.post("/v1/plans", json=GOOD))
        for attempt in (1, 2):
            await until(lambda attempt=attempt: len(planner.asked) == attempt)
            planner.fail(WorkerLost("the worker process ended", exit_code=exit_code))
        answer = await asking
        assert answer.status_code == status
        assert answer.headers.get("retry-after") == ("1" if status == 503 else None)
        assert "tried 2 times" in answer.json()["detail"]
        asking = asyncio.create_task(http.post("/v1/plans", json=GOOD))
        await until(lambda: len(planner.asked) == 3)
        planner.fail(WorkerLost("the worker process ended", exit_code=exit_code))
        await until(lambda: len(planner.asked) == 4)
        planner.answer()
        assert (await asking).status_code == 200

    served(use)


def test_the_attempts_of_a_job_survive_the_service(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    places: list[str] = []

    def killed(scenario: Callable[[StandIn, httpx.AsyncClient], Awaitable[None]]) -> None:
        """Run a service that ends without its shutdown: its store is left as it is."""

        async def use(planner: StandIn, http: httpx.AsyncClient, _: Any) -> None:
            await scenario(planner, http)
            await asyncio.sleep(0.05)  # what is under way in the store
            shutil.copytree(tmp_path, tmp_path / "copy")

        served(use, path)
        for file in tmp_path.glob("store.sqlite3*"):
            file.unlink()
        for file in (tmp_path / "copy").iterdir():
            file.rename(tmp_path / file.name)
        (tmp_path / "copy").rmdir()

    async def begin(planner: StandIn, http: httpx.AsyncClient) -> None:
        answer = await http.post("/v1/plans", json=GOOD, headers={"prefer": "respond-async"})
        places.append(answer.headers["location"])
        await until(lambda: planner.asked)
        planner.fail(WorkerLost("the worker process ended by SIGKILL", exit_code=-9))
        await until(lambda: len(planner.asked) == 2)

    async def begin_again(planner: StandIn, _: httpx.AsyncClient) -> None:
        await until(lambda: planner.asked)

    async def look(planner: StandIn, http: httpx.AsyncClient) -> None:
        answer = await http.get(places[0])
        assert answer.status_code == WorkerLost.status
        assert "tried 3 times" in answer.json()["detail"]
        assert planner.asked == []

    killed(begin)
    killed(begin_again)
    killed(look)


def test_an_attempt_that_a_shutdown_ends_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"

    async def use(planner: StandIn, http: httpx.AsyncClient, _: Any) -> None:
        if not path.with_suffix(".begun").exists():
            path.with_suffix(".begun").touch()
            await http.post("/v1/plans", json=GOOD, headers={"prefer": "respond-async"})
        await until(lambda: planner.asked)

    for _ in range(5):
        served(use, path)


def test_who_waits_when_the_server_ends_its_tasks_gets_a_503() -> None:
    async def run() -> list[Any]:
        planner, sent = StandIn(), []
        app = create_app(Settings(store_path=":memory:", stop_s=0), planner=planner)
        body = json.dumps(GOOD).encode()
        left = [{"type": "http.request", "body": body, "more_body": False}]

        async def receive() -> Any:
            if not left:
                await asyncio.Event().wait()
            return left.pop()

        async def send(message: Any) -> None:
            sent.append(message)

        scope = {
            "type": "http", "method": "POST", "path": "/v1/plans", "raw_path": b"/v1/plans",
            "query_string": b"", "http_version": "1.1", "scheme": "http", "root_path": "",
            "headers": [(b"host", b"localhost"), (b"content-type", b"application/json")],
            "server": ("127.0.0.1", 80), "client": ("127.0.0.1", 1),
        }  # fmt: skip
        async with app.router.lifespan_context(app):
            task = asyncio.create_task(app(scope, receive, send))
            await until(lambda: planner.asked)
            task.cancel()  # as uvicorn does after its time to stop
            await asyncio.wait([task])
        return sent

    start, *body = asyncio.run(run())
    assert start["status"] == 503
    assert (b"retry-after", b"5") in start["headers"]
    told = json.loads(b"".join(message["body"] for message in body))
    assert told["detail"] == "the service is stopping"
