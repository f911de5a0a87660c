"""Large exports, uploads and listings keep nobody else waiting, with ``ikplan serve`` itself."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from .serving import Prober, Served, bound_s, serve

LONG = {
    "robot": "ur5",
    "waypoints": [[0.0] * 6, [2.0, -1.0, 1.0, 0.5, 0.5, 0.5], [0.0] * 6],
    "limits": {"velocity_scale": 0.02},
    "sampling": {"rate_hz": 500},
    "budget_s": 100,
}


@pytest.fixture(scope="module")
def running() -> Iterator[Served]:
    with serve(workers=1) as running:
        running.wait_until_ready()
        yield running


def test_a_long_export_keeps_nobody_waiting(running: Served) -> None:
    with httpx.Client(base_url=running.address, timeout=100) as http:
        made = http.post("/v1/timings", json=LONG)
        assert made.status_code == 200, made.text
        place = made.headers["content-location"]
        with Prober(running.address) as prober:
            for media_type in ("text/csv", "application/x-npz"):
                answer = http.get(place, headers={"accept": media_type, "accept-encoding": "gzip"})
                assert answer.status_code == 200
                assert len(answer.content) > 2**20
            http.post("/v1/batches", content=b" " * 2**25, headers={"content-type": "text/plain"})
            assert http.post("/v1/fk", json={"x": "y" * 2**25}).status_code == 413
        figures = http.get("/metrics").text
        assert 'ikplan_tasks_total{kind="export-csv",outcome="done"} 1.0' in figures
        assert "ikplan_event_loop_lag_seconds_bucket" in figures
    assert not prober.faults
    assert prober.worst <= bound_s()
