"""A function of Python behind the signature of a compiled search."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.errors import InvalidRequest
from ikplan.ik.metaheuristics.population import Outcome, Problem
from ikplan.ik.outside.pose_objective import BudgetSpent, PoseObjective

__all__ = ["search"]


def search(
    minimise: Callable[..., ArrayLike | None],
    problem: Problem,
    params: dict[str, Any],
    rng: np.random.Generator,
) -> Outcome:
    """Run a function of Python as a search."""
    objective = PoseObjective(
        problem.objective,
        problem.lower,
        problem.upper,
        problem.q_s,
        budget=problem.population * problem.iterations,
        cut=problem.cut,
    )
    answer: ArrayLike | None = None
    try:
        answer = minimise(objective, rng, **params)
        if answer is not None:
            objective(np.asarray(answer, dtype=np.float64))
    except BudgetSpent:
        pass
    if not objective.spent:
        raise InvalidRequest(
            "ik.method: the solver ended without an evaluation of the objective",
            field="ik.method",
        )
    steps = [*objective.improvements, (objective.spent, objective.best_f)]
    return Outcome(
        objective.best_x,
        np.array([objective.best_f]),
        np.array([objective.spent], dtype=np.int64),
        np.array([len(steps) - 1], dtype=np.int64),
        np.array([value for _, value in steps]),
        np.array([count for count, _ in steps], dtype=np.int64),
        objective.best_x[None].copy(),
        np.array([objective.best_f]),
        np.empty((0, objective.dof + 2)),
    )
