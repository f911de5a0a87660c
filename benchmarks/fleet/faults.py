"""Jobs while replicas and workers are killed and halted at random, and the database restarts."""

from __future__ import annotations

import os
import random
import signal
import threading
import time
from typing import Any, NamedTuple

import httpx
import psycopg

from benchmarks.fleet.postgres import Postgres
from benchmarks.fleet.replica import Replica
from benchmarks.fleet.requests import request

__all__ = ["Faults", "jobs_with_faults"]

_TAKEOVERS = """
SELECT claimed.time, before.time, before.replica, claimed.attempt FROM audit AS claimed
JOIN audit AS before ON before.subject = claimed.subject AND before.action = 'claimed'
    AND before.attempt = claimed.attempt - 1
WHERE claimed.action = 'claimed' AND claimed.attempt > 1 ORDER BY claimed.place
"""


class Faults(NamedTuple):
    """How many faults of each kind.

    Attributes:
        replicas: Replicas killed, and started again.
        workers: Workers killed.
        halts: Replicas halted for longer than a lease, and continued.
        restarts: Restarts of the database.
    """

    replicas: int = 3
    workers: int = 8
    halts: int = 2
    restarts: int = 0


def jobs_with_faults(
    server: Postgres,
    database: str,
    replicas: list[Replica],
    *,
    jobs: int,
    waypoints: int,
    lease_s: float,
    faults: Faults,
    seed: int,
) -> dict[str, Any]:
    """Submit jobs, do harm, and count what came of each job."""
    rng = random.Random(seed)
    began = time.monotonic()
    statuses: dict[int, int] = {}
    before = _finished(database)
    ids: list[str] = []

    def submit() -> None:
        for i in range(jobs):
            ids.append(_submit(replicas, i, request(before + i, waypoints), statuses))

    submitting = threading.Thread(target=submit)
    submitting.start()
    ends: dict[str, float] = {}  # replica's name in the audit by when it was killed
    harms = ["replica"] * faults.replicas + ["worker"] * faults.workers
    harms += ["halt"] * faults.halts + ["restart"] * faults.restarts
    rng.shuffle(harms)
    done = 0
    for number, harm in enumerate(harms):
        # Spread over the run, whatever the machine's speed.
        while _finished(database) - before < jobs * (number + 1) / (len(harms) + 2):
            time.sleep(0.05)
        replica = rng.choice(replicas)
        if harm == "worker":
            for pid in replica.workers()[:1]:
                os.kill(pid, signal.SIGKILL)
        elif harm == "halt":
            _wait_for_work(database, replica)
            replica.send(signal.SIGSTOP)
            time.sleep(2.0 * lease_s + 1.0)
            replica.send(signal.SIGCONT)
        elif harm == "restart":
            server.stop("immediate")
            time.sleep(1.0)
            server.start()
        else:
            if (name := _name(database, replica)) is not None:
                ends[name] = time.time()
            replica.kill()
            replica.start()  # the other one has the jobs until it is warm
        done = _finished(database) - before
        print(
            f"  {harm:8} at {time.monotonic() - began:6.1f} s: {done} of {jobs} finished",
            flush=True,
        )
    submitting.join()
    deadline = time.monotonic() + 900
    while (done := _finished(database) - before) < jobs and time.monotonic() < deadline:
        if _failed(database) + done >= jobs:
            break
        _ask(replicas, ids[rng.randrange(jobs)], statuses)
        time.sleep(0.5)
    seen = [_ask(replicas, plan_id, statuses) for plan_id in ids]
    with psycopg.connect(database) as connection:
        counts: dict[str, int] = dict(
            connection.execute("SELECT action, count(*) FROM audit GROUP BY action").fetchall()
        )
        per_job = connection.execute(
            "SELECT n, count(*) FROM (SELECT count(*) AS n FROM audit WHERE action IN "
            "('finished', 'failed') GROUP BY subject) AS t GROUP BY n"
        ).fetchall()
        taken = connection.execute(_TAKEOVERS).fetchall()
    late = [
        claimed.timestamp() - ends[replica]
        for claimed, before, replica, _ in taken
        if replica in ends and before.timestamp() <= ends[replica]
    ]
    return {
        "jobs": jobs,
        "plans found by a client": seen.count(200),
        "verdicts": seen.count(503) + seen.count(500),
        "lost": seen.count(404),
        "ends for each job": dict(per_job),
        "audit": counts,
        "takeovers after a kill [s]": [round(value, 2) for value in sorted(late)],
        "lease [s]": lease_s,
        "statuses that clients saw": statuses,
        "seconds": round(time.monotonic() - began, 1),
    }


def _submit(
    replicas: list[Replica], number: int, document: dict[str, Any], statuses: dict[int, int]
) -> str:
    deadline = time.monotonic() + 600
    while True:
        number += 1
        replica = replicas[number % len(replicas)]
        try:
            answer = httpx.post(
                f"{replica.address}/v1/plans",
                json=document,
                headers={"prefer": "respond-async"},
                timeout=10.0,
            )
        except httpx.HTTPError:  # it is killed or halted: another one answers
            assert time.monotonic() < deadline
            time.sleep(0.2)
            continue
        statuses[answer.status_code] = statuses.get(answer.status_code, 0) + 1
        if answer.is_success:
            return str(answer.json()["id"])
        assert answer.status_code == 503, answer.text
        assert "retry-after" in answer.headers
        time.sleep(1.0)


def _ask(replicas: list[Replica], plan_id: str, statuses: dict[int, int]) -> int:
    for _ in range(100):
        for replica in replicas:
            try:
                answer = httpx.get(f"{replica.address}/v1/plans/{plan_id}", timeout=30.0)
            except httpx.HTTPError:
                continue
            statuses[answer.status_code] = statuses.get(answer.status_code, 0) + 1
            if answer.status_code != 503 or "ikplan:service-unavailable" not in answer.text:
                return answer.status_code
        time.sleep(0.5)
    return 0


def _finished(database: str) -> int:
    return _count(database, "SELECT count(*) FROM plans")


def _failed(database: str) -> int:
    return _count(database, "SELECT count(*) FROM jobs WHERE state = 'failed'")


def _count(database: str, query: str) -> int:
    with psycopg.connect(database) as connection:
        row = connection.execute(query.encode()).fetchone()
    assert row is not None
    return int(row[0])


def _name(database: str, replica: Replica) -> str | None:
    """Return the name in the database of a replica that has a job now: it has the process id."""
    with psycopg.connect(database) as connection:
        row = connection.execute(
            "SELECT replica FROM jobs WHERE state = 'running' AND replica LIKE %s",
            (f"%-{replica.pid}-%",),
        ).fetchone()
    return None if row is None else str(row[0])


def _wait_for_work(database: str, replica: Replica) -> None:
    deadline = time.monotonic() + 20
    while _name(database, replica) is None and time.monotonic() < deadline:
        time.sleep(0.02)
