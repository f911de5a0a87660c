"""Waypoints of a joint path that coincide, or nearly: merged, and everything stays consistent."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from ikplan.joint_path import JointPath

START = np.array([0.4, -1.2, 1.5, -0.8, -1.2, 0.3])
STEP = np.array([0.3, -0.2, 0.25, 0.1, -0.15, 0.2])
ASIDE = np.array([0.1, 0.3, -0.2, 0.2, 0.1, -0.3])
SIZES = (0.0, 1e-16, 1e-13, 1e-12, 1e-11, 3e-11, 1e-10, 1e-9, 1e-8)
FORMS: tuple[dict[str, Any], ...] = (
    {"form": "samples"},
    {"form": "knots"},
    {"form": "polynomial"},
    {"rate_hz": 1000.0},
)
LIMITS: tuple[dict[str, Any], ...] = (
    {"velocity_scale": 0.2},
    {"tool_speed": 0.05},
    {"jerk": 200.0},
    {"tool_speed": {"angular": 0.1}, "velocity_scale": 0.5},
)

steps = st.sampled_from([0.0, 1e-17, 1e-13, 2e-11, 1e-10, 1.1e-10, 5e-10, 1e-7, 1.0])


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), sizes=st.lists(steps, min_size=1, max_size=12))
def test_knots_and_waypoints_stay_consistent_whatever_is_merged(
    seed: int, sizes: list[float]
) -> None:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(len(sizes), 3)) / np.sqrt(3.0)
    directions *= rng.choice([-1.0, 1.0], size=(len(sizes), 1))
    q = np.cumsum(np.vstack([np.zeros(3), directions * np.array(sizes)[:, None]]), axis=0)
    path = JointPath.through(q)
    knots, of = path.q_knots, path.knot_of_waypoint
    assert np.array_equal(knots[0], q[0])
    assert np.array_equal(knots[-1], q[-1])
    assert (np.diff(path.s_knots) > 0.0).all()
    assert of[0] == 0
    assert of[-1] == len(knots) - 1
    assert set(np.diff(of)) <= {0, 1}
    steps_between = np.linalg.norm(np.diff(q, axis=0), axis=1)
    smallest = 1e-10 * steps_between.sum()
    assert np.linalg.norm(knots[of] - q, axis=1).max() <= 2.0 * smallest
    # Knots that are left are apart, but for the first and the last of the whole path.
    if len(knots) > 2:
        assert np.linalg.norm(np.diff(knots, axis=0), axis=1).min() > smallest * (1.0 - 1e-9)
    # However small it is, a path that goes anywhere has a direction of about length 1.
    s = np.linspace(0.0, path.length, 50)
    assert np.isfinite(path(s, 1)).all()


def check(plan: ikplan.Plan, waypoints: np.ndarray) -> None:
    assert np.array_equal(plan.q[0], waypoints[0])
    assert np.array_equal(plan.q[-1], waypoints[-1])
    assert np.array_equal(plan.q[-1], plan.waypoints.q[-1])
    assert np.abs(plan.waypoints.q - waypoints).max() < 1e-9
    assert plan.waypoints.time[0] == 0.0
    assert (np.diff(plan.waypoints.time) >= 0.0).all()
    assert plan.waypoints.time[-1] == pytest.approx(plan.time[-1], rel=1e-9)
    assert plan.certificate.velocity_limit_ratio <= 1.0 + 1e-9
    assert plan.certificate.acceleration_limit_ratio <= 1.0 + 1e-9


def orders(size: float) -> dict[str, list[np.ndarray]]:
    """Waypoints of which two or more are so far apart [rad], and which those are."""
    near = START + size * np.array([0.5, -0.3, 0.2, 0.4, -0.6, 0.3])
    far, farther = START + STEP, START + ASIDE
    return {
        "alone": [START, near],
        "all about one": [START, near, START, near],
        "first": [START, near, far, farther],
        "middle": [farther, START, near, far],
        "last": [farther, far, START, near],
        "back": [START, far, near],
    }


# Which waypoints of each order a part is between that leads nowhere.
PARTS = {
    "alone": (0, 1),
    "all about one": (1, 2),
    "first": (0, 1),
    "middle": (1, 2),
    "last": (2, 3),
}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("order", orders(0.0))
def test_a_joint_path_with_coincident_waypoints_is_timed(order: str, size: float) -> None:
    waypoints = np.array(orders(size)[order])
    for number, sampling in enumerate(FORMS, SIZES.index(size)):
        segments = []
        if order in PARTS:
            first, last = PARTS[order]
            limits = LIMITS[number % 4]
            segments = [{"first": first, "last": last, "limits": limits}]
        document = {
            "robot": "ur5",
            "waypoints": waypoints.tolist(),
            "sampling": sampling,
            "segments": segments,
            "rest_at": [1] if number % 3 == 0 else [],
            "limits": {"jerk": 300.0} if number % 5 == 0 else {},
        }
        plan = ikplan.time_request(document)
        check(plan, waypoints)
        assert len(plan.certificate.segments) == len(segments)


def test_a_piece_that_is_short_beside_its_path_keeps_the_limits_at_its_nodes() -> None:
    """Places on it are rounded to a millionth of it, and the curvature at them as much."""
    rng = np.random.default_rng(4)
    for _ in range(25):
        ends = START + 0.1 * rng.normal(size=(2, 6))
        near = START + 4e-11 * rng.normal(size=6)
        document = {
            "robot": "ur5",
            "waypoints": [ends[0].tolist(), START.tolist(), near.tolist(), ends[1].tolist()],
            "sampling": {"form": "knots"},
        }
        check(ikplan.time_request(document), np.array(document["waypoints"]))
