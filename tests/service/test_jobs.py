"""Plans as jobs: accepted, watched, cancelled, wanted twice, found again after a restart."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import httpx
import pytest

import ikplan
from ikplan import BudgetExceeded, Unreachable
from ikplan.pipeline.identity import plan_id
from ikplan_api.app import create_app
from ikplan_api.jobs.plan_jobs import PlanJobs
from ikplan_api.settings import Settings
from ikplan_api.store.plan_store import StoreFault
from tests.present import present

from .bad_requests import GOOD
from .conftest import ADDRESS
from .serving import WAIT_S
from .stand_in import StandIn

ASYNC = {"prefer": "respond-async"}
GOOD_ID = plan_id(ikplan.PlanRequest(**GOOD), ikplan.load_robot("iiwa14"))


def served(
    scenario: Callable[[StandIn, httpx.AsyncClient, PlanJobs], Awaitable[Any]],
    path: object = ":memory:",
    **planner: Any,
) -> Any:
    """Run a scenario with a service whose planner is a stand-in."""

    async def run() -> Any:
        stand_in = StandIn(**planner)
        app = create_app(Settings(store_path=str(path)), planner=stand_in)
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with (
            asyncio.timeout(WAIT_S),
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url=ADDRESS) as http,
        ):
            return await scenario(stand_in, http, app.state.plan_jobs)

    return asyncio.run(run())


async def until(true: Callable[..., object]) -> None:
    while not true():
        await asyncio.sleep(0.005)


def ask(http: httpx.AsyncClient, **change: Any) -> "asyncio.Task[httpx.Response]":
    return asyncio.create_task(http.post("/v1/plans", json={**GOOD, **change}))


def test_the_id_is_the_plans_own_and_known_before_it_is_made(http: httpx.Client) -> None:
    answer = http.post("/v1/plans", json=GOOD)
    assert answer.json()["id"] == GOOD_ID
    assert answer.headers["etag"] == f'"{GOOD_ID}"'
    assert answer.headers["content-location"] == f"/v1/plans/{GOOD_ID}"


@pytest.mark.parametrize("prefer", ["respond-async", "wait=5, Respond-Async;x=1"])
def test_a_job_is_accepted_polled_and_found(prefer: str) -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        accepted = await http.post("/v1/plans", json=GOOD, headers={"prefer": prefer})
        assert accepted.status_code == 202
        place = accepted.headers["location"]
        assert place == f"/v1/plans/{GOOD_ID}"
        assert accepted.headers["preference-applied"] == "respond-async"
        assert accepted.json() == {
            "id": GOOD_ID, "state": "queued", "stage": None, "done": 0, "total": 0,
        }  # fmt: skip
        await until(lambda: planner.progress)
        present(planner.progress[0])("ik", 2, 5)
        polled = await http.get(place)
        assert polled.status_code == 202
        assert "preference-applied" not in polled.headers
        assert polled.json() == {
            "id": GOOD_ID, "state": "running", "stage": "ik", "done": 2, "total": 5,
        }  # fmt: skip
        planner.answer()
        await until(lambda: not jobs._running)
        found = await http.get(place)
        assert (found.status_code, found.json()) == (200, {"plan": 1})
        unchanged = await http.get(place, headers={"if-none-match": f'"x", W/"{GOOD_ID}"'})
        assert (unchanged.status_code, unchanged.content) == (304, b"")
        for headers in ({}, ASYNC):
            again = await http.post("/v1/plans", json=GOOD, headers=headers)
            assert (again.status_code, again.json()) == (200, {"plan": 1})
        assert len(planner.asked) == 1

    served(use)


def test_a_wrong_request_is_refused_before_it_is_accepted() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        answer = await http.post("/v1/plans", json={**GOOD, "robot": "x"}, headers=ASYNC)
        assert answer.json()["type"] == "urn:ikplan:robot-not-found"
        assert not planner.asked

    served(use)


def test_a_job_that_fails_tells_why_and_is_tried_again_when_asked_again() -> None:
    error = Unreachable(
        "too far", waypoint=0, position_error=1.0, orientation_error=None, q=[0.0], reason="far"
    )

    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        await until(lambda: planner.asked)
        planner.fail(error)
        await until(lambda: not jobs._running)
        for _ in range(2):
            answer = await http.get(place)
            problem = answer.json()
            assert answer.status_code == 422
            assert answer.headers["content-type"] == "application/problem+json"
            assert answer.headers["x-request-id"] in problem.pop("instance")
            assert problem == error.to_problem()
        assert (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).status_code == 202
        await until(lambda: len(planner.asked) == 2)

    served(use)


def test_an_unforeseen_fault_of_a_job_is_told_without_its_details(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> httpx.Response:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        await until(lambda: planner.asked)
        planner.fail(ZeroDivisionError("secret"))
        await until(lambda: not jobs._running)
        return await http.get(place)

    answer = served(use)
    assert answer.status_code == 500
    assert "secret" not in answer.text
    assert "secret" in caplog.text


def test_a_request_in_flight_twice_is_planned_once() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        first, second = ask(http), ask(http)
        accepted = await http.post("/v1/plans", json=GOOD, headers=ASYNC)
        assert accepted.status_code == 202
        await until(lambda: planner.asked)
        planner.answer()
        assert (await first).content == (await second).content
        assert len(planner.asked) == 1

    served(use)


def test_a_plan_is_answered_before_it_is_kept_and_forgotten_after_that(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        put, written = jobs._store.put, asyncio.Event()

        async def slowly(plan_id: str, document: bytes, **about: Any) -> None:
            await written.wait()
            await put(plan_id, document, **about)

        monkeypatch.setattr(jobs._store, "put", slowly)
        asking = ask(http)
        await until(lambda: planner.asked)
        planner.answer()
        answer = await asking
        place = f"/v1/plans/{GOOD_ID}"
        assert (await http.get(place)).content == answer.content
        forgetting = asyncio.create_task(http.delete(place))
        await asyncio.sleep(0.02)
        assert not forgetting.done()
        written.set()
        assert (await forgetting).status_code == 204
        assert (await http.get(place)).status_code == 404

    served(use)


def test_a_larger_budget_is_not_bound_by_a_smaller_one_in_flight() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        small, large = ask(http, budget_s=1.0), ask(http, budget_s=2.0)
        await until(lambda: planner.asked)
        await asyncio.sleep(0.02)
        planner.fail(BudgetExceeded("late", stage="ik", budget_s=1.0))
        assert (await small).json()["budget_s"] == 1.0
        await until(lambda: len(planner.asked) == 2)
        planner.answer()
        assert (await large).status_code == 200

    served(use)


def test_a_caller_who_leaves_frees_the_worker_unless_another_waits() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        first, second = ask(http), ask(http)
        await until(lambda: planner.asked)
        first.cancel()
        await asyncio.sleep(0.02)
        assert not planner.cancelled
        second.cancel()
        await until(lambda: planner.cancelled)
        third = ask(http)
        await until(lambda: len(planner.asked) == 2)
        planner.answer()
        assert (await third).status_code == 200

    served(use)


def test_a_caller_who_leaves_does_not_end_a_job() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        waiting = ask(http)
        await until(lambda: planner.asked)
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        waiting.cancel()
        await asyncio.sleep(0.02)
        assert not planner.cancelled
        planner.answer()
        await until(lambda: not jobs._running)
        assert (await http.get(place)).status_code == 200

    served(use)


def test_a_job_is_cancelled_and_forgotten_and_a_plan_too() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        await until(lambda: planner.asked)
        assert (await http.delete(place)).status_code == 204
        await until(lambda: planner.cancelled)
        assert (await http.get(place)).status_code == 404
        again = ask(http)
        await until(lambda: len(planner.asked) == 2)
        planner.answer()
        assert (await again).status_code == 200
        assert (await http.delete(place)).status_code == 204
        gone = await http.delete(place)
        assert gone.status_code == 404
        assert gone.json()["type"] == "urn:ikplan:plan-not-found"

    served(use)


def test_who_waits_for_a_cancelled_job_gets_the_plan_all_the_same() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        waiting = ask(http)
        await asyncio.sleep(0.02)
        assert (await http.delete(place)).status_code == 204
        planner.answer()
        assert (await waiting).status_code == 200

    served(use)


def test_no_job_is_accepted_without_room() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        other = [{"position": [0.5, 0.0, 0.4]}]
        waiting = ask(http, path={"waypoints": other})
        await until(lambda: planner.asked)
        answer = await http.post("/v1/plans", json=GOOD, headers=ASYNC)
        assert answer.status_code == 503
        assert answer.headers["retry-after"] == "1"
        planner.answer()
        await waiting

    served(use, room=1)


def test_a_busy_service_still_answers_what_it_has_and_reads_nothing_new() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        first = ask(http)
        await until(lambda: planner.asked)
        planner.answer()
        assert (await first).status_code == 200
        other = ask(http, ik={"seed": 1})
        await until(lambda: len(planner.asked) == 2)
        joined = ask(http, ik={"seed": 1})
        assert (await ask(http)).status_code == 200
        assert (await ask(http, ik={"seed": 2})).status_code == 503
        assert (await ask(http, robot="x")).status_code == 503
        planner.answer()
        assert (await other).status_code == (await joined).status_code == 200
        assert (await ask(http, robot="x")).status_code == 404
        assert not jobs._running

    served(use, room=1)


async def events(http: httpx.AsyncClient, place: str) -> list[tuple[str, dict[str, Any]]]:
    """Every event of a stream, as its name and data, once it has ended."""
    answer = await http.get(f"{place}/events")
    assert answer.headers["content-type"].startswith("text/event-stream")
    told = []
    for event in answer.text.strip().split("\n\n"):
        fields = dict(line.split(": ", 1) for line in event.splitlines() if line[0] != ":")
        told.append((fields["event"], json.loads(fields["data"])))
    return told


def test_a_job_is_watched_to_its_end() -> None:
    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        watching = asyncio.create_task(events(http, place))
        await until(lambda: planner.asked)
        for done in range(3):
            await asyncio.sleep(0.02)
            present(planner.progress[0])("ik", done, 3)
        await asyncio.sleep(0.02)
        planner.answer()
        told = await watching
        assert [name for name, _ in told] == [*["progress"] * 4, "finished"]
        assert [data["state"] for _, data in told] == ["queued", *["running"] * 3, "finished"]
        assert [(data["stage"], data["done"], data["total"]) for _, data in told[1:4]] == [
            ("ik", 0, 3), ("ik", 1, 3), ("ik", 2, 3),
        ]  # fmt: skip
        assert (await events(http, place))[0][0] == "finished"

    served(use)


def test_the_watch_of_a_job_ends_with_what_became_of_it() -> None:
    error = BudgetExceeded("late", stage="ik", budget_s=1.0)

    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        watching = asyncio.create_task(events(http, place))
        await until(lambda: planner.asked)
        planner.fail(error)
        for told in (await watching, await events(http, place)):
            name, problem = told[-1]
            assert name == "failed"
            assert problem.pop("instance").startswith("urn:ikplan:request:")
            assert problem == error.to_problem()
        place = (await http.post("/v1/plans", json=GOOD, headers=ASYNC)).headers["location"]
        watching = asyncio.create_task(events(http, place))
        await asyncio.sleep(0.02)
        await http.delete(place)
        assert (await watching)[-1][0] == "cancelled"
        assert (await http.get(f"{place}/events")).status_code == 404

    served(use)


def test_jobs_outlive_a_restart_and_are_done_in_their_order(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    requests = [
        {**GOOD, "path": {"waypoints": [{"position": [0.5, 0.0, 0.4 + 0.01 * i]}]}}
        for i in range(5)
    ]
    places = []

    async def accept(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        for request in requests:
            answer = await http.post("/v1/plans", json=request, headers=ASYNC)
            places.append(answer.headers["location"])
        planner.answer(b'{"plan": 0}')
        await until(lambda: len(planner.asked) == 5 and planner.load.running == 4)

    async def go_on(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        await until(lambda: len(planner.asked) == 4)
        assert [json.loads(document) for document in planner.asked] == requests[1:]
        for _ in range(4):
            planner.answer()
            await asyncio.sleep(0)
        await until(lambda: not jobs._running)
        for place in places:
            assert (await http.get(place)).status_code == 200
        assert (await http.get(places[0])).json() == {"plan": 0}

    async def rest(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        await asyncio.sleep(0.02)
        assert not planner.asked
        assert (await http.get(places[4])).status_code == 200

    served(accept, path)
    served(go_on, path)
    served(rest, path)


def test_with_a_full_disk_plans_are_answered_and_jobs_are_not_accepted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def full(*_: object) -> None:
        raise StoreFault("database or disk is full")

    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        monkeypatch.setattr(jobs._store, "put", full)
        monkeypatch.setattr(jobs._store, "accept", full)
        refused = await http.post("/v1/plans", json=GOOD, headers=ASYNC)
        assert refused.status_code == 503
        assert "cannot be stored" in refused.json()["detail"]
        assert refused.headers["retry-after"] == "60"
        waiting = ask(http)
        await until(lambda: planner.asked)
        planner.answer()
        answer = await waiting
        assert answer.status_code == 200
        assert (await http.get(answer.headers["content-location"])).json() == {"plan": 1}
        assert (await http.delete(answer.headers["content-location"])).status_code == 204

    served(use)


def test_a_timing_is_a_job_like_a_plan() -> None:
    request = {"robot": "ur5", "waypoints": [[0.0] * 6, [0.1] * 6]}

    async def use(planner: StandIn, http: httpx.AsyncClient, jobs: PlanJobs) -> None:
        accepted = await http.post("/v1/timings", json=request, headers=ASYNC)
        assert accepted.status_code == 202
        await until(lambda: planner.asked)
        planner.answer()
        await until(lambda: not jobs._running)
        assert (await http.get(accepted.headers["location"])).status_code == 200

    served(use)


def test_a_plan_may_not_take_longer_than_the_operator_allows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits = []

    async def use(planner: StandIn, http: httpx.AsyncClient, _: PlanJobs) -> None:
        run = planner.run

        async def noting(*args: Any, **how: Any) -> Any:
            limits.append(how["limit_s"])
            return await run(*args, **how)

        monkeypatch.setattr(planner, "run", noting)
        waiting = ask(http, budget_s=100.0)
        await until(lambda: planner.asked)
        planner.answer()
        await waiting

    monkeypatch.setenv("IKPLAN_MAX_BUDGET_S", "5")
    served(use)
    assert limits == [5.0]
