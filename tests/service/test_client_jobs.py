"""What the clients do with jobs, batches, and services that are busy or away for a moment."""

import inspect
import json
import time
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from anyio.from_thread import BlockingPortal
from fastapi import FastAPI

import ikplan
from ikplan import (
    AsyncClient,
    AsyncPlanJob,
    Client,
    IkplanError,
    Plan,
    PlanJob,
    PlanNotFound,
    PlanStatus,
    RateLimited,
    ServiceUnavailable,
    Unreachable,
)

from .bad_requests import GOOD
from .conftest import ADDRESS

FAR = {**GOOD, "path": {"waypoints": [{"position": [9.0, 0.0, 0.5]}]}}
STATUS = PlanStatus(id="x", state="running", stage="ik", done=1, total=3)


def fresh(seed: int) -> dict[str, Any]:
    """A request that no other test makes."""
    return {**GOOD, "ik": {"seed": seed}}


def same(a: Plan, b: Plan) -> bool:
    return a.model_dump_json(exclude={"stats"}) == b.model_dump_json(exclude={"stats"})


def test_a_job_is_the_plan_that_a_local_call_makes(client: Client) -> None:
    heard: list[PlanStatus] = []
    job = client.submit(fresh(901))
    plan = job.wait(progress=heard.append)
    assert same(plan, ikplan.plan(fresh(901)))
    assert plan.id == job.id
    assert heard[-1].state == "finished"
    assert job.status().state == "finished"
    assert same(client.job(job.id).wait(), plan)
    assert same(client.submit(fresh(901)).wait(), plan)
    job.cancel()
    with pytest.raises(PlanNotFound):
        job.status()


def test_a_timing_is_a_job_too(client: Client) -> None:
    request = {"robot": "ur5", "waypoints": [[0.0] * 6, [0.3] * 6]}
    assert same(client.submit_time(request).wait(), ikplan.time_request(request))


def test_a_job_that_fails_raises_what_a_local_call_raises(client: Client) -> None:
    with pytest.raises(Unreachable) as here:
        ikplan.plan(FAR)
    job = client.submit(FAR)
    for ask in (job.wait, job.wait, job.status):
        with pytest.raises(Unreachable) as there:
            ask()
        assert there.value.to_problem() == here.value.to_problem()


def test_a_wrong_request_is_refused_when_it_is_submitted(client: Client) -> None:
    with pytest.raises(ikplan.RobotNotFound):
        client.submit({**GOOD, "robot": "iiwa41"})


def test_the_asynchronous_twin_does_the_same(app: FastAPI, portal: BlockingPortal) -> None:
    async def use() -> None:
        async with AsyncClient(ADDRESS, transport=httpx.ASGITransport(app)) as client:
            heard: list[PlanStatus] = []
            job = await client.submit(fresh(902))
            assert same(await job.wait(progress=heard.append), ikplan.plan(fresh(902)))
            assert (await job.status()).state == heard[-1].state == "finished"
            with pytest.raises(Unreachable):
                await (await client.submit(FAR)).wait()
            results = [r async for r in client.batch([GOOD, FAR])]
            assert [type(r) for r in results] == [Plan, Unreachable]
            await client.job(job.id).cancel()

    portal.call(use)


def test_a_batch_yields_plans_and_errors_in_their_order(client: Client) -> None:
    requests = [GOOD, FAR, {**GOOD, "robot": "x"}, fresh(903)]
    results = list(client.batch(requests))
    assert [type(r) for r in results] == [Plan, Unreachable, ikplan.RobotNotFound, Plan]
    assert isinstance(results[3], Plan)
    assert same(results[3], ikplan.plan(fresh(903)))
    with pytest.raises(ikplan.InvalidRequest, match="at least one line"):
        list(client.batch([]))


def test_the_jobs_are_twins() -> None:
    def public(cls: type) -> dict[str, list[str]]:
        methods = inspect.getmembers(cls, inspect.isfunction)
        return {n: list(inspect.signature(m).parameters) for n, m in methods if n[0] != "_"}

    assert public(PlanJob) == public(AsyncPlanJob)


def busy(status: int, **headers: str) -> httpx.Response:
    error: IkplanError = RateLimited(limit="1 per second", retry_after_s=1.0)
    if status == 503:
        error = ServiceUnavailable("busy", status_code=503, retry_after_s=1.0)
    return httpx.Response(
        status,
        content=json.dumps(error.to_problem()),
        headers={"content-type": "application/problem+json", **headers},
    )


VERSION = httpx.Response(200, json={"version": "1"})
Outcome = httpx.Response | Exception


