"""Evaluations of a search whose generations are not of N candidates.

Such a search has the budget of any other, N + N T evaluations, and its history is written after
every N of them.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.population import (
    Best,
    Outcome,
    Problem,
    consider,
    end_iteration,
)

__all__ = ["draw_first", "spend"]


@kernel
def spend(problem: Problem, out: Outcome, best: Best, x: Array) -> tuple[float, bool]:
    """Evaluate a candidate; every N evaluations are an iteration.

    Args:
        problem: The search to be made.
        out: Its outcome.
        best: The part of it that holds the best.
        x: Candidate, shape (D,) [rad or m].

    Returns:
        Its value, and whether the search ends here.
    """
    f = consider(problem.objective, x, best)
    if out.evaluations[0] % problem.population != 0:
        return f, False
    t = out.evaluations[0] // problem.population - 1
    return f, end_iteration(problem, out, t) or t >= problem.iterations


@kernel
def draw_first(low: Array, high: Array, x: Array, rng: np.random.Generator) -> None:
    """Draw a position uniformly within the bounds."""
    for k in range(x.shape[0]):
        x[k] = low[k] + rng.random() * (high[k] - low[k])
