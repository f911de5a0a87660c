"""The hard cases of tests/vectors/timing, each with its expected outcome."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ikplan import errors
from ikplan.limits import JointLimits
from ikplan.pipeline.retime import time_request
from ikplan.timing import TimedPath, periods

from .cases import assert_keeps_limits, assert_meets_waypoints, time_and_sample

FOLDER = Path(__file__).parents[1] / "vectors" / "timing"
VECTORS = {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}
REQUESTS = {
    path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("requests/*.json"))
}
GOOD = [name for name, vector in VECTORS.items() if "duration" in vector["expect"]]
BAD = [name for name, vector in VECTORS.items() if "error" in vector["expect"]]


def run(vector: dict[str, Any]) -> TimedPath:
    fields = vector["limits"]
    names = tuple(f"joint{i}" for i in range(len(fields["lower"])))
    # JSON has no NaN and no infinity: they are written as words.
    waypoints = [[float(value) for value in row] for row in vector["waypoints"]]
    timed, _ = time_and_sample(
        waypoints,
        JointLimits(joint_names=names, **fields),
        vector.get("rate_hz", 1000.0),
        vector.get("rest_at", ()),
    )
    return timed


def test_every_vector_is_judged() -> None:
    assert len(GOOD) >= 20
    assert len(BAD) >= 10
    assert len(GOOD) + len(BAD) == len(VECTORS)


@pytest.mark.parametrize("name", GOOD)
def test_a_hard_path_is_timed_within_limits_near_its_optimum(name: str) -> None:
    vector = VECTORS[name]
    timed = run(vector)
    limits = JointLimits(
        joint_names=tuple(f"joint{i}" for i in range(len(vector["limits"]["lower"]))),
        **vector["limits"],
    )
    assert_keeps_limits(timed, limits)
    assert_meets_waypoints(timed, np.array(vector["waypoints"]))
    best = vector["expect"]["duration"]
    rate_hz = vector.get("rate_hz", 1000.0)
    assert timed.duration <= periods(best * 1.005, rate_hz) / rate_hz
    # toppra bounds accelerations at nodes only, and can be faster than limits allow by a little.
    assert timed.duration >= best * (1 - 1e-3)


@pytest.mark.parametrize("name", BAD)
def test_a_bad_input_is_refused_by_its_field(name: str) -> None:
    expected = VECTORS[name]["expect"]["error"]
    with pytest.raises(getattr(errors, expected["type"])) as error:
        run(VECTORS[name])
    assert error.value.field == expected["field"]


POWERS = {"speed": 1, "velocity": 1, "acceleration": 2, "jerk": 3}
"""By what power of time what is used of a limit falls in a slower motion."""


@pytest.mark.parametrize("name", REQUESTS)
@pytest.mark.parametrize("rate_hz", [50.0, 250.0, 1000.0])
def test_a_hard_request_is_certified_and_uses_its_limit(name: str, rate_hz: float) -> None:
    vector = REQUESTS[name]
    sampling = {**vector["request"].get("sampling", {}), "rate_hz": rate_hz}
    plan = time_request({**vector["request"], "sampling": sampling})
    assert plan.timing is not None
    for field, (least, most) in vector["expect"].items():
        # Before the motion was slowed to end at a sample.
        power = next((p for word, p in POWERS.items() if word in field), 0)
        assert getattr(plan.certificate, field) <= most
        assert least <= getattr(plan.certificate, field) * plan.timing.grid_factor**power
