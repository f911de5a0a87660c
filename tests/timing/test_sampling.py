"""Samples of a timed joint path, and how bad input is reported."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import sample_at_nodes

from .cases import time_and_sample

ROBOT = SimpleNamespace(
    lower=np.array([-1.0, -2.0]),
    upper=np.array([1.0, 2.0]),
    velocity_limit=np.array([1.0, 2.0]),
    acceleration_limit=np.array([4.0, 8.0]),
    joint_names=("shoulder", "elbow"),
)
LIMITS = JointLimits.from_robot(ROBOT)
WAYPOINTS = np.array([[0.0, 0.0], [0.9, 1.0], [-0.5, 1.9], [0.0, 0.0]])


def test_a_timed_path_visits_its_waypoints_within_limits() -> None:
    timed, result = time_and_sample(WAYPOINTS, LIMITS, 500.0)
    assert (np.diff(result.time) > 0.0).all()
    assert np.array_equal(result.q[[0, -1]], WAYPOINTS[[0, -1]])
    assert (np.abs(result.dq) <= LIMITS.velocity).all()
    assert (np.abs(result.ddq) <= LIMITS.acceleration).all()
    at_waypoints, _, _ = timed.evaluate(timed.times)
    assert np.abs(at_waypoints - WAYPOINTS).max() < 1e-12


def test_samples_are_consistent_with_their_derivatives() -> None:
    _, result = time_and_sample(WAYPOINTS, LIMITS, 10_000.0)
    h = 1e-4
    # Simpson's rule over velocities gives positions, over accelerations bounded differences.
    moved = np.cumsum(0.5 * h * (result.dq[1:-1] + result.dq[:-2]), axis=0)
    assert np.abs(moved - (result.q[1:-1] - result.q[0])).max() < 1e-6
    change = (result.dq[1:-1] - result.dq[:-2]) / h
    low = np.minimum(result.ddq[1:-1], result.ddq[:-2])
    high = np.maximum(result.ddq[1:-1], result.ddq[:-2])
    # Between two samples the path acceleration may switch once, at a node of the grid.
    outside = np.maximum(low - change, change - high)
    assert np.quantile(outside, 0.99) < 1e-2
    assert np.abs(change).max(axis=0) == pytest.approx(LIMITS.acceleration, rel=0.2)


@pytest.mark.parametrize("scale", [1.0, 0.5, 0.1])
def test_scales_slow_the_motion(scale: float) -> None:
    slow = JointLimits.from_robot(ROBOT, velocity_scale=scale, acceleration_scale=scale**2)
    (_, full), (_, scaled) = (time_and_sample(WAYPOINTS, each) for each in (LIMITS, slow))
    # Velocities by c and accelerations by c^2 is the same motion, slower by 1 / c.
    assert scaled.time[-1] == pytest.approx(full.time[-1] / scale, rel=1e-6)


@pytest.mark.parametrize(
    ("waypoints", "field", "word"),
    [
        pytest.param([[0.0, 0.0], [0.0, 2.5]], "waypoints[1][1]", "elbow", id="outside"),
        pytest.param([[-1.1, 0.0]], "waypoints[0][0]", "shoulder", id="start-outside"),
        pytest.param([[0.0, 0.0], [np.nan, 0.0]], "waypoints[1][0]", "nan", id="nan"),
        pytest.param([[0.0, np.inf]], "waypoints[0][1]", "inf", id="infinite"),
        pytest.param([[0.0, 0.0, 0.0]], "waypoints", "(n, 2)", id="three-joints"),
        pytest.param([], "waypoints", "(n, dof)", id="empty"),
        pytest.param([[]], "waypoints", "(n, dof)", id="empty-row"),
        pytest.param([0.0, 0.0], "waypoints", "(n, dof)", id="flat"),
    ],
)
def test_bad_waypoints_are_refused_by_row_and_joint(waypoints: Any, field: str, word: str) -> None:
    with pytest.raises(InvalidRequest) as error:
        JointPath.through(waypoints, LIMITS)
    assert error.value.field == field
    assert word in error.value.detail


@pytest.mark.parametrize(
    ("waypoints", "field"),
    [([[0.0] * 6, [0.0]], "waypoints[1]"), ([["a"] * 6], "waypoints[0][0]")],
)
def test_rows_that_are_no_joint_values_are_refused_by_row(waypoints: list[Any], field: str) -> None:
    with pytest.raises(InvalidRequest) as error:
        ikplan.time_path(ikplan.load_robot("ur5"), waypoints)
    assert error.value.field == field


@pytest.mark.parametrize("rate_hz", [0.0, -5.0, 1e6, float("nan")])
def test_a_rate_out_of_range_is_refused(rate_hz: float) -> None:
    with pytest.raises(InvalidRequest, match="rate_hz"):
        time_and_sample(WAYPOINTS, LIMITS, rate_hz)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"velocity": [1.0, 0.0]}, "limits.velocity[1]"),
        ({"velocity": [1.0]}, "limits.velocity"),
        ({"acceleration": [-1.0, 1.0]}, "limits.acceleration[0]"),
        ({"acceleration": [np.inf, 1.0]}, "limits.acceleration[0]"),
        ({"velocity_lower": [-1.0, 1.0]}, "limits.velocity_lower[1]"),
        ({"lower": [1.5, 0.0]}, "limits.lower[0]"),
        ({"upper": [np.nan, 1.0]}, "limits.lower[0]"),
        ({"acceleration": ["x", 1.0]}, "limits.acceleration"),
    ],
)
def test_limits_that_make_no_sense_are_refused_by_field(
    change: dict[str, list[Any]], field: str
) -> None:
    good = {
        "lower": ROBOT.lower,
        "upper": ROBOT.upper,
        "velocity": ROBOT.velocity_limit,
        "acceleration": ROBOT.acceleration_limit,
        "joint_names": ROBOT.joint_names,
    }
    with pytest.raises(InvalidRequest) as error:
        JointLimits(**(good | change))
    assert error.value.field == field


@pytest.mark.parametrize("name", ["velocity_scale", "acceleration_scale"])
@pytest.mark.parametrize("scale", [0.0, -1.0, 1.5, float("nan")])
def test_a_scale_outside_its_range_is_refused(name: str, scale: float) -> None:
    with pytest.raises(InvalidRequest) as error:
        JointLimits.from_robot(ROBOT, **{name: scale})
    assert error.value.field == f"limits.{name}"


def test_knots_alone_are_the_motion_at_its_nodes() -> None:
    timed, _ = time_and_sample(WAYPOINTS, LIMITS)
    nodes = sample_at_nodes(timed)
    assert np.array_equal(nodes.time, timed.node_times)
    assert np.isin(timed.times, nodes.time).all()
    assert np.array_equal(nodes.q[-1], WAYPOINTS[-1])
    assert (nodes.dq[[0, -1]] == 0.0).all()
