"""A fleet simulated: arrivals at random, workers, and a database that each job passes twice."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

__all__ = ["Fleet", "Latency", "least_workers", "simulate"]

Array = NDArray[np.float64]
_WARM_SHARE = 0.1


@dataclass(frozen=True)
class Fleet:
    """Workers and a database.

    Attributes:
        workers: Worker processes, each of a core.
        database_cores: Cores of the database.
        claim_s: Time of a core of the database when a job is put in and claimed [s].
        finish_s: The same when its result is written [s].
    """

    workers: int
    database_cores: int
    claim_s: float
    finish_s: float


@dataclass(frozen=True)
class Latency:
    """From a job's arrival to its result in the database.

    Attributes:
        p50: Median [s].
        p95: 95th percentile [s].
        p99: 99th percentile [s].
        busy: Share of the workers' time that is work.
    """

    p50: float
    p95: float
    p99: float
    busy: float


def simulate(fleet: Fleet, rate: float, service: Array, jobs: int, seed: int = 0) -> Latency:
    """Let jobs arrive as a Poisson process, in order of arrival.

    Args:
        fleet: What answers them.
        rate: Jobs a second.
        service: Measured service times to draw from, shape (n,) [s].
        jobs: How many jobs; the first tenth is left out.
        seed: Seed of arrivals and draws.
    """
    rng = np.random.default_rng(seed)
    gaps = rng.exponential(1.0 / rate, jobs)
    times = rng.choice(service, jobs)
    environment = simpy.Environment()
    workers = simpy.Resource(environment, fleet.workers)
    database = simpy.Resource(environment, fleet.database_cores)
    taken = np.zeros(jobs)

    def asked(seconds: float) -> Generator[Any, Any, None]:
        with database.request() as turn:
            yield turn
            yield environment.timeout(seconds)

    def job(k: int) -> Generator[Any, Any, None]:
        begun = environment.now
        yield from asked(fleet.claim_s)
        with workers.request() as turn:
            yield turn
            yield environment.timeout(times[k])
            # The worker writes the result: it is free after that.
            yield from asked(fleet.finish_s)
        taken[k] = environment.now - begun

    def arrivals() -> Generator[Any, Any, None]:
        for k in range(jobs):
            yield environment.timeout(gaps[k])
            environment.process(job(k))

    environment.process(arrivals())
    environment.run()
    p50, p95, p99 = np.percentile(taken[int(_WARM_SHARE * jobs) :], [50.0, 95.0, 99.0])
    busy = float(times.sum() / (environment.now * fleet.workers))
    return Latency(float(p50), float(p95), float(p99), busy)


def least_workers(
    rate: float, service: Array, database: Fleet, jobs: int, slack_s: float
) -> tuple[Fleet, Latency]:
    """Return the smallest fleet whose queues add at most some time at the 99th percentile.

    Args:
        rate: Jobs a second.
        service: Measured service times [s].
        database: A fleet for its database.
        jobs: Jobs of each simulation.
        slack_s: How much longer than the service's own 99th percentile that of the latency may be.
    """
    workers = max(int(np.ceil(rate * float(service.mean()))), 1)
    most = float(np.percentile(service, 99.0)) + slack_s
    while True:
        fleet = Fleet(workers, database.database_cores, database.claim_s, database.finish_s)
        found = simulate(fleet, rate, service, jobs)
        if found.p99 <= most:
            return fleet, found
        workers += max(workers // 20, 1)