def version_after(*outcomes: Outcome, **options: Any) -> tuple[Callable[[], object], list[float]]:
    """A call to a service with these outcomes, one a request, and when each was asked for."""
    asked: list[float] = []
    left = iter(outcomes)

    def answer(_: httpx.Request) -> httpx.Response:
        asked.append(time.monotonic())
        outcome = next(left)
        if isinstance(outcome, Exception):
            raise outcome
        return outcome

    transport = httpx.MockTransport(answer)

    def call() -> object:
        with Client(ADDRESS, transport=transport, **options) as client:
            return client.version()

    return call, asked


@pytest.mark.parametrize(
    "outcome",
    [
        busy(503, **{"retry-after": "0"}),
        busy(429, **{"retry-after": "0"}),
        busy(503),
        busy(503, **{"retry-after": "soon"}),
        httpx.ConnectError("refused"),
        httpx.ReadError("reset"),
        httpx.RemoteProtocolError("disconnected"),
        httpx.ConnectTimeout("late"),
    ],
)
def test_what_may_pass_is_asked_again(outcome: Outcome) -> None:
    call, asked = version_after(outcome, outcome, VERSION)
    assert call() == {"version": "1"}
    assert len(asked) == 3


def test_the_service_says_when_to_ask_again() -> None:
    call, asked = version_after(busy(503, **{"retry-after": "1"}), VERSION)
    call()
    assert asked[1] - asked[0] >= 1.0


@pytest.mark.parametrize(
    ("outcome", "error"),
    [
        (busy(503, **{"retry-after": "3600"}), ServiceUnavailable),
        (httpx.Response(500), ServiceUnavailable),
        (httpx.Response(502), ServiceUnavailable),
        (httpx.ReadTimeout("slow"), ServiceUnavailable),
        (httpx.UnsupportedProtocol("what"), ServiceUnavailable),
    ],
)
def test_what_will_not_pass_is_not_asked_again(outcome: Outcome, error: type[IkplanError]) -> None:
    call, asked = version_after(outcome, VERSION)
    with pytest.raises(error):
        call()
    assert len(asked) == 1


def test_patience_has_an_end_and_the_last_answer_is_told() -> None:
    outcomes = [busy(429, **{"retry-after": "0"})] * 3
    call, asked = version_after(*outcomes, VERSION, retries=2)
    with pytest.raises(RateLimited):
        call()
    assert len(asked) == 3


def scripted(*answers: httpx.Response) -> tuple[Client, list[str]]:
    """A client of a service that gives these answers, and the paths it was asked for."""
    paths: list[str] = []
    left = iter(answers)

    def answer(request: httpx.Request) -> httpx.Response:
        paths.append(f"{request.method} {request.url.path}")
        return next(left)

    return Client(ADDRESS, transport=httpx.MockTransport(answer), retries=0), paths


def test_without_events_the_service_is_asked_until_the_plan_is_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("ikplan.client.jobs._POLL_S", 0.01)
    pending = httpx.Response(202, content=STATUS.model_dump_json())
    plan = ikplan.plan(GOOD)
    client, paths = scripted(
        httpx.Response(502), pending, httpx.Response(200, text="no events"), pending,
        httpx.Response(503), httpx.Response(200, content=plan.model_dump_json()),
    )  # fmt: skip
    assert same(client.job("x").wait(), plan)
    assert paths == ["GET /v1/plans/x/events", "GET /v1/plans/x"] * 3


def test_a_wait_has_an_end() -> None:
    pending = httpx.Response(202, content=STATUS.model_dump_json())
    client, _ = scripted(httpx.Response(502), pending)
    with pytest.raises(ServiceUnavailable, match="not finished after 0 s") as caught:
        client.job("x").wait(timeout=0.0)
    assert caught.value.status_code == 202
    client, _ = scripted(pending)
    with pytest.raises(ServiceUnavailable, match="not finished: it is running"):
        client.get_plan("x")


def test_a_job_that_was_cancelled_while_one_waits_is_not_found() -> None:
    event = (
        "event: cancelled\ndata: "
        + STATUS.model_copy(update={"state": "cancelled"}).model_dump_json()
    )
    stream = httpx.Response(
        200, content=event + "\n\n", headers={"content-type": "text/event-stream"}
    )
    client, _ = scripted(stream)
    with pytest.raises(PlanNotFound, match="cancelled"):
        client.job("x").wait()


@pytest.mark.parametrize("line", ["[]", "{}", '{"plan": 1}', "x", '{"problem": 1}'])
def test_lines_that_are_none_of_ours_are_told(line: str) -> None:
    client, _ = scripted(httpx.Response(200, text=line))
    with pytest.raises(ServiceUnavailable, match="unexpected answer"):
        list(client.batch([GOOD]))
