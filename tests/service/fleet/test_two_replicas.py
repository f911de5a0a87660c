"""Two replicas on one database: a job of one is shown, watched and cancelled at the other."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from typing import Any

import httpx
import psycopg

from benchmarks.fleet.postgres import Postgres

from ..bad_requests import GOOD
from ..urdfs import ARM
from .replicas import Replica, served, until

ASYNC = {"prefer": "respond-async"}


def request(number: int) -> dict[str, Any]:
    return {**GOOD, "ik": {"seed": number}}


async def state_of(replica: Replica, place: str) -> str:
    answer = await replica.http.get(place)
    if answer.status_code == 200:
        return "finished"
    return str(answer.json()["state"]) if answer.status_code == 202 else str(answer.status_code)


async def events(replica: Replica, place: str) -> list[tuple[str, Any]]:
    found, name = [], ""
    async with replica.http.stream("GET", f"{place}/events") as stream:
        assert stream.status_code == 200
        async for line in stream.aiter_lines():
            if line.startswith("event:"):
                name = line.removeprefix("event:").strip()
            if line.startswith("data:"):
                found.append((name, json.loads(line.removeprefix("data:"))))
    return found


def test_a_job_is_shown_watched_and_found_at_the_other_replica(database: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        for replica in (here, there):
            replica.planner.go.clear()
        accepted = await here.http.post("/v1/plans", json=request(1), headers=ASYNC)
        assert accepted.status_code == 202
        place = accepted.headers["location"]
        watching = asyncio.create_task(events(there, place))

        async def running() -> bool:
            return await state_of(there, place) == "running"

        await until(running)
        for replica in (here, there):
            replica.planner.go.set()
        found = await asyncio.wait_for(watching, 120)
        assert found[-1][0] == "finished"
        assert {name for name, _ in found[:-1]} <= {"progress"}
        plans = [await replica.http.get(place) for replica in (here, there)]
        assert [plan.status_code for plan in plans] == [200, 200]
        assert plans[0].content == plans[1].content
        again = await there.http.post("/v1/plans", json=request(1))
        assert again.content == plans[0].content
        assert len(here.planner.made) + len(there.planner.made) == 1

    served(database, use)


def test_a_job_is_cancelled_from_the_other_replica(database: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        here.planner.go.clear()
        there.jobs.park_queued()  # so that the first one has it
        place = (await here.http.post("/v1/plans", json=request(1), headers=ASYNC)).headers[
            "location"
        ]

        async def running() -> bool:
            return bool(here.jobs._running)

        await until(running)
        watching = asyncio.create_task(events(here, place))
        await asyncio.sleep(1.0)  # the stream is only seen when it ends: let it begin
        assert (await there.http.delete(place)).status_code == 204
        assert (await watching)[-1][0] == "cancelled"

        async def idle() -> bool:
            return not here.jobs._running

        await asyncio.wait_for(until(idle), 30)
        assert await state_of(here, place) == "404"
        assert not here.planner.made

    served(database, use)


def test_a_request_that_a_client_waits_for_is_joined_by_the_other_replica(database: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        here.planner.go.clear()
        first = asyncio.create_task(here.http.post("/v1/plans", json=request(1)))

        async def running() -> bool:
            return bool(here.jobs._running)

        await until(running)
        second = asyncio.create_task(there.http.post("/v1/plans", json=request(1)))
        await asyncio.sleep(0.2)
        here.planner.go.set()
        answers = await asyncio.gather(first, second)
        assert [answer.status_code for answer in answers] == [200, 200]
        assert answers[0].content == answers[1].content
        assert len(here.planner.made) == 1
        assert not there.planner.made

    served(database, use)


def test_a_job_that_ends_its_replicas_ends_with_a_verdict(database: str) -> None:
    async def use(here: Replica, there: Replica) -> Any:
        for replica in (here, there):
            replica.jobs.park_queued()
        place = (await here.http.post("/v1/plans", json=request(1), headers=ASYNC)).headers[
            "location"
        ]
        for attempt in range(1, 4):  # three replicas claim it and are gone
            claim = await here.jobs._queue.claim(expired=attempt > 1)
            assert claim is not None
            assert claim.attempt == attempt
            async with here.jobs._store.database.connection() as connection:
                await connection.execute("UPDATE jobs SET lease_until = now() - interval '1 s'")
        there.jobs._parked = False
        assert await there.jobs._claim(expired=True)
        return (await here.http.get(place)).json()

    problem = served(database, use)
    assert problem["type"] == "urn:ikplan:worker-lost"
    assert "tried 3 times" in problem["detail"]


def test_a_refused_request_tells_why_at_both(database: str) -> None:
    far = {**GOOD, "path": {"waypoints": [{"position": [5.0, 0.0, 5.0]}]}}

    async def use(here: Replica, there: Replica) -> None:
        place = (await here.http.post("/v1/plans", json=far, headers=ASYNC)).headers["location"]
        assert (await events(there, place))[-1][0] == "failed"
        for replica in (here, there):
            answer = await replica.http.get(place)
            assert (answer.status_code, answer.json()["type"]) == (422, "urn:ikplan:unreachable")
        waited = await there.http.post("/v1/plans", json=far)
        assert waited.status_code == 422

    served(database, use)


def test_every_route_answers_at_two_replicas_in_turn_as_at_one(database: str) -> None:
    """Round robin: each request goes to the replica that did not get the one before."""
    at_one = served(":memory:", every_route)
    at_two = served(database, every_route)
    assert at_two == at_one
    assert 404 not in [status for name, status in at_two if not name.startswith("gone")]


async def every_route(here: Replica, there: Replica) -> list[tuple[str, int]]:
    turns = [here, there]
    answers: list[tuple[str, int]] = []

    async def ask(name: str, method: str, path: str, **content: Any) -> httpx.Response:
        turns.reverse()
        answer = await turns[0].http.request(method, path, **content)
        answers.append((name, answer.status_code))
        return answer

    upload = {"urdf": ARM}
    robot = (await ask("robot", "POST", "/v1/robots", json=upload)).json()["name"]
    await ask("robot", "GET", f"/v1/robots/{robot}")
    await ask("robots", "GET", "/v1/robots")
    await ask("visual", "GET", f"/v1/robots/{robot}/visual")
    await ask("catalogue", "GET", "/v1/robots/ur5")
    await ask("fk", "POST", "/v1/fk", json={"robot": robot, "q": [0.1] * 6})
    await ask("fk", "POST", "/v1/fk", json={"robot": robot, "q": [0.1] * 6})
    await ask("solvers", "GET", "/v1/solvers")
    box = {"type": "box", "size": [0.1, 0.1, 0.1]}
    cell = {"obstacles": [{"name": "far", "shape": box, "position": [2.0, 2.0, 0.0]}]}
    scene = (await ask("scene", "POST", "/v1/scenes", json=cell)).json()["id"]
    await ask("scene", "GET", f"/v1/scenes/{scene}")
    await ask("plan", "POST", "/v1/plans", json={**GOOD, "scene": scene})
    place = (await ask("plan", "POST", "/v1/plans", json=GOOD)).headers["content-location"]
    await ask("found", "GET", place)
    await ask("events", "GET", f"{place}/events")
    await ask("list", "GET", "/v1/plans")
    job = (await ask("job", "POST", "/v1/plans", json=request(7), headers=ASYNC)).headers[
        "location"
    ]
    await ask("job", "GET", f"{job}/events")
    await ask("job", "GET", job)
    await ask("again", "POST", "/v1/plans", json=request(7), headers=ASYNC)
    line = json.dumps(GOOD) + "\n" + json.dumps(request(8)) + "\n"
    ndjson = {"content-type": "application/x-ndjson"}
    await ask("batch", "POST", "/v1/batches", content=line, headers=ndjson)
    joints = [[0.0, -1.57, 1.57, 0.0, 1.0, 0.0], [0.4, -1.2, 1.3, 0.1, 1.0, 0.2]]
    timing = await ask("timing", "POST", "/v1/timings", json={"robot": "ur5", "waypoints": joints})
    await ask("timing", "GET", timing.headers["content-location"])
    await ask("delete", "DELETE", place)
    await ask("gone plan", "GET", place)
    await ask("gone events", "GET", f"{place}/events")
    await ask("gone delete", "DELETE", place)
    await ask("scene", "DELETE", f"/v1/scenes/{scene}")
    await ask("gone scene", "GET", f"/v1/scenes/{scene}")
    await ask("robot", "DELETE", f"/v1/robots/{robot}")
    await ask("gone robot", "GET", f"/v1/robots/{robot}")
    for path in ("/v1/audit", "/livez", "/readyz", "/version", "/metrics", "/openapi.json"):
        await ask(path, "GET", path)
    return answers


def test_jobs_go_on_over_a_restart_of_the_database(server: Postgres, database: str) -> None:
    async def use(here: Replica, there: Replica) -> list[httpx.Response]:
        for replica in (here, there):
            replica.planner.go.clear()
        places = []
        for number in range(6):
            accepted = await here.http.post("/v1/plans", json=request(number), headers=ASYNC)
            places.append(accepted.headers["location"])

        async def both_run() -> bool:
            return bool(here.jobs._running and there.jobs._running)

        await asyncio.wait_for(until(both_run), 60)
        await asyncio.to_thread(server.stop, "immediate")
        starting = threading.Timer(1.0, server.start)
        starting.start()
        for replica in (here, there):
            replica.planner.go.set()
        done: set[str] = set()
        seen: list[httpx.Response] = []
        deadline = time.monotonic() + 120
        while len(done) < len(places):
            assert time.monotonic() < deadline
            for i, place in enumerate(places):
                answer = await (here, there)[i % 2].http.get(place)
                seen.append(answer)
                if answer.status_code == 200:
                    done.add(place)
            await asyncio.sleep(0.1)
        starting.join()
        return seen

    seen = served(database, use, lease_s=5.0)
    assert {answer.status_code for answer in seen} <= {200, 202, 503}
    assert all("retry-after" in answer.headers for answer in seen if answer.status_code == 503)
    with psycopg.connect(database) as connection:
        ends = connection.execute(
            "SELECT subject, count(*) FROM audit WHERE action = 'finished' GROUP BY subject"
        ).fetchall()
    assert [count for _, count in ends] == [1] * 6
