"""Many short spans, timed in one call by the compiled engine: held to toppra, span by span."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from benchmarks.timing.paths import KINDS, random_limits, random_waypoints
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import time_joint_path
from ikplan.timing.engines.toppra_engine import ToppraEngine
from ikplan.timing.timed_path import TimedPath


def stopping(kind: str, seed: int, count: int = 40) -> tuple[JointPath, JointLimits]:
    """A path that stops at every waypoint."""
    rng = np.random.default_rng(seed)
    limits = random_limits(rng, 4)
    q = random_waypoints(rng, kind, count, limits.lower, limits.upper, fill=bool(seed % 2))
    return JointPath.through(q, limits, rest_at=range(len(q))), limits


def spans_of(timed: TimedPath) -> np.ndarray:
    """Durations between the rests."""
    return np.diff(timed.times_at(timed.path.s_knots[list(timed.path.rest_knots)]))


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "duplicates"])
def test_the_motion_is_no_longer_than_by_toppra_span_by_span(kind: str) -> None:
    path, limits = stopping(kind, seed=len(kind))
    together = time_joint_path(path, limits)
    apart = time_joint_path(path, limits, engine=ToppraEngine())
    assert len(together.spans) < len(apart.spans) == len(path.rest_knots) - 1
    assert together.duration <= apart.duration * (1.0 + 2e-5)
    assert (spans_of(together) <= spans_of(apart) * (1.0 + 1e-3)).all()


@pytest.mark.parametrize("kind", ["smooth", "walk", "near-zero moves"])
def test_every_limit_is_kept_and_the_motion_rests_where_it_should(kind: str) -> None:
    path, limits = stopping(kind, seed=3)
    timed = time_joint_path(path, limits)
    assert len(timed.stop_times) == len(path.rest_knots) - 2
    rests = timed.times_at(path.s_knots[list(path.rest_knots)])
    assert_array_equal(timed.evaluate(rests)[1], 0.0)
    t = np.linspace(0.0, timed.duration, 20_001)
    _, dq, ddq = timed.evaluate(t)
    assert np.maximum(dq / limits.velocity, dq / limits.velocity_lower).max() <= 1.0
    assert np.maximum(ddq / limits.acceleration, ddq / limits.acceleration_lower).max() <= 1.0


def test_the_same_grid_gives_the_same_speeds_by_toppra() -> None:
    path, limits = stopping("scattered", seed=2)
    for span in time_joint_path(path, limits).spans:
        problem = span.problem
        ends = [0, *problem.rests.tolist(), len(problem.h)]
        rows = problem.rows()
        found = problem.solve(ToppraEngine())
        assert_array_equal(rows.x_max[problem.rests], 0.0)
        ours = problem.compiled_solution
        for a, b in itertools.pairwise(ends):
            most = ours[a : b + 1].max()
            np.testing.assert_allclose(found[a : b + 1], ours[a : b + 1], atol=1e-6 * most)
