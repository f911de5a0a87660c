"""A path of many corners is never slower than with stops at them, and stops only where it gains."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.documents.path import PathRequest
from ikplan.pipeline.corner_stops.corner_times import CornerTimes, gaining_stops, stops_may_gain
from ikplan.pipeline.corner_stops.exact_corners import stopping_at, stops_allowed

CORNERS = 80


def poses(turn: float) -> list[dict[str, Any]]:
    """A zigzag; at every fourth one the tool turns back about its axis by ``turn``."""
    found = []
    for k in range(CORNERS + 2):
        row, column = divmod(k, 12)
        x = column if row % 2 == 0 else 11 - column
        half = 0.5 * turn * (1 if (k // 4) % 2 else -1)
        # Turned about z, and pointing down.
        q = [float(np.cos(half)), float(np.sin(half)), 0.0, 0.0]
        p = [0.40 + 0.012 * x, -0.15 + 0.03 * row + 0.006 * (k % 2), 0.30]
        found.append({"position": p, "quaternion_xyzw": q})
    return found


@functools.cache
def planned(turn: float, jerk: float | None = None, **path: Any) -> ikplan.Plan:
    request = {"robot": "ur5", "start": "free", "limits": {"jerk": jerk}}
    lines = {"waypoints": poses(turn), "interpolation": "line", **path}
    return ikplan.plan({**request, "path": lines})


@pytest.mark.parametrize("jerk", [None, 100.0])
def test_many_corners_turned_in_small_balls_take_no_longer_than_stops(jerk: float | None) -> None:
    exact = planned(0.6, jerk, corners="exact")
    blended = planned(0.6, jerk, blend=5e-4)
    assert len(exact.certificate.stops) == CORNERS
    assert blended.duration <= exact.duration
    if jerk is None:  # the corners between turns are passed, which gains more than all stops
        assert blended.duration < 0.97 * exact.duration
        assert 0 < len(blended.certificate.stops) < CORNERS


def test_segments_stop_at_the_blends_that_are_slower_and_waypoints_at_the_same() -> None:
    begin, *ends = poses(0.6)
    segments = [{"type": "line", "to": end, "blend": 5e-4} for end in ends]
    segments[-1]["blend"] = 0.0
    document = {"segments": segments, "begin": begin}
    plan = ikplan.plan({"robot": "ur5", "start": "free", "path": document})
    same = planned(0.6, blend=5e-4)
    assert plan.duration == pytest.approx(same.duration, abs=0.01)
    assert len(plan.certificate.stops) == len(same.certificate.stops) > 0


@pytest.mark.parametrize("path", [{}, {"blend": 5e-4}])
def test_corners_that_are_faster_rounded_stay_rounded(path: dict[str, Any]) -> None:
    plan = planned(0.0, **path)
    assert not plan.certificate.stops
    assert plan.duration < 0.9 * planned(0.0, corners="exact").duration


def test_stops_are_made_where_another_motion_is_faster_for_them() -> None:
    rows, never = np.arange(4), np.zeros(4, dtype=bool)
    rounded = CornerTimes(rows, np.array([1.0, 1.0, 1.0, 1.0]), never)
    other = CornerTimes(rows, np.array([0.9, 1.2, 0.8, 0.5]), np.array([True, True, True, False]))
    assert gaining_stops(rounded, [other]) == {0, 2}
    slight = CornerTimes(rows, np.array([0.97, 1.2, 1.0, 0.5]), other.stopped)
    assert gaining_stops(rounded, [slight]) == frozenset()


def test_stops_are_tried_only_where_they_may_gain() -> None:
    passed = np.array([1.0, 1.0, 1.0])
    assert not stops_may_gain(passed, passed + 0.1, 3.0)
    assert stops_may_gain(passed, passed - 0.001, 3.0)
    assert stops_may_gain(passed, np.array([0.9, 2.0, 2.0]), 3.0)
    assert not stops_may_gain(passed, np.array([0.99, 2.0, 2.0]), 3.0)


def test_a_path_that_stops_keeps_its_rows_and_its_other_corners() -> None:
    lines = PathRequest.model_validate(
        {"waypoints": poses(0.1)[:5], "interpolation": "line", "blend": 1e-3}
    )
    free = stopping_at(lines, {2}, start_free=True)
    assert free.begin == (lines.waypoints or [])[0]
    assert [s.model_dump()["blend"] for s in free.segments or []] == [None, 0.0, None, None]
    held = stopping_at(lines, {2}, start_free=False)
    assert [s.model_dump()["blend"] for s in held.segments or []] == [None, None, 0.0, None, None]
    assert free.blend == held.blend == 1e-3


def test_a_corner_to_a_joint_motion_or_without_a_blend_is_not_stopped_at() -> None:
    to = [{"type": "line", "to": pose} for pose in poses(0.1)[:4]]
    document = {
        "segments": [{**to[0], "blend": 0.0}, {**to[1], "blend": 1e-3}, to[2], to[3]],
        "corners": "exact",
    }
    assert stops_allowed(PathRequest.model_validate(document)) == {1}
    rounded = {**document, "corners": "tolerance"}
    assert stops_allowed(PathRequest.model_validate(rounded)) == {1, 2}
    document["segments"] = [{**to[0], "blend": 1e-3}, {"type": "joint", "q": [0.0] * 6}]
    assert stops_allowed(PathRequest.model_validate(document)) == frozenset()
