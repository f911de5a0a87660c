"""Workers that are killed, halted, overdue, out of memory or no longer wanted."""

import asyncio
import json
import os
import re
import signal
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import httpx
import pytest

import ikplan
from ikplan import (
    AsyncClient,
    BudgetExceeded,
    IkplanError,
    MemoryExceeded,
    ServiceUnavailable,
    WorkerLost,
)
from ikplan.planning import Progress
from ikplan.processor_time import WALL_FACTOR
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.telemetry.load import Load
from ikplan_api.workers.attempts import Attempts
from ikplan_api.workers.process_planner import ProcessPlanner
from tests.measured import waypoint_errors
from tests.present import present

from .bad_requests import GOOD
from .conftest import ADDRESS
from .serving import WAIT_S, bound_s

QUICK = json.dumps(GOOD).encode()
# Minutes of searching.
LONG = json.dumps(
    {
        **GOOD,
        "path": {"waypoints": [{"position": [0.5, 0.01 * i, 0.5]} for i in range(50)]},
        "ik": {"population": 2000, "iterations": 5000},
    }
).encode()

SLOW = json.dumps({**json.loads(LONG), "ik": {"population": 100, "iterations": 100}}).encode()


def use(
    scenario: Callable[[ProcessPlanner], Awaitable[Any]],
    workers: int = 1,
    queued: int = 10,
    **how: Any,
) -> Any:
    """Run a scenario with a planner of its own, and end that."""

    async def run() -> Any:
        planner = ProcessPlanner(workers, queued, **how)
        try:
            async with asyncio.timeout(WAIT_S):
                await planner.warm_up()
                return await scenario(planner)
        finally:
            await planner.close()

    return asyncio.run(run())


class Begun(asyncio.Event):
    """Is set when a task tells its first stage."""

    @property
    def progress(self) -> Progress:
        return lambda *_: self.set()


async def until(true: Callable[..., bool]) -> None:
    async with asyncio.timeout(WAIT_S):
        while not true():
            await asyncio.sleep(0.01)


def alive(pid: int) -> bool:
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"


@pytest.mark.parametrize(
    "request_",
    [
        {**GOOD, "robot": "iiwa41"},
        {**GOOD, "path": {"waypoints": [{"position": [0.5, 0.0, 9.0]}]}},
        {**GOOD, "start": [0.0]},
    ],
)
def test_an_error_crosses_the_border_as_itself(request_: dict[str, Any]) -> None:
    async def fail(planner: ProcessPlanner) -> IkplanError:
        with pytest.raises(IkplanError) as caught:
            await planner.run("plan", json.dumps(request_).encode())
        return caught.value

    with pytest.raises(IkplanError) as here:
        ikplan.plan(request_)
    there = use(fail)
    assert type(there) is here.type
    assert there.to_problem() == here.value.to_problem()


def test_a_worker_starts_no_threads_but_the_one_that_watches_the_service() -> None:
    async def count(planner: ProcessPlanner) -> None:
        await planner.run("plan", QUICK)
        # The timer of the plan's budget may just be ending.
        await until(lambda: len(os.listdir(f"/proc/{planner.pids[0]}/task")) == 2)

    use(count)


async def end_worker_twice(planner: ProcessPlanner, how: signal.Signals) -> IkplanError:
    """Begin a plan, end its worker, and again that of its second attempt."""
    begun, attempts = Begun(), Attempts()
    doomed = asyncio.create_task(
        planner.run("plan", LONG, progress=begun.progress, attempts=attempts)
    )
    for attempt in (1, 2):
        await until(lambda attempt=attempt: attempts.begun == attempt)
        begun.clear()
        await begun.wait()
        os.kill(planner.pids[0], how)
    with pytest.raises(IkplanError, match="tried 2 times") as caught:
        await doomed
    return caught.value


def test_a_request_whose_workers_are_killed_costs_no_other_request() -> None:
    async def kill(planner: ProcessPlanner) -> None:
        first = planner.pids[0]
        dooming = asyncio.create_task(end_worker_twice(planner, signal.SIGKILL))
        await until(lambda: planner.load.running == 1)
        others = [asyncio.create_task(planner.run("plan", QUICK)) for _ in range(3)]
        error = await dooming
        assert (type(error), error.data["retry_after_s"]) == (ServiceUnavailable, 1.0)
        assert len({json.loads((await o).document)["id"] for o in others}) == 1
        assert first not in planner.pids
        await until(lambda: planner.load == Load(workers=1, running=0, queued=0))

    use(kill)


