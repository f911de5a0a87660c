"""ODE, opposition-based differential evolution.

Source: Rahnamayan, Tizhoosh, Salama, "Opposition-Based Differential Evolution", IEEE Transactions
on Evolutionary Computation 2008, 12(1); F and CR of [L] Li, Luo, Qiao, Machines 2023, 11, 648.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.differential import crossover, rand_1
from ikplan.ik.metaheuristics.draw import distinct
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    Best,
    Outcome,
    Problem,
    best_of,
    consider,
    draw_population,
    end_iteration,
    new_outcome,
    replace_if_better,
)
from ikplan.ik.objective import Objective

__all__ = ["OdeParams", "box_into", "keep_best_half", "ode"]


class OdeParams(NamedTuple):
    """Parameters of opposition-based differential evolution.

    Attributes:
        F: Factor of the difference.
        CR: Probability that a component comes from the mutant.
        Jr: Probability that a generation is followed by the jump to its opposites.
    """

    F: float
    CR: float
    Jr: float


@kernel
def box_into(X: Array, low: Array, high: Array) -> None:
    """Write the smallest box around a population, each bound of shape (D,)."""
    low[:] = X[0]
    high[:] = X[0]
    for i in range(1, X.shape[0]):
        for k in range(X.shape[1]):
            low[k] = min(low[k], X[i, k])
            high[k] = max(high[k], X[i, k])


@kernel
def keep_best_half(
    objective: Objective, X: Array, F: Array, low: Array, high: Array, best: Best
) -> None:
    """Evaluate the opposites ``low + high - x`` and keep the N best of both, in place."""
    N, D = X.shape
    both, values = np.empty((2 * N, D)), np.empty(2 * N)
    for i in range(N):
        both[i] = X[i]
        values[i] = F[i]
        for k in range(D):
            both[N + i, k] = low[k] + high[k] - X[i, k]
        values[N + i] = consider(objective, both[N + i], best)
    order = ascending(values)
    for i in range(N):
        X[i] = both[order[i]]
        F[i] = values[order[i]]


@kernel
def ode(problem: Problem, params: OdeParams, rng: np.random.Generator) -> Outcome:
    """Search with opposition-based differential evolution.

    Symbols: ``X`` the parents, ``v`` a mutant and then the trial made of it.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    out = new_outcome(problem, problem.population)
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    draw_population(problem, X, rng)
    for j in range(N):
        F[j] = consider(objective, X[j], best)
    keep_best_half(objective, X, F, lower, upper, best)
    if end_iteration(problem, out, 0):
        return out
    v, low, high = np.empty(D), np.empty(D), np.empty(D)
    r = np.empty(3, dtype=np.int64)
    for t in range(1, problem.iterations + 1):
        parents = X.copy()
        for j in range(N):
            distinct(N, j, r, rng)
            rand_1(parents, r, params.F, v)
            crossover(parents[j], v, params.CR, rng)
            bound(v, lower, upper, problem.bounds, rng)
            replace_if_better(objective, v, X, F, j, best)
        if rng.random() < params.Jr:
            box_into(X, low, high)
            keep_best_half(objective, X, F, low, high, best)
        if end_iteration(problem, out, t):
            break
    return out
