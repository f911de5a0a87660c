"""Replicas that are killed and halted at random: each job ends once, and none is lost."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import random
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.process import BaseProcess
from typing import Any

import psycopg
import pytest

from ikplan_api.store.plan_store import Job
from ikplan_api.store.postgres.store import PostgresStore

from ..serving import WAIT_S, bound_s
from .light import BOUNDS, run_replica

LEASE_S = 3.0


@pytest.fixture(scope="module")
def start() -> Iterator[Callable[[str, float], BaseProcess]]:
    """Starts a replica, by a process that has imported what it needs."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([run_replica.__module__])
    running: list[BaseProcess] = []

    def begin(database: str, seconds: float) -> BaseProcess:
        made = context.Process(target=run_replica, args=(database, LEASE_S, seconds), daemon=True)
        made.start()
        running.append(made)
        return made

    yield begin
    for process in running:
        process.kill()
        process.join()
        process.close()


@contextmanager
def asked(database: str) -> Iterator[Callable[..., list[tuple[Any, ...]]]]:
    with psycopg.connect(database, autocommit=True) as connection:

        def rows(query: str, *values: Any) -> list[tuple[Any, ...]]:
            return connection.execute(query.encode(), values).fetchall()

        yield rows


def accept(database: str, count: int) -> None:
    async def run() -> None:
        store = PostgresStore(database, BOUNDS, lease_s=LEASE_S)
        await store.open()
        for i in range(count):
            await store.queue.accept(Job(f"j{i}", "plan", b"%d" % i, None, 10.0))
        await store.close()

    asyncio.run(run())


def name_of(process: BaseProcess) -> str:
    return f"%-{process.pid}-%"


def wait(true: Callable[[], object]) -> None:
    deadline = time.monotonic() + WAIT_S
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_two_hundred_jobs_end_once_each_whoever_is_killed(
    database: str, start: Callable[[str, float], BaseProcess]
) -> None:
    jobs, rng = 200, random.Random(7)
    accept(database, jobs)
    replicas = [start(database, 0.03) for _ in range(2)]
    deadline = time.monotonic() + 2 * WAIT_S
    with asked(database) as rows:
        for harm in ("kill", "halt", "kill", "kill", "halt", "kill"):
            time.sleep(rng.uniform(0.2, 0.6))
            chosen = rng.randrange(2)
            victim = replicas[chosen]
            query = "SELECT 1 FROM jobs WHERE state = 'running' AND replica LIKE %s"
            while not rows(query, name_of(victim)) and rows("SELECT 1 FROM jobs LIMIT 1"):
                assert time.monotonic() < deadline
                time.sleep(0.005)
            assert victim.pid is not None
            if harm == "halt":
                os.kill(victim.pid, signal.SIGSTOP)
                time.sleep(LEASE_S + 1.0)
                os.kill(victim.pid, signal.SIGCONT)
            else:
                victim.kill()
                replicas[chosen] = start(database, 0.03)
        while rows("SELECT 1 FROM jobs LIMIT 1"):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        ends = rows("SELECT subject, count(*) FROM audit WHERE action = 'finished' GROUP BY 1")
        assert sorted(ends) == sorted((f"j{i}", 1) for i in range(jobs))
        assert rows("SELECT count(*) FROM plans") == [(jobs,)]
        assert rows("SELECT count(*) FROM audit WHERE action = 'failed'") == [(0,)]
        (claims,) = rows("SELECT count(*) FROM audit WHERE action = 'claimed'")[0]
    assert jobs + 1 <= claims <= jobs + 6


def test_what_a_killed_replica_had_is_taken_over_within_its_lease_and_a_second(
    database: str, start: Callable[[str, float], BaseProcess]
) -> None:
    first = start(database, 30.0)
    with asked(database) as rows:
        accept(database, 1)
        wait(lambda: rows("SELECT 1 FROM jobs WHERE state = 'running'"))
        start(database, 0.01)
        time.sleep(2 * LEASE_S)  # renewed meanwhile: nobody takes it
        assert rows("SELECT attempt FROM jobs") == [(1,)]
        began = time.time()
        first.kill()
        wait(lambda: rows("SELECT 1 FROM plans"))
        query = (
            "SELECT extract(epoch FROM time)::float8 FROM audit WHERE attempt = 2 ORDER BY place"
        )
        (taken, *_), *_ = rows(query)
    assert LEASE_S / 2 < taken - began < LEASE_S + bound_s(1.0)


def test_a_replica_that_was_halted_beyond_its_lease_is_refused(
    database: str, start: Callable[[str, float], BaseProcess]
) -> None:
    first = start(database, 1.0)
    with asked(database) as rows:
        accept(database, 1)
        wait(lambda: rows("SELECT 1 FROM jobs WHERE state = 'running'"))
        assert first.pid is not None
        os.kill(first.pid, signal.SIGSTOP)
        start(database, 4.0)  # has it when the first one goes on
        wait(lambda: rows("SELECT 1 FROM audit WHERE attempt = 2 AND action = 'claimed'"))
        os.kill(first.pid, signal.SIGCONT)
        wait(lambda: rows("SELECT 1 FROM plans"))
        time.sleep(0.5)
        ends = rows("SELECT action, attempt FROM audit WHERE attempt > 0 ORDER BY place")
    assert ("finished", 2) in ends
    assert ("finished", 1) not in ends
    assert [end for end in ends if end[0] == "finished"] == [("finished", 2)]
