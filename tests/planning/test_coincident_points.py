"""Paths that lead nowhere, in part or as a whole: a certified plan, or a clear refusal."""

from __future__ import annotations

import contextlib
import itertools
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import InvalidRequest, Plan

from . import near_empty as made

SIZES = (0.0, 1e-13, 1e-12, 2e-12, 3e-12, 1e-11, 1e-10, 1e-9, 2e-9, 1e-8)
LIMITS: tuple[dict[str, Any] | None, ...] = (
    None,
    {"tool_speed": 0.05},
    {"velocity_scale": 0.3, "tool_speed": {"angular": 0.2}},
    {"jerk": 300.0},
)
OUT, BACK = {"type": "line", "to": made.FAR}, {"type": "line", "to": made.HERE}
PLACES = {
    "alone": ([], []),
    "first": ([], [OUT]),
    "middle": ([OUT, BACK], [OUT]),
    "last": ([OUT, BACK], []),
}
POINTS = ("arc through", "arc of a small", "small circle")
"""What makes no path where its points coincide, and is refused then."""
POINT = "coincide|a point, not a path|on its own axis|an angle other than 0|its radius of"


def check(plan: Plan, request: dict[str, Any]) -> None:
    """The laws of every plan that a path of no length must not break."""
    assert np.array_equal(plan.q[-1], plan.waypoints.q[-1])
    assert np.array_equal(plan.dq[[0, -1]], np.zeros((2, 6)))
    if request["start"] != "free":
        assert np.array_equal(plan.q[0], request["start"])
    assert plan.time[0] == 0.0
    assert (np.diff(plan.time) > 0.0).all()
    passed = np.concatenate([[0.0], plan.waypoints.time])
    assert (np.diff(passed) >= 0.0).all()
    assert passed[-1] == pytest.approx(plan.time[-1], rel=1e-9)
    # Between waypoints the joints do not move faster than they may.
    steps = np.abs(np.diff(plan.waypoints.q, axis=0))
    times = np.diff(plan.waypoints.time)[:, None]
    assert (steps <= made.ROBOT.velocity_limit * times * (1.0 + 1e-6) + 1e-9).all()
    segments = request["path"].get("segments", [])
    limited = [f"path.segments[{k}]" for k, s in enumerate(segments) if "limits" in s]
    assert [row.field for row in plan.certificate.segments] == limited
    assert all(0.0 <= row.begin <= row.end for row in plan.certificate.segments)


