"""The geometric joint path, against SciPy, finite differences and dense samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.timing import time_joint_path

from .cases import make_limits


def random_path(seed: int, count: int = 12, dof: int = 4) -> tuple[JointPath, np.ndarray]:
    q = np.random.default_rng(seed).uniform(-2, 2, (count, dof))
    return JointPath.through(q), q


@pytest.mark.parametrize("count", [2, 3, 5, 40])
def test_a_free_path_is_the_natural_cubic_spline_over_chord_length(count: int) -> None:
    path, q = random_path(1, count)
    chords = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))])
    assert np.allclose(path.s_waypoints, chords, rtol=1e-14)
    s = np.linspace(0.0, path.length, 500)
    if count == 2:
        assert np.abs(path(s) - (q[0] + np.outer(s / path.length, q[1] - q[0]))).max() < 1e-14
        return
    reference = CubicSpline(chords, q, bc_type="natural")
    for order in range(3):
        assert np.abs(path(s, order) - reference(s, order)).max() < 1e-10


def test_derivatives_are_those_of_the_positions() -> None:
    path, _ = random_path(2)
    s = np.random.default_rng(0).uniform(0.01, path.length - 0.01, 200)
    h = 1e-5
    assert np.abs((path(s + h) - path(s - h)) / (2 * h) - path(s, 1)).max() < 1e-6
    assert np.abs((path(s + h, 1) - path(s - h, 1)) / (2 * h) - path(s, 2)).max() < 1e-4


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 12), edge=st.booleans())
def test_a_path_stays_inside_its_limits_and_meets_its_waypoints(
    seed: int, count: int, edge: bool
) -> None:
    rng = np.random.default_rng(seed)
    limits = make_limits(3, box=1.0)
    q = rng.uniform(-1, 1, (count, 3))
    if edge:
        q = np.clip(2.0 * q, -1.0, 1.0)
    path = JointPath.through(q, limits)
    s = np.linspace(0.0, path.length, 2000)
    assert np.abs(path(s)).max() <= 1.0 + 1e-14
    low, high = path.extrema()
    assert (low >= -1.0 - 1e-14).all()
    assert (high <= 1.0 + 1e-14).all()
    assert np.abs(path(path.s_waypoints) - q).max() < 1e-9
    # The first derivative is continuous at every knot.
    pieces = np.arange(len(path.s_knots) - 1)
    if len(pieces) > 1:
        before = path.derivatives(path.s_knots[1:-1], pieces[:-1])[1]
        after = path.derivatives(path.s_knots[1:-1], pieces[1:])[1]
        assert np.abs(before - after).max() < 1e-12


def test_extrema_are_those_of_dense_samples() -> None:
    for seed in range(20):
        path, _ = random_path(seed)
        dense = path(np.linspace(0.0, path.length, 200_001))
        low, high = path.extrema()
        assert (low <= dense.min(axis=0) + 1e-12).all()
        assert (high >= dense.max(axis=0) - 1e-12).all()
        assert np.abs(low - dense.min(axis=0)).max() < 1e-7
        assert np.abs(high - dense.max(axis=0)).max() < 1e-7


def test_the_use_of_limits_is_exact_between_nodes() -> None:
    for seed in range(8):
        limits = make_limits(4, seed=seed)
        path, _ = random_path(seed)
        timed = time_joint_path(path, limits)
        (span,) = timed.spans
        v_ratio, a_ratio = span.problem.limit_ratios(span.x)
        inside = np.linspace(0.0, 1.0, 41)[None] * np.diff(timed.node_times)[:, None]
        _, dq, ddq = timed.evaluate((timed.node_times[:-1, None] + inside).ravel())
        shape = (len(span.dt), 41, 4)
        v_seen = np.abs(dq.reshape(shape) / limits.velocity).max(axis=1)
        a_seen = np.abs(ddq.reshape(shape)[:, 1:-1] / limits.acceleration).max(axis=1)
        assert (v_seen <= v_ratio + 1e-9).all()
        assert (a_seen <= a_ratio + 1e-9).all()
        assert np.abs(v_seen - v_ratio).max() < 1e-2
        assert np.abs(a_seen - a_ratio).max() < 5e-2


@pytest.mark.parametrize("waypoints", [[], [[]], [0.0, 1.0], [[[0.0]]], [[np.nan]], [[np.inf]]])
def test_waypoints_that_are_no_path_are_refused(waypoints: Any) -> None:
    with pytest.raises(InvalidRequest):
        JointPath.through(waypoints)
