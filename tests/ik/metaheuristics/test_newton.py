"""Newton-Raphson: its linear algebra, its variants, its count of evaluations."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.metaheuristics.population import Outcome
from ikplan.ik.newton_raphson import solve_least_squares
from ikplan.ik.registry import find_solver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Target, pose_target
from ikplan.robots import Robot, load_robot


@functools.cache
def eod() -> Robot:
    return load_robot("eod_arm")


def solve(target: Target, start: np.ndarray | None = None, **params: Any) -> Outcome:
    arm, solver = arm_of(eod()), find_solver("newton-raphson")
    searcher = Searcher(arm, solver, solver.check(params), 0, None, "paper")
    return searcher.run(target, eod().home if start is None else start, arm.lower, arm.upper)


def pose_of(q: np.ndarray) -> Target:
    pose = eod().fk(q)
    return pose_target(pose.translation, pose.rotation)


@settings(max_examples=60, deadline=None)
@given(
    m=st.integers(1, 6),
    columns=st.integers(1, 8),
    rank=st.integers(1, 6),
    seed=st.integers(0, 10_000),
    damping=st.sampled_from([0.0, 1e-3, 1.0]),
)
def test_steps_are_those_of_the_pseudoinverse(
    m: int, columns: int, rank: int, seed: int, damping: float
) -> None:
    rng = np.random.default_rng(seed)
    rank = min(rank, m, columns)
    J = rng.standard_normal((m, rank)) @ rng.standard_normal((rank, columns))
    e, dq = rng.standard_normal(m), np.empty(columns)
    solve_least_squares(np.ascontiguousarray(J.T), e, damping, 1e-10, dq)
    if damping > 0.0:
        expected = J.T @ np.linalg.solve(J @ J.T + damping * np.eye(m), e)
    else:
        expected = np.linalg.pinv(J, rcond=1e-10) @ e
    np.testing.assert_allclose(dq, expected, rtol=1e-6, atol=1e-7 * (1.0 + abs(expected).max()))


def test_it_converges_quadratically_from_nearby() -> None:
    q = np.array([0.3, -0.4, 0.5, 0.2, 0.6, -0.3])
    out = solve(pose_of(q), start=q + 0.05, warm="individual")
    np.testing.assert_allclose(out.x, q, atol=1e-12)
    assert out.iterations[0] <= 6
    assert out.evaluations[0] == 1 + 2 * out.iterations[0]


def test_it_starts_at_zero_and_stops_after_its_iterations() -> None:
    q = np.array([1.4, -1.2, 1.3, -1.0, 1.2, 0.9])
    out = solve(pose_of(q))
    p0 = eod().fk(np.zeros(6))
    first = np.linalg.norm(p0.translation - eod().fk(q).translation)
    assert out.history[0] >= first
    assert out.iterations[0] <= 100


def test_restarts_solve_more_poses_and_clipping_keeps_the_limits() -> None:
    rng = np.random.default_rng(0)
    configurations = [eod().random_configuration(rng) for _ in range(40)]
    single = [solve(pose_of(q)) for q in configurations]
    restarted = [solve(pose_of(q), restarts=20) for q in configurations]
    clipped = [solve(pose_of(q), limits="clip") for q in configurations]

    def solved(outcomes: list[Outcome]) -> int:
        return sum(bool(out.f[0] < 1e-9) for out in outcomes)

    assert solved(single) < solved(restarted)
    assert solved(restarted) >= 38
    assert any((np.abs(out.x) > np.pi / 2).any() for out in single)
    assert all((np.abs(out.x) <= np.pi / 2).all() for out in clipped)
    assert all((np.abs(out.x) <= np.pi).all() for out in single)


@pytest.mark.parametrize("damping", [0.0, 1e-3])
def test_a_position_needs_three_rows_only(damping: float) -> None:
    q = np.array([0.3, -0.4, 0.5, 0.2, 0.6, -0.3])
    target = pose_target(eod().fk(q).translation)
    out = solve(target, start=q + 0.1, warm="individual", damping=damping)
    assert out.f[0] < 1e-12
