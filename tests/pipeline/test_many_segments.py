"""What a path of many arcs and lines costs under jerk limits, counted: every span is timed once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.pipeline import motion_stages, timing_stage
from ikplan.robots import load_robot
from ikplan.timing import limit_jerk
from ikplan.timing.time_joint_path import time_before_jerk

SHAPES = 17


def outlines() -> dict[str, Any]:
    """Outlines as a G-code program draws them: two lines, an arc by its centre, a line back."""
    segments: list[dict[str, Any]] = []

    def to(x: float, y: float) -> dict[str, Any]:
        return {"position": [x, y, 0.3], "quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}

    for k in range(SHAPES):
        row, column = divmod(k, 6)
        x = 0.36 + 0.02 * (column if row % 2 == 0 else 5 - column)
        y = -0.1 + 0.03 * row
        segments.append({"type": "line", "to": to(x, y)})
        segments.append({"type": "line", "to": to(x + 0.012, y)})
        centre, end = [x + 0.012, y + 0.006, 0.3], to(x + 0.012, y + 0.012)
        half = {"type": "arc", "centre": centre, "axis": [0.0, 0.0, 1.0], "to": end}
        segments.append({**half, "limits": {"tool_speed": 0.02}})
        segments.append({"type": "line", "to": to(x, y + 0.012)})
    begin = to(0.36, -0.12)
    return {
        "robot": "ur5",
        "start": "free",
        "path": {"begin": begin, "segments": segments},
        "limits": {"tool_speed": 0.05, "jerk": 200.0},
        "sampling": {"rate_hz": 100.0},
        "scene": {"self_collision": False},
    }


def counted(monkeypatch: pytest.MonkeyPatch, counts: Counter[str], module: Any, name: str) -> None:
    """Count the calls of a function of a module from now on."""
    function: Callable[..., Any] = getattr(module, name)

    def call(*arguments: Any, **more: Any) -> Any:
        counts[name] += 1
        return function(*arguments, **more)

    monkeypatch.setattr(module, name, call)


def test_each_way_is_timed_once_and_the_longer_ones_are_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """dexarmcontroller's walle.gcode is of this kind; its first 600 moves take a few seconds."""
    counts: Counter[str] = Counter()
    counted(monkeypatch, counts, motion_stages, "plan_joint_path")
    counted(monkeypatch, counts, motion_stages, "move_along")
    counted(monkeypatch, counts, limit_jerk, "smooth_span")
    timed: list[int] = []

    def noted(*arguments: Any, **more: Any) -> Any:
        found = time_before_jerk(*arguments, **more)
        timed.append(len(found.spans))
        return found

    monkeypatch.setattr(timing_stage, "time_before_jerk", noted)
    plan = ikplan.plan(outlines())
    assert plan.certificate.valid
    ways = counts["plan_joint_path"]
    assert 2 <= len(timed) == ways <= 3
    assert 1 <= counts["move_along"] <= ways
    # One way is smoothed whole; of the others only what it takes to know that they are longer.
    spans = len(plan.certificate.stops) + 1
    assert spans in timed
    assert spans <= counts["smooth_span"] < sum(timed)
    # The arcs bulge by their radius beyond the lines.
    _, p = load_robot("ur5").poses(np.array(plan.q))
    assert abs(p[:, 0].max() - (0.36 + 0.02 * 5 + 0.012 + 0.006)) < 1e-4


def test_the_way_that_is_taken_is_the_shortest_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    request = outlines()
    quick = ikplan.plan(request)
    durations = []

    def unbounded(timed: Any, check: Any, _: float) -> Any:
        found = limit_jerk.limit_jerk(timed, check)
        durations.append(found.duration)
        return found

    monkeypatch.setattr(timing_stage, "limit_jerk", unbounded)
    slow = ikplan.plan(request)
    assert len(durations) > 1
    assert quick.duration == slow.duration
    np.testing.assert_array_equal(quick.q, slow.q)
    period = 1.0 / 100.0
    assert min(durations) <= quick.duration <= min(durations) * (1.0 + 1e-6) + period
