"""``GET /v1/plans``: what is listed, in which order, and page after page."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Any

import httpx
import pytest

from ikplan import AsyncClient, InvalidRequest, Unreachable
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.store.plan_store import Job, PlanStore
from ikplan_api.store.sqlite_plans import SqlitePlanStore

from .bad_requests import GOOD
from .conftest import ADDRESS
from .stand_in import StandIn
from .test_jobs import ASYNC, until
from .test_store import use

PROBLEM = b'{"type": "urn:ikplan:unreachable", "status": 422}'


def served(scenario: Callable[[StandIn, httpx.AsyncClient, PlanStore], Awaitable[Any]]) -> Any:
    async def run() -> Any:
        stand_in = StandIn()
        app = create_app(Settings(store_path=":memory:"), planner=stand_in)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=ADDRESS) as http,
        ):
            return await scenario(stand_in, http, app.state.store)

    return asyncio.run(run())


async def fill(store: PlanStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight plans of two robots and two jobs, one second apart from 1000 s."""
    now = 1000.0
    monkeypatch.setattr(time, "time", lambda: now)
    for i in range(8):
        await store.put(f"p{i}", b"x" * (i + 1), robot="ur5" if i % 2 else "iiwa14")
        now += 1.0
    for name in ("failed", "waits"):
        await store.accept(Job(name, "time", b"{}", None, 1.0, robot_name="ur5"))
        now += 1.0
    await store.fail("failed", PROBLEM)


def test_plans_and_jobs_are_listed_the_newest_first(monkeypatch: pytest.MonkeyPatch) -> None:
    async def ask(_: StandIn, http: httpx.AsyncClient, store: PlanStore) -> dict[str, Any]:
        await fill(store, monkeypatch)
        return dict((await http.get("/v1/plans")).json())

    listed = served(ask)
    assert [plan["id"] for plan in listed["plans"]] == [
        *("waits", "failed"),
        *(f"p{i}" for i in reversed(range(8))),
    ]
    assert listed["next"] is None
    assert listed["plans"][1] == {
        "id": "failed",
        "outcome": "failed",
        "kind": "time",
        "robot": "ur5",
        "time": "1970-01-01T00:16:48.000000Z",
        "bytes": None,
        "problem": "urn:ikplan:unreachable",
    }
    assert listed["plans"][0]["outcome"] == "unfinished"
    assert listed["plans"][2] == {
        "id": "p7",
        "outcome": "finished",
        "kind": "plan",
        "robot": "ur5",
        "time": "1970-01-01T00:16:47.000000Z",
        "bytes": 8,
        "problem": None,
    }


@pytest.mark.parametrize("limit", [1, 2, 3, 9, 10, 11])
def test_pages_are_the_whole_list(limit: int, monkeypatch: pytest.MonkeyPatch) -> None:
    async def ask(_: StandIn, http: httpx.AsyncClient, store: PlanStore) -> list[list[str]]:
        await fill(store, monkeypatch)
        pages, query = [], {"limit": str(limit)}
        while True:
            page = (await http.get("/v1/plans", params=query)).json()
            pages.append([plan["id"] for plan in page["plans"]])
            if page["next"] is None:
                return pages
            query["after"] = page["next"]

    pages = served(ask)
    assert all(len(page) == limit for page in pages[:-1])
    assert 0 < len(pages[-1]) <= limit
    ids = [plan_id for page in pages for plan_id in page]
    assert ids == ["waits", "failed", *(f"p{i}" for i in reversed(range(8)))]


@pytest.mark.parametrize(
    ("query", "ids"),
    [
        ({"robot": "iiwa14"}, ["p6", "p4", "p2", "p0"]),
        ({"outcome": "failed"}, ["failed"]),
        ({"outcome": "unfinished"}, ["waits"]),
        ({"robot": "ur5", "outcome": "finished"}, ["p7", "p5", "p3", "p1"]),
        ({"since": "1970-01-01T00:16:46Z", "until": "1970-01-01T00:16:48Z"}, ["p7", "p6"]),
        ({"since": "1970-01-01T01:16:46+01:00", "outcome": "finished"}, ["p7", "p6"]),
        ({"robot": "nao"}, []),
    ],
)
def test_a_list_is_narrowed(
    query: dict[str, str], ids: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def ask(_: StandIn, http: httpx.AsyncClient, store: PlanStore) -> Any:
        await fill(store, monkeypatch)
        return (await http.get("/v1/plans", params=query)).json()

    assert [plan["id"] for plan in served(ask)["plans"]] == ids


@pytest.mark.parametrize(
    ("query", "field"),
    [
        ({"after": "x"}, "after"),
        ({"after": "ü"}, "after"),
        ({"outcome": "lost"}, "query.outcome"),
        ({"since": "soon"}, "query.since"),
        ({"limit": "0"}, "query.limit"),
        ({"limit": "1001"}, "query.limit"),
    ],
)
def test_a_wrong_query_is_refused(query: dict[str, str], field: str) -> None:
    async def ask(_: StandIn, http: httpx.AsyncClient, __: PlanStore) -> httpx.Response:
        return await http.get("/v1/plans", params=query)

    answer = served(ask)
    assert answer.status_code == 422
    assert answer.json()["field"] == field


def test_what_the_service_makes_is_listed_with_its_robot() -> None:
    error = Unreachable(
        "too far", waypoint=0, position_error=1.0, orientation_error=None, q=[0.0], reason="far"
    )

    async def ask(planner: StandIn, http: httpx.AsyncClient, _: PlanStore) -> Any:
        planning = asyncio.create_task(http.post("/v1/plans", json=GOOD))
        await until(lambda: planner.asked)
        planner.answer()
        await planning
        await http.post("/v1/plans", json={**GOOD, "ik": {"seed": 1}}, headers=ASYNC)
        await until(lambda: len(planner.asked) == 2)
        planner.fail(error)
        await http.post("/v1/plans", json={**GOOD, "ik": {"seed": 2}}, headers=ASYNC)
        await until(lambda: len(planner.asked) == 3)
        client = AsyncClient(ADDRESS, transport=http._transport)
        found = [plan async for plan in client.plans(robot="iiwa14")]
        with pytest.raises(InvalidRequest):
            await anext(client.plans(outcome="lost"))  # type: ignore[arg-type]
        return found

    found = served(ask)
    assert [plan.outcome for plan in found] == ["unfinished", "failed", "finished"]
    assert {plan.robot for plan in found} == {"iiwa14"}
    assert found[1].problem == "urn:ikplan:unreachable"


def test_a_plan_that_is_too_old_is_not_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    from ikplan_api.store.plan_query import PlanQuery

    async def ask(store: SqlitePlanStore) -> list[str]:
        await fill(store, monkeypatch)
        return [row.plan_id for row in await store.list(PlanQuery("", 10, outcome="finished"))]

    assert use(ask, max_age_s=5.0) == ["p7", "p6", "p5"]
