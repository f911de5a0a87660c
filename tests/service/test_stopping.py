"""A service that is told to stop: what ends at once, what gets time, what is done later."""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import httpx

import ikplan
from benchmarks.service.requests import helices, slow_request
from benchmarks.service.server import Server, serving
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from tests.measured import waypoint_errors
from tests.present import present

from .bad_requests import GOOD
from .conftest import ADDRESS
from .serving import WAIT_S, bound_s
from .stand_in import StandIn

ASYNC = {"prefer": "respond-async"}
STUCK = """
import asyncio, sys
from ikplan.cli import main
from ikplan_api.workers.process_planner import ProcessPlanner

never = []  # what nothing refers to is collected, and so is the task that waits for it

async def close(self):
    never.append(asyncio.Event())
    await never[0].wait()

if __name__ == "__main__":
    ProcessPlanner.close = close
    sys.exit(main(["serve", "--port", "0", "--workers", "1"]))
"""


def at(x: float) -> dict[str, Any]:
    return {**GOOD, "path": {"waypoints": [{"position": [x, 0.0, 0.5]}]}}


def test_what_runs_gets_its_time_and_what_waits_is_put_off() -> None:
    async def run() -> None:
        planner = StandIn()
        app = create_app(Settings(store_path=":memory:", stop_s=100), planner=planner)
        async with (
            asyncio.timeout(WAIT_S),
            httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=ADDRESS) as http,
        ):
            async with app.router.lifespan_context(app) as state:
                wanted = asyncio.create_task(http.post("/v1/plans", json=at(0.5)))
                for x in (0.51, 0.52, 0.53):
                    await http.post("/v1/plans", json=at(x), headers=ASYNC)
                while len(planner.asked) < 4:
                    await asyncio.sleep(0.005)
                assert json.loads(planner.asked[1]) == at(0.51)
                present(planner.progress[1])("ik", 1, 2)
                assert present(state)["stop"]() == 100
                await asyncio.sleep(0.01)
                assert [json.loads(d) for d in planner.cancelled] == [at(0.52), at(0.53)]
                planner.answer()
                assert (await wanted).status_code == 200
                left = [job.plan_id for job in await app.state.store.pending()]
                asyncio.get_running_loop().call_later(0.2, planner.answer)
                begin = time.monotonic()
            assert 0.1 < time.monotonic() - begin < min(bound_s(4.0), 90.0)
            assert len(left) == 3

    asyncio.run(run())


def test_what_takes_too_long_is_not_waited_for() -> None:
    async def run() -> float:
        planner = StandIn()
        app = create_app(Settings(store_path=":memory:", stop_s=0.3), planner=planner)
        async with (
            asyncio.timeout(WAIT_S),
            httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=ADDRESS) as http,
        ):
            async with app.router.lifespan_context(app):
                await http.post("/v1/plans", json=at(0.5), headers=ASYNC)
                while not planner.asked:
                    await asyncio.sleep(0.005)
                present(planner.progress[0])("ik", 1, 2)
                begin = time.monotonic()
            return time.monotonic() - begin

    assert 0.2 < asyncio.run(run()) < bound_s(3.0)


def test_a_stopped_service_ends_its_streams_and_does_its_jobs_after_the_next_start(
    tmp_path: Path,
) -> None:
    path = str(tmp_path / "store.sqlite3")
    jobs = [json.loads(body) for _, body in zip(range(3), helices(8 * 10**6), strict=False)]
    server = Server(workers="1", store_path=path, stop_s="1")
    try:
        server.wait_until_ready()
        with ikplan.Client(server.address) as client:
            slow = client.submit(slow_request(300.0))
            ids = [client.submit(job).id for job in jobs]
            while slow.status().state != "running":
                time.sleep(0.05)
            with httpx.stream("GET", f"{server.address}/v1/plans/{slow.id}/events") as stream:
                told = stream.iter_lines()
                assert next(told) == "event: progress"
                server.process.send_signal(signal.SIGTERM)
                begin = time.monotonic()
                events = {line for line in told if line.startswith("event:")}
                assert time.monotonic() - begin < bound_s(5.0)
            assert events <= {"event: progress"}
        assert server.process.wait(WAIT_S) == -signal.SIGTERM
    finally:
        server.stop()
    with serving(workers="1", store_path=path) as again, ikplan.Client(again.address) as client:
        status = client.job(slow.id).status()
        assert status.state in ("queued", "running")
        client.job(slow.id).cancel()
        assert [client.job(i).wait(timeout=WAIT_S).id for i in ids] == ids

        # Who waits for an answer when the service is to stop still gets it.
        answers = []
        big = {**slow_request(60.0), "ik": {"population": 300, "iterations": 200, "seed": 1}}
        waiting = threading.Thread(target=lambda: answers.append(client.plan(big)))
        waiting.start()
        while "ikplan_tasks_running 1.0" not in httpx.get(f"{again.address}/metrics").text:
            time.sleep(0.02)
        again.process.send_signal(signal.SIGTERM)
        waiting.join(WAIT_S)
        assert waypoint_errors(answers[0], big["path"]).max() <= 1e-8
        assert again.process.wait(WAIT_S) == -signal.SIGTERM


def test_a_service_that_is_stuck_ends_all_the_same() -> None:
    environment = {**os.environ, "IKPLAN_STORE_PATH": ":memory:", "IKPLAN_STOP_S": "0"}
    command = [sys.executable, "-c", STUCK]
    pipes: dict[str, Any] = {"stderr": subprocess.PIPE, "text": True, "env": environment}
    with subprocess.Popen(command, **pipes) as process:
        assert process.stderr is not None
        address = process.stderr.readline().split()[3]
        # Before it is ready it does not wait: what loads kernels cannot be stopped.
        while httpx.get(f"{address}/readyz", timeout=WAIT_S).status_code != 200:
            time.sleep(0.1)
        process.send_signal(signal.SIGTERM)
        begin = time.monotonic()
        assert process.wait(WAIT_S) == 1
        assert 5.0 < time.monotonic() - begin < bound_s(20.0)
        said = process.stderr.read()
    assert "did not end in time" in said


def test_who_waits_for_a_service_that_is_not_ready_yet_gets_an_answer() -> None:
    environment = {**os.environ, "IKPLAN_STORE_PATH": ":memory:", "IKPLAN_STOP_S": str(int(WAIT_S))}
    command = [sys.executable, "-m", "ikplan", "serve", "--port", "0", "--workers", "1"]
    pipes: dict[str, Any] = {"stderr": subprocess.PIPE, "text": True, "env": environment}
    answers = []
    with subprocess.Popen(command, **pipes) as process:
        assert process.stderr is not None
        address = process.stderr.readline().split()[3]
        waiting = threading.Thread(
            target=lambda: answers.append(
                httpx.post(f"{address}/v1/plans", json=GOOD, timeout=WAIT_S)
            )
        )
        waiting.start()
        arrived = re.compile("^ikplan_tasks_(queued|running) 1.0$", re.MULTILINE)
        while waiting.is_alive() and not arrived.search(httpx.get(f"{address}/metrics").text):
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        waiting.join(WAIT_S)
        process.wait(WAIT_S)
    assert answers[0].status_code in (200, 503)  # the plan, or when to ask again
    assert answers[0].headers["content-type"].startswith("application/")
