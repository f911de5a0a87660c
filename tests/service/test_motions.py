"""Moving ends, durations, times, dwells, events and least time over HTTP and by the client."""

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import Client

ROWS = [[0.0, -1.2, 1.5, -1.8, -1.5, 0.2], [0.4, -0.9, 1.3, -1.7, -1.3, -0.1]]
TIMING = {
    "robot": "ur5",
    "waypoints": ROWS,
    "start_velocity": [0.3] * 6,
    "limits": {"duration": 2.0011},
}
DOWN = {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}
PLAN = {
    "robot": "ur5",
    "start": "free",
    "path": {
        "begin": {"position": [0.4, -0.1, 0.3], **DOWN},
        "segments": [
            {"type": "line", "to": {"position": [0.4, 0.1, 0.3], **DOWN}, "dwell": 0.3},
            {"type": "line", "to": {"position": [0.4, 0.1, 0.35], **DOWN}},
        ],
    },
    "events": [{"name": "on", "segment": 0, "distance": 0.05}],
    "ik": {"objective": "time"},
    "scene": {"self_collision": False},
}


def test_a_timing_takes_its_time_and_begins_moving(client: Client) -> None:
    plan = client.time(TIMING)
    assert plan.duration == pytest.approx(2.0011, abs=1e-9)
    assert np.abs(plan.dq[0] - 0.3).max() <= 1e-9


def test_a_refusal_carries_the_nearest_feasible_values(http: httpx.Client, client: Client) -> None:
    answer = http.post("/v1/timings", json={**TIMING, "limits": {"duration": 0.01}})
    assert answer.status_code == 422
    problem = answer.json()
    assert problem["type"] == "urn:ikplan:timing-failed"
    nearest = problem["nearest"]
    assert client.time({**TIMING, **nearest}).certificate.valid
    with pytest.raises(ikplan.TimingFailed) as refused:
        client.time({**TIMING, "limits": {}, "times": [0.0, 0.05], "start_velocity": None})
    times = refused.value.nearest["times"]
    kept = client.time({"robot": "ur5", "waypoints": ROWS, "times": times})
    assert kept.duration == pytest.approx(times[-1], abs=1e-9)


def test_a_plan_stands_and_tells_its_events(client: Client) -> None:
    plan = client.plan(PLAN)
    assert [event.name for event in plan.events] == ["on"]
    assert plan.objective is not None
    assert plan.objective.gain >= 0.0
    assert plan.certificate.stops == pytest.approx([plan.waypoints.time[1]])
