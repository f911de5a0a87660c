"""Every search as the planner's seeding method, refined or raw, whole or decoupled."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from ikplan import solve_ik
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.registry import find_solver, solvers
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.robots import Robot, load_robot

SEARCHES = [s.name for s in solvers() if s.searches]
Q = np.array([0.4, 0.7, -0.3, -1.2, 0.5, 0.9, -0.4])


@functools.cache
def iiwa() -> Robot:
    return load_robot("iiwa14")


@pytest.mark.parametrize("method", SEARCHES)
def test_refined_solutions_meet_the_pose_near_the_start(method: str) -> None:
    pose = iiwa().fk(Q)
    start = Q + 0.3
    for target in (pose, pose.translation):
        solution = solve_ik(iiwa(), target, start=start, method=method, seed=3)
        assert solution.position_error < 1e-9
        assert solution.elongation <= np.linalg.norm(Q - start) * 1.5
        again = solve_ik(iiwa(), target, start=start, method=method, seed=3)
        np.testing.assert_array_equal(again.q, solution.q)


@pytest.mark.parametrize("method", SEARCHES)
def test_raw_results_are_the_searches_own(method: str) -> None:
    pose = iiwa().fk(Q)
    raw = solve_ik(iiwa(), pose.translation, start=Q + 0.3, method=method, seed=3, refine=False)
    arm, solver = arm_of(iiwa()), find_solver(method)
    searcher = Searcher(arm, solver, solver.check({}), 3)
    outcome = searcher.run(pose_target(pose.translation), Q + 0.3, arm.lower, arm.upper)
    np.testing.assert_array_equal(raw.q, outcome.x)
    assert raw.evaluations == outcome.evaluations[0]
    assert raw.position_error == pytest.approx(outcome.f[0], abs=1e-12)
    if solver.population is not None:
        # A small budget from far away: better than chance, not solved.
        assert raw.position_error < 0.35


@pytest.mark.parametrize("method", SEARCHES)
def test_decoupled_searches_keep_the_orientation_exactly(method: str) -> None:
    pose = iiwa().fk(Q)
    raw = solve_ik(
        iiwa(), pose, start=Q + 0.2, method=method, params={"decouple": True}, refine=False
    )
    assert raw.orientation_error is not None
    assert raw.orientation_error < 1e-9


def test_a_seed_changes_the_raw_result() -> None:
    pose = iiwa().fk(Q)
    first, second = (
        solve_ik(iiwa(), pose, start=Q + 0.2, method="de-rand-1", seed=s, refine=False)
        for s in (1, 2)
    )
    assert not np.array_equal(first.q, second.q)


def test_warm_by_default_are_ik_ba_and_bat_only() -> None:
    warm = {
        s.name for s in solvers() for p in s.parameters if p.name == "warm" and p.default != "cold"
    }
    assert warm == {"ik-ba", "bat"}
