"""Our own moves: the search alone, with its shortening, and whole plans."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import ikplan
from benchmarks.collision.oracle import Oracle
from benchmarks.moves.problems import Problem, checker_of, model_of
from ikplan.certificate.clearance import JointCurve, prove_clearance
from ikplan.collision.check import ContactArrays
from ikplan.errors import InCollision
from ikplan.planning.moves.connect import connect, is_free
from ikplan.planning.moves.shorten import path_length, shorten
from ikplan.planning.moves.space import search_space
from ikplan.robots import Robot

__all__ = ["Runs", "least_distance", "left_out", "plan_runs", "proof_times", "search_runs"]

Array = NDArray[np.float64]
EFFORT, SHORTCUTS = 20_000, 100
_WARM_UP = 5
"""Problems that are searched once before any is timed."""
STEP = 5e-4
"""Joint step at which a finished motion is looked at by coal [rad]."""


@dataclass
class Runs:
    """What became of many runs; times are processor times.

    Attributes:
        solved: Whether each was solved.
        search: Time until there was a way [ms].
        shortened: Time until it was shortened, the search included [ms].
        found_length: Joint distance of the way found [rad].
        length: That of the shortened one [rad].
    """

    solved: list[bool] = field(default_factory=list)
    search: list[float] = field(default_factory=list)
    shortened: list[float] = field(default_factory=list)
    found_length: list[float] = field(default_factory=list)
    length: list[float] = field(default_factory=list)


def left_out(robot: Robot, problem: Problem) -> tuple[str, str] | None:
    """Return the pair that the start or the goal of a problem holds in contact, or None."""
    pairs = checker_of(robot, problem).pairs_in_contact(np.vstack([problem.start, problem.goal]))
    return next((pair for pair in pairs if pair is not None), None)


def _search(arrays: ContactArrays, robot: Robot, problem: Problem, seed: int, runs: Runs) -> None:
    goals, w = problem.goal[None], arrays.scratch
    rng, cut = np.random.default_rng([seed, 0]), np.zeros(1, dtype=np.bool_)
    begin = time.process_time()
    space = search_space(arrays, robot.lower, robot.upper, problem.start, goals)
    if is_free(space, problem.start, problem.goal, w):
        path = np.vstack([problem.start, problem.goal])
    else:
        path, _ = connect(space, problem.start, goals, EFFORT, rng, cut, w)
    found = time.process_time()
    runs.solved.append(len(path) > 0)
    runs.search.append(1e3 * (found - begin))
    if len(path) == 0:
        return
    shorter = shorten(space, path, SHORTCUTS, rng, w)
    runs.shortened.append(1e3 * (time.process_time() - begin))
    runs.found_length.append(float(path_length(path)))
    runs.length.append(float(path_length(shorter)))


def search_runs(robot: Robot, problems: list[Problem], seeds: int) -> Runs:
    """Search for a way in every problem, without timing and proof of the timed motion."""
    runs = Runs()
    for problem in problems[:_WARM_UP]:  # compiles
        _search(checker_of(robot, problem).arrays(None), robot, problem, 0, Runs())
    if problems:
        arrays = checker_of(robot, problems[0]).arrays(None)
        space = search_space(
            arrays, robot.lower, robot.upper, problems[0].start, problems[0].goal[None]
        )
        rng, cut = np.random.default_rng(0), np.zeros(1, dtype=np.bool_)
        connect(space, problems[0].start, problems[0].goal[None], 10, rng, cut, arrays.scratch)
    for problem in problems:
        arrays = checker_of(robot, problem).arrays(None)
        for seed in range(seeds):
            _search(arrays, robot, problem, seed, runs)
    return runs


def proof_times(robot: Robot, problems: list[Problem], plans: list[ikplan.Plan]) -> list[float]:
    """Return the processor time of the proof of each plan's timed motion [ms]."""
    spent = []
    for problem, plan in zip(problems, plans, strict=True):
        model, trajectory = model_of(robot, problem), plan.trajectory
        begin = time.process_time()
        curve = (
            JointCurve.of_motion(plan.motion)
            if plan.motion is not None
            else JointCurve.of_samples(
                np.asarray(trajectory.time), np.asarray(trajectory.q), np.asarray(trajectory.dq)
            )
        )
        prove_clearance(robot, model, curve)
        spent.append(1e3 * (time.process_time() - begin))
    return spent


def plan_runs(
    name: str | Robot,
    problems: list[Problem],
    seed: int,
) -> tuple[list[ikplan.Plan], list[str]]:
    """Plan every problem; return the plans and the names of those not solved."""
    plans, failed = [], []
    for problem in problems:
        try:
            plan = ikplan.move(
                name, problem.start, problem.goal, problem.scene,
                fixed_joints=problem.fixed_joints, seed=seed, budget_s=600.0,
            )  # fmt: skip
        except InCollision as verdict:
            failed.append(f"{problem.name}: {verdict}")
            continue
        plans.append(plan)
    return plans, failed


def least_distance(robot: Robot, problem: Problem, plan: ikplan.Plan) -> float:
    """Return the least distance of a plan by coal, at steps of 0.0005 rad [m]; 0 in contact."""
    trajectory = plan.trajectory
    curve = JointCurve.of_samples(
        np.asarray(trajectory.time), np.asarray(trajectory.q), np.asarray(trajectory.dq)
    )
    return float(Oracle(robot, model_of(robot, problem)).least(curve, STEP).min())
