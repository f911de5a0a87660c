"""One run of one solver on one target, with a fixed number of evaluations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ikplan.arena.objective import searcher_of
from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest
from ikplan.ik.metaheuristics.population import Outcome
from ikplan.ik.registry import find_solver
from ikplan.ik.solve import pose_distance
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Target
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["Entrant", "Run", "run_once"]


class Entrant(NamedTuple):
    """A solver with its parameters, as it enters.

    Attributes:
        label: What tables call it.
        method: Name of the solver.
        params: Its parameters.
        population: N; None: that of its paper.
    """

    label: str
    method: str
    params: Mapping[str, Any]
    population: int | None


class Run(NamedTuple):
    """What one run found.

    Attributes:
        value: Best value of the objective.
        position_error: Distance of the best configuration from the target [m].
        orientation_error: Rotation there [rad]; NaN: none counts.
        motion: Distance of the joint values from the start, 2-norm [rad or m].
        evaluations: Candidates evaluated.
        steps: Evaluations at which the best value is known, shape (k,).
        values: Best value there, shape (k,).
    """

    value: float
    position_error: float
    orientation_error: float
    motion: float
    evaluations: int
    steps: Indices
    values: Array


def _seed(seed: int, k: int) -> int:
    """Return the seed of one run: the same for every solver."""
    return int(np.random.SeedSequence([seed, k]).generate_state(1, np.uint64)[0] >> np.uint64(1))


def run_once(
    robot: Robot,
    entrant: Entrant,
    target: Target,
    start: Array,
    seed: int,
    k: int,
    budget: int,
    model: CollisionModel | None,
) -> Run:
    """Run a solver on a target.

    A search is given as many iterations as its evaluations allow: fewer where a run would exceed
    the budget, since some evaluate a number that depends on the run.

    Args:
        robot: The robot.
        entrant: The solver.
        target: The target.
        start: Start configuration, shape (dof,) [rad or m].
        seed: Seed of the run.
        k: Index of the target: part of the seed.
        budget: Most evaluations.
        model: Bodies to keep clear of; None: no such term.

    Raises:
        InvalidRequest: The solver or its parameters are wrong, or the budget is smaller than its
            first population.
    """
    population: int | str = entrant.population or "paper"
    outside = find_solver(entrant.method).family == "outside"
    if outside:
        population, iterations = 1, budget
    else:
        first = searcher_of(robot, entrant.method, 0, model, entrant.params, population, 1)
        iterations = max(budget // first.population, 1)
    while True:
        searcher = searcher_of(
            robot, entrant.method, _seed(seed, k), model, entrant.params, population, iterations
        )
        lower, upper = searcher.arm.search_bounds(start)
        found = searcher.run(target, start, lower, upper)
        fitting = _fitting(found, budget)
        if found.evaluations[0] <= budget or fitting < 1:
            break
        iterations = min(fitting, iterations - 1)
    if found.evaluations[0] > budget:
        raise InvalidRequest(
            f"budget: one iteration of {entrant.method} takes {int(found.evaluations[0])} "
            f"evaluations, the budget is {budget}",
            field="budget",
            allowed=f"at least {int(found.evaluations[0])}",
        )
    q = searcher.complete(found.x, target, start)
    distance, angle = pose_distance(arm_of(robot), target, q)
    last = int(found.iterations[0]) + 1
    return Run(
        float(found.f[0]),
        distance,
        angle if target.oriented else math.nan,
        float(np.linalg.norm(q - start)),
        int(found.evaluations[0]),
        found.history_evaluations[:last].copy(),
        found.history[:last].copy(),
    )


def _fitting(found: Outcome, budget: int) -> int:
    """Return how many iterations stayed within the budget."""
    done = int(found.iterations[0])
    return int(np.searchsorted(found.history_evaluations[: done + 1], budget, side="right")) - 1
