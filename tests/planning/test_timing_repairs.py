"""Repairs of motions without a timing: limits, and whatever else makes the request plannable."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan import Robot, TimingFailed, load_robot
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline import motion_stages
from ikplan.pipeline.retime import time_request
from ikplan.pipeline.timing_stage import move_along
from ikplan.planning.repair_kinds import merged_document

UR5 = load_robot("ur5")
START = [0.0, -1.0, 1.2, -1.7, -1.57, 0.0]
LINE = {
    "robot": "ur5",
    "start": START,
    "path": {
        "waypoints": [{"position": np.add(UR5.fk(START).translation, [0.0, 0.15, 0.0]).tolist()}],
        "interpolation": "line",
    },
}


def refused(request: Mapping[str, Any]) -> TimingFailed:
    with pytest.raises(TimingFailed) as caught:
        ikplan.plan(request)
    return caught.value


def heavy(mass: float) -> dict[str, Any]:
    return {**LINE, "limits": {"torque": True, "payload": {"mass": mass}}}


def test_what_is_too_heavy_is_offered_lighter_and_every_repair_plans() -> None:
    request = heavy(40.0)
    error = refused(request)
    assert error.limit == "torque"
    assert error.repairs[0]["change"]["limits"]["payload"]["mass"] == 8.0
    assert error.repairs[0]["detail"] == "carry 8 kg instead of 40 kg"
    for repair in error.repairs:
        plan = ikplan.plan(merged_document(request, repair["change"]))
        assert plan.certificate.valid
        assert plan.certificate.torque_limit_ratio is not None
    refused(heavy(20.0))  # the next heavier one that was tried


def test_torque_limits_of_ones_own_that_cannot_hold_the_arm_are_offered_as_the_robots() -> None:
    error = refused({**LINE, "limits": {"torque": [50.0, 1.0, 50.0, 50.0, 50.0, 50.0]}})
    assert {"limits": {"torque": True}} in [r["change"] for r in error.repairs]


def test_a_timing_offers_repairs_of_its_limits() -> None:
    request = {
        "robot": "ur5",
        "waypoints": [START, np.add(START, 0.2).tolist()],
        "limits": {"torque": True, "payload": {"mass": 40.0}},
    }
    with pytest.raises(TimingFailed) as caught:
        time_request(request)
    (repair,) = [r for r in caught.value.repairs if "payload" in r["change"]["limits"]]
    again = time_request(merged_document(request, repair["change"]))
    assert again.certificate.valid


@pytest.mark.parametrize(
    ("asked", "passes", "offered"),
    [
        (None, 0.15, 0.1),
        (0.3, 0.07, 0.06),
        ({"linear": 0.3, "angular": 2.0}, 0.07, {"linear": 0.06, "angular": 0.4}),
        (None, 0.001, None),
    ],
)
def test_a_smaller_tool_speed_is_offered_where_it_has_a_timing(
    asked: Any, passes: float, offered: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if no timing were found for anything faster."""
    tried: list[float] = []

    def slow_only(path: Any, robot: Robot, limits: MotionLimits, *more: Any) -> Any:
        tried.append(limits.tool_speed[0])
        if limits.tool_speed[0] > passes:
            raise TimingFailed("no path speed found", position=0.5, limit="acceleration")
        return move_along(path, robot, limits, *more)

    monkeypatch.setattr(motion_stages, "move_along", slow_only)
    request = LINE if asked is None else {**LINE, "limits": {"tool_speed": asked}}
    error = refused(request)
    speeds = [r["change"]["limits"]["tool_speed"] for r in error.repairs if "limits" in r["change"]]
    assert speeds == ([] if offered is None else [pytest.approx(offered)])
    count = len(tried)
    refused(request)
    assert len(tried) == 2 * count  # a fixed number of attempts


def test_no_repair_of_a_timing_is_asked_of_the_clock() -> None:
    assert refused(heavy(40.0)).repairs == refused({**heavy(40.0), "budget_s": 60.0}).repairs
