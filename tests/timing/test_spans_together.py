"""Many short spans, timed in one call by the compiled engine: held to toppra, span by span."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from benchmarks.timing.paths import KINDS, random_limits, random_waypoints
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import ToolLimits, sample, time_joint_path, what_if
from ikplan.timing.engines.compiled_engine import CompiledEngine
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


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "duplicates"])
@pytest.mark.parametrize("seed", range(4))
def test_the_rows_that_are_left_out_bind_nowhere(kind: str, seed: int) -> None:
    path, limits = stopping(kind, seed)
    for span in time_joint_path(path, limits).spans:
        problem = span.problem
        assert len(problem.rests) > 0
        all_rows = CompiledEngine().solve(problem.rows())
        np.testing.assert_allclose(problem.compiled_solution, all_rows, rtol=1e-9)


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "duplicates"])
def test_the_largest_ratio_of_a_span_is_that_of_its_intervals(kind: str) -> None:
    path, limits = stopping(kind, seed=5)
    for span in time_joint_path(path, limits).spans:
        problem, rng = span.problem, np.random.default_rng(len(kind))
        # Slow and fast spans, and single nodes that are far too fast.
        x = span.x * rng.uniform(0.1, 3.0) * np.where(rng.random(len(span.x)) < 0.02, 5.0, 1.0)
        v_ratio, a_ratio = problem.limit_ratios(x)
        every = np.maximum(v_ratio.max(axis=1) ** 2, a_ratio.max(axis=1))
        most = np.maximum.reduceat(every, np.concatenate([[0], problem.rests]))
        for least in (0.0, 1.0):
            kept = problem.kept(x, least)
            factor = np.repeat(np.maximum(most, least), np.diff([0, *problem.rests, len(every)]))
            assert_array_equal(kept, x / np.append(factor, factor[-1]))
        assert problem.largest_ratio(x) == most.max()


@pytest.mark.parametrize("kind", ["smooth", "walk", "scattered"])
@pytest.mark.parametrize("factor", [0.7, 1.1])
def test_a_limit_changed_is_told_as_if_every_span_were_solved_again(
    kind: str, factor: float
) -> None:
    path, limits = stopping(kind, seed=1)
    timed = time_joint_path(path, limits)
    durations = set()
    for limit in ("velocity", "acceleration"):
        for joint, name in enumerate(limits.joint_names):
            before = after = 0.0
            for span in timed.spans:
                changed = span.problem.within(span.problem.profile.scaled(limit, joint, factor))
                before += span.problem.compiled_duration
                new = changed.compiled_duration
                after += min(new, span.problem.compiled_duration) if factor > 1.0 else new
            told = what_if(timed, limit, name, factor).duration
            assert told == pytest.approx(timed.duration * after / before, rel=1e-9)
            durations.add(round(told, 9))
    assert len(durations) > len(limits.joint_names)


def _first_joint_moves_the_tool(
    _: np.ndarray, dq: np.ndarray, ddq: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    twist, change = np.zeros((2, len(dq), 6))
    twist[:, 0], change[:, 0] = dq[:, 0], ddq[:, 0]
    return twist, change


@pytest.mark.parametrize("kind", ["smooth", "walk", "near-zero moves"])
def test_a_speed_of_the_tool_bounds_spans_together_as_it_bounds_each(kind: str) -> None:
    path, limits = stopping(kind, seed=4)
    speed = 0.3 * float(limits.velocity[0])
    tool = ToolLimits(_first_joint_moves_the_tool, linear_speed=speed)
    together = time_joint_path(path, limits, constraints=[tool])
    apart = time_joint_path(path, limits, constraints=[tool], engine=ToppraEngine())
    assert len(together.spans) < len(apart.spans)
    assert together.duration <= apart.duration * (1.0 + 2e-4)
    _, dq, _ = together.evaluate(np.linspace(0.0, together.duration, 20_001))
    assert np.abs(dq[:, 0]).max() <= speed
    for span in together.spans:
        problem = span.problem
        assert problem.others.only_bound_speeds
        all_rows = CompiledEngine().solve(problem.rows())
        # On the fine grid no limit is exceeded between the points that are looked at.
        np.testing.assert_allclose(problem.compiled_solution, all_rows, rtol=1e-9)


@pytest.mark.parametrize("kind", ["smooth", "walk", "scattered"])
def test_jerk_limited_spans_are_as_short_as_each_by_itself(kind: str) -> None:
    path, limits = stopping(kind, seed=6)
    most = 20.0 * limits.acceleration
    limits = replace(limits, jerk=most)
    together = time_joint_path(path, limits)
    apart = time_joint_path(path, limits, engine=CompiledEngine())
    assert all(span.problem.sparse for span in together.spans)
    assert len(together.spans) == len(apart.spans) == len(path.rest_knots) - 1
    assert together.duration <= apart.duration * (1.0 + 1e-3)
    samples = sample(together, 2000.0)
    jerk = np.abs(np.diff(samples.ddq, axis=0)) * 2000.0 / most
    assert jerk.max() <= 1.0
    assert together.unlimited_duration <= together.duration