def test_a_request_whose_worker_is_killed_once_is_answered() -> None:
    async def kill(planner: ProcessPlanner) -> bytes:
        begun = Begun()
        asking = asyncio.create_task(planner.run("plan", SLOW, progress=begun.progress))
        await begun.wait()
        os.kill(planner.pids[0], signal.SIGKILL)
        return (await asking).document

    plan = ikplan.Plan.load(use(kill))
    assert waypoint_errors(plan, json.loads(LONG)["path"]).max() <= 1e-8


@pytest.mark.parametrize("how", [signal.SIGSEGV, signal.SIGABRT])
def test_a_request_that_crashes_its_workers_is_told_so(how: signal.Signals) -> None:
    async def crash(planner: ProcessPlanner) -> None:
        error = await end_worker_twice(planner, how)
        assert (type(error), error.data) == (WorkerLost, {"exit_code": -how})
        await planner.run("plan", QUICK)

    use(crash)


def test_a_worker_that_is_killed_while_idle_costs_nothing() -> None:
    async def kill(planner: ProcessPlanner) -> bytes:
        os.kill(planner.pids[0], signal.SIGKILL)
        return (await planner.run("plan", QUICK)).document

    plan = ikplan.Plan.load(use(kill))
    assert waypoint_errors(plan, json.loads(QUICK)["path"]).max() <= 1e-8


def test_a_plan_that_overruns_its_budget_is_stopped_with_its_worker() -> None:
    async def wait(planner: ProcessPlanner) -> float:
        (pid,) = planner.pids
        begin = time.monotonic()
        with pytest.raises(BudgetExceeded) as caught:
            await planner.run("plan", LONG, limit_s=0.2)
        assert (caught.value.stage, caught.value.budget_s) == ("ik", 0.2)
        assert "of processor time" in caught.value.detail
        assert not alive(pid)
        took = time.monotonic() - begin
        await planner.run("plan", QUICK)
        return took

    # On a busy machine half a second of processor time takes 1.1 s and the grace at most.
    assert 0.5 < use(wait, grace_s=0.3) < bound_s(5.0)


def test_a_plan_that_waits_for_a_processor_is_stopped_when_its_wall_time_runs_out() -> None:
    async def halt(planner: ProcessPlanner) -> None:
        (pid,) = planner.pids
        begun = Begun()
        halted = asyncio.create_task(
            planner.run("plan", LONG, limit_s=0.5, progress=begun.progress)
        )
        await begun.wait()
        os.kill(pid, signal.SIGSTOP)
        await asyncio.sleep(WALL_FACTOR * 0.5 + 0.5)
        os.kill(pid, signal.SIGCONT)
        with pytest.raises(BudgetExceeded, match="4 times as much wall time") as caught:
            await halted
        assert caught.value.budget_s == 0.5
        assert not alive(pid)

    use(halt, grace_s=0.5)


def test_a_plan_without_enough_memory_is_told_so_and_the_next_has_it_again() -> None:
    async def fresh(planner: ProcessPlanner) -> int:
        status = Path(f"/proc/{planner.pids[0]}/status").read_text()
        return int(present(re.search(r"VmData:\s+(\d+) kB", status))[1]) * 1024

    limit = use(fresh) + 30 * 2**20

    async def eat(planner: ProcessPlanner) -> None:
        (pid,) = planner.pids
        crawl = {
            "robot": "iiwa14",
            "waypoints": [[0.0] * 7, [1.0] * 7],
            "limits": {"velocity_scale": 0.001},
            "sampling": {"rate_hz": 300},
        }
        with pytest.raises(MemoryExceeded) as caught:
            await planner.run("time", json.dumps(crawl).encode())
        assert caught.value.limit_bytes == limit
        await planner.run("plan", QUICK)
        assert not alive(pid)

    use(eat, memory_bytes=limit)


