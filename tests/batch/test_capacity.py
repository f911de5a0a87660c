"""The simulated fleet against queues with a closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.capacity.simulation import Fleet, least_workers, simulate

pytest.importorskip("simpy")

RNG = np.random.default_rng(5)
EXPONENTIAL = RNG.exponential(1.0, 50_000)


def test_one_worker_is_a_queue_whose_time_is_exponential() -> None:
    """M/M/1: the time in the system is exponential with rate mu - lambda."""
    found = simulate(Fleet(1, 1, 0.0, 0.0), 0.5, EXPONENTIAL, 15_000)
    for share, measured in ((0.5, found.p50), (0.95, found.p95)):
        assert measured == pytest.approx(-math.log(1.0 - share) / 0.5, rel=0.08)
    assert found.busy == pytest.approx(0.5, abs=0.02)


def test_without_queues_a_job_takes_its_service_and_the_database() -> None:
    found = simulate(Fleet(1000, 1000, 0.2, 0.3), 0.01, np.full(10, 2.0), 500)
    assert found.p50 == pytest.approx(2.5)
    assert found.p99 == pytest.approx(2.5)


def test_a_database_that_is_asked_for_more_than_it_has_falls_behind() -> None:
    service = np.full(10, 0.01)
    kept = simulate(Fleet(8, 2, 0.001, 0.001), 500.0, service, 1_500)
    full = simulate(Fleet(8, 1, 0.0015, 0.0015), 500.0, service, 1_500)
    assert full.p99 > 10.0 * kept.p99
    later = simulate(Fleet(8, 1, 0.0015, 0.0015), 500.0, service, 3_000)
    assert later.p99 > 1.5 * full.p99


def test_the_smallest_fleet_keeps_the_slack_and_one_worker_fewer_does_not() -> None:
    service = np.full(10, 0.1)
    fleet, found = least_workers(50.0, service, Fleet(1, 4, 0.0, 0.0), 1_500, 0.05)
    assert found.p99 <= 0.15
    fewer = Fleet(fleet.workers - 1, 4, 0.0, 0.0)
    assert simulate(fewer, 50.0, service, 1_500).p99 > 0.15
