"""Differential evolution DE/x/y/bin, and what its relatives share.

Source: [L] Li, Luo, Qiao, Machines 2023, 11(6), 648, Eqs. 13-17; the parameters of [S] Slim et al.,
Robotics 2023, 12, 38, after Lopez-Franco et al. 2018. Generations are synchronous.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.draw import distinct
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    end_iteration,
    initial_population,
    new_outcome,
    replace_if_better,
)

__all__ = [
    "BEST_1",
    "BEST_2",
    "CURRENT_TO_BEST_1",
    "RAND_1",
    "RAND_2",
    "DeParams",
    "crossover",
    "de",
    "rand_1",
]


RAND_1, BEST_1, BEST_2, RAND_2, CURRENT_TO_BEST_1 = range(5)


class DeParams(NamedTuple):
    """Parameters of differential evolution.

    Attributes:
        strategy: RAND_1, BEST_1, BEST_2, RAND_2 or CURRENT_TO_BEST_1.
        F: Factor of the (first) difference.
        lam: Factor lambda of the second difference.
        CR: Probability that a component comes from the mutant.
    """

    strategy: int
    F: float
    lam: float
    CR: float


@kernel
def crossover(x: Array, v: Array, CR: float, rng: np.random.Generator) -> None:
    """Binomial crossover, in place: components of the mutant ``v`` fall back to ``x``, Eq. 16."""
    D = x.shape[0]
    k_rand = int(rng.random() * D)
    for k in range(D):
        if not (rng.random() < CR or k == k_rand):
            v[k] = x[k]


@kernel
def rand_1(X: Array, r: Indices, F: float, v: Array) -> None:
    """Write the mutant of DE/rand/1."""
    for k in range(v.shape[0]):
        v[k] = X[r[0], k] + F * (X[r[1], k] - X[r[2], k])


@kernel
def _mutate(X: Array, x_best: Array, j: int, r: Indices, p: DeParams, v: Array) -> None:
    """Write the mutant of individual j."""
    if p.strategy == RAND_1:
        rand_1(X, r, p.F, v)
        return
    for k in range(v.shape[0]):
        if p.strategy == BEST_1:
            v[k] = x_best[k] + p.F * (X[r[1], k] - X[r[0], k])
        elif p.strategy == BEST_2:
            first, second = X[r[0], k] - X[r[1], k], X[r[2], k] - X[r[3], k]
            v[k] = x_best[k] + p.F * first + p.lam * second
        elif p.strategy == RAND_2:
            first, second = X[r[1], k] - X[r[2], k], X[r[3], k] - X[r[4], k]
            v[k] = X[r[0], k] + p.F * first + p.lam * second
        else:
            first, second = x_best[k] - X[j, k], X[r[0], k] - X[r[1], k]
            v[k] = X[j, k] + p.F * first + p.lam * second


@kernel
def de(problem: Problem, params: DeParams, rng: np.random.Generator) -> Outcome:
    """Search with differential evolution.

    Symbols: ``X`` the parents, ``v`` a mutant and then the trial made of it, ``r`` distinct indices
    other than ``j``.
    """
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    v = np.empty(D)
    s = params.strategy
    needed = 5 if s == RAND_2 else 4 if s == BEST_2 else 3 if s == RAND_1 else 2
    r = np.empty(needed, dtype=np.int64)
    for t in range(1, problem.iterations + 1):
        parents, x_best = X.copy(), best.x.copy()
        for j in range(N):
            distinct(N, j, r, rng)
            _mutate(parents, x_best, j, r, params, v)
            crossover(parents[j], v, params.CR, rng)
            bound(v, problem.lower, problem.upper, problem.bounds, rng)
            replace_if_better(problem.objective, v, X, F, j, best)
        if end_iteration(problem, out, t):
            break
    return out