def test_a_task_that_is_cancelled_frees_its_worker() -> None:
    async def cancel(planner: ProcessPlanner) -> None:
        (pid,) = planner.pids
        begun = Begun()
        unwanted = asyncio.create_task(planner.run("plan", LONG, progress=begun.progress))
        waiting = asyncio.create_task(planner.run("plan", LONG))
        await begun.wait()
        waiting.cancel()
        unwanted.cancel()
        await asyncio.wait([unwanted, waiting])
        await planner.run("plan", QUICK)
        assert not alive(pid)

    use(cancel)


def test_progress_is_told_by_stage_and_waypoint() -> None:
    told: list[tuple[str, int, int]] = []

    async def listen(planner: ProcessPlanner) -> None:
        await planner.run("plan", SLOW, progress=lambda *news: told.append(news))

    use(listen)
    assert list(dict.fromkeys(stage for stage, _, _ in told)) == [
        "ik", "planning", "timing", "certificate",
    ]  # fmt: skip
    assert {total for stage, _, total in told if stage == "ik"} <= {0, 50}
    done = [done for _, done, total in told if total]
    assert done == sorted(done)
    assert len(set(done)) > 2


def busy_service(
    queued: int, scenario: Callable[[ProcessPlanner, AsyncClient], Awaitable[Any]]
) -> Any:
    """A service whose only worker is halted until the scenario lets it go on."""

    async def run(planner: ProcessPlanner) -> Any:
        app = create_app(Settings(), planner=planner)
        os.kill(planner.pids[0], signal.SIGSTOP)
        try:
            transport = httpx.ASGITransport(app)
            async with AsyncClient(ADDRESS, transport=transport, retries=0) as client:
                return await scenario(planner, client)
        finally:
            os.kill(planner.pids[0], signal.SIGCONT)

    return use(run, queued=queued)


FK = {"robot": "ur5", "q": [0.0] * 6}


def test_beyond_the_queue_the_service_says_it_is_busy() -> None:
    async def flood(planner: ProcessPlanner, client: AsyncClient) -> list[httpx.Response]:
        http = client._http
        waiting = [asyncio.create_task(http.post("/v1/fk", json=FK)) for _ in range(8)]
        await until(lambda: sum(w.done() for w in waiting) == 5)
        assert planner.load == Load(workers=1, running=1, queued=2)
        begin = time.monotonic()
        assert (await http.get("/livez")).status_code == 200
        assert time.monotonic() - begin < bound_s()
        os.kill(planner.pids[0], signal.SIGCONT)
        return await asyncio.gather(*waiting)

    answers = busy_service(2, flood)
    assert sorted(a.status_code for a in answers) == [200] * 3 + [503] * 5
    refused = next(a for a in answers if a.status_code == 503)
    assert refused.headers["retry-after"] == "1"
    assert refused.json()["type"] == "urn:ikplan:service-unavailable"


def test_the_client_learns_when_to_ask_a_busy_service_again() -> None:
    async def ask(planner: ProcessPlanner, client: AsyncClient) -> ServiceUnavailable:
        first = asyncio.create_task(client.fk(FK))
        await until(lambda: planner.load.running == 1)
        with pytest.raises(ServiceUnavailable) as caught:
            await client.fk(FK)
        os.kill(planner.pids[0], signal.SIGCONT)
        await first
        return caught.value

    error = busy_service(0, ask)
    assert error.data == {"url": f"{ADDRESS}/v1/fk", "status_code": 503, "retry_after_s": 1.0}


def test_a_planner_that_is_closed_takes_nothing_more() -> None:
    async def close(planner: ProcessPlanner) -> None:
        pids = planner.pids
        begun = Begun()
        running = asyncio.create_task(planner.run("plan", LONG, progress=begun.progress))
        waiting = asyncio.create_task(planner.run("plan", QUICK))
        await begun.wait()
        await planner.close()
        with pytest.raises(ServiceUnavailable, match="stopping"):
            await planner.run("plan", QUICK)
        for left in (running, waiting):
            with pytest.raises(ServiceUnavailable, match="stopping"):
                await left
        assert not any(map(alive, pids))

    use(close)