def parts_and_sizes() -> list[tuple[str, float]]:
    """Every part at the threshold, and half of the rest: no part and no size is left out."""
    every = list(itertools.product(made.parts(1e-9), SIZES))
    drawn = set(random.Random(1).sample(every, len(every) // 2))
    assert {name for name, _ in drawn} == set(made.parts(1e-9))
    assert {size for _, size in drawn} == set(SIZES)
    return [case for case in every if case in drawn or case[1] == 1e-9]


@pytest.mark.parametrize(("name", "size"), parts_and_sizes())
def test_a_part_that_leads_nowhere_is_planned_or_refused_clearly(name: str, size: float) -> None:
    # Every place, with each of limits, starts and forms in turn.
    number = SIZES.index(size) * 7 + list(made.parts(size)).index(name)
    place = list(PLACES)[number % 4]
    before, after = PLACES[place]
    limits = LIMITS[number // 4 % 4]
    start = made.STARTS[number // 3 % 3]
    own = [s if limits is None else {**s, "limits": limits} for s in made.parts(size)[name]]
    path: dict[str, Any] = {"segments": [*before, *own, *after]}
    if number % 5 == 0:
        path["orientation_free"] = {"about": "tool_z", "cone": 0.05}
    document = made.request(path, start, made.FORMS[number // 5 % 4])
    # Of a length that is just the threshold, rounding tells.
    # An arc through points that are nearly in line is a line.
    microscopic = name == "arc of a small radius" or (name == "arc through" and size > 5e-9)
    if microscopic or (name.startswith(POINTS) and size <= 1e-9):
        refusal = pytest.raises(InvalidRequest, match=POINT)
        with contextlib.suppress(InvalidRequest) if size == 1e-9 and not microscopic else refusal:
            check(ikplan.plan(document), document)
    else:
        check(ikplan.plan(document), document)


WAYPOINTS: dict[str, Callable[[Any], list[Any]]] = {
    "one": lambda w: [w],
    "two alike": lambda w: [w, w],
    "out and back": lambda w: [w, made.FAR, w],
    "in the middle": lambda w: [made.FAR, made.HERE, w, made.FARTHER],
    "all about one": lambda w: [made.HERE, w, made.HERE, w],
}
POSES = {
    **{f"{size:g} m": made.near(size, 5) for size in (0.0, 1e-12, 1e-10, 1e-9, 2e-9, 1e-8)},
    **{f"{digits} digits": made.rounded(digits) for digits in (8, 9, 11, 13, 15)},
}


@pytest.mark.parametrize("interpolation", ["joint", "line", "spline"])
@pytest.mark.parametrize("pose", POSES)
def test_waypoints_at_one_place_are_planned(pose: str, interpolation: str) -> None:
    # Every order, with each of starts, forms and limits in turn.
    first = list(POSES).index(pose)
    for number, order in enumerate(WAYPOINTS.values(), first):
        path = {"waypoints": order(POSES[pose]), "interpolation": interpolation}
        document = made.request(path, made.STARTS[number % 3], made.FORMS[number % 4])
        if number % 2:
            document["limits"] = {"jerk": 300.0}
        check(ikplan.plan(document), document)


@pytest.mark.parametrize("size", [1e-13, 1e-11, 5e-10, 2e-9])
def test_many_small_steps_in_one_direction_are_a_way(size: float) -> None:
    """Points are compared with where the path has got to, and not each with the one before."""
    count = 60
    waypoints = [made.pose(made.moved([0.0, 0.0, size * k])) for k in range(1, count + 1)]
    document = made.request(
        {
            "waypoints": waypoints,
            "interpolation": "line",
            "corners": "exact",
            "tolerance": {"position": 1e-8},
        },
        "given",
        {"form": "samples"},
    )
    plan = ikplan.plan(document)
    check(plan, document)
    z = [made.ROBOT.fk(q).translation[2] - made.T0.translation[2] for q in plan.waypoints.q]
    asked = size * np.arange(1, count + 1)
    assert np.abs(np.array(z) - asked).max() <= 1e-9 + 2e-10


def test_a_segment_to_where_the_arm_is_has_a_row_without_figures() -> None:
    own = {"type": "line", "to": made.HERE, "limits": {"tool_speed": 0.1}}
    alone = ikplan.plan(made.request({"segments": [own]}, "given", {}))
    assert alone.time.tolist() == [0.0]
    between = ikplan.plan(made.request({"segments": [OUT, BACK, own, OUT]}, "given", {}))
    (row,) = between.certificate.segments
    assert row.begin == row.end == between.waypoints.time[1] == between.waypoints.time[2]
    assert row.tool_speed_ratio is None
    # What leads nowhere takes no time and changes nothing of the rest.
    without = ikplan.plan(made.request({"segments": [OUT, BACK, OUT]}, "given", {}))
    assert np.array_equal(between.time, without.time)
    assert np.array_equal(between.q, without.q)


def test_a_way_that_is_longer_than_the_threshold_is_gone() -> None:
    for size in (2e-9, 1e-8, 1e-6):
        to = made.near(size, 3)
        plan = ikplan.plan(
            made.request({"segments": [{"type": "line", "to": to}]}, "given", {"rate_hz": 1000.0})
        )
        T = made.ROBOT.fk(plan.q[-1])
        assert plan.time[-1] > 0.0
        assert np.linalg.norm(T.translation - np.array(to["position"])) < 1e-12
        assert np.linalg.norm(pin.log3(T.rotation.T @ made.T0.rotation)) < 1e-11


@pytest.mark.parametrize("limits", [{"acceleration_scale": 0.1}, {"tool_acceleration": 0.05}])
@pytest.mark.parametrize("place", ["first", "last"])
def test_limits_of_a_segment_that_leads_nowhere_hold_nowhere(
    place: str, limits: dict[str, Any]
) -> None:
    own = {"type": "line", "to": made.HERE, "limits": limits}
    before, after = PLACES[place]
    document = made.request({"segments": [*before, own, *after]}, "given", {})
    plan = ikplan.plan(document)
    check(plan, document)
    without = ikplan.plan(made.request({"segments": [*before, *after]}, "given", {}))
    assert np.array_equal(plan.q, without.q)
    (row,) = plan.certificate.segments
    assert row.begin == row.end
    assert row.acceleration_limit_ratio is None
    assert row.tool_acceleration_ratio is None
