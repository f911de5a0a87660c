"""CS, the cuckoo search.

Sources: [L] Li, Luo, Qiao, Machines 2023, 11(6), 648, Eqs. 29-35, with the reading of Yang, Deb,
"Cuckoo Search via Levy Flights", 2009, where its equations contradict each other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.draw import levy_deviation, levy_step, permutation
from ikplan.ik.metaheuristics.population import (
    Best,
    Outcome,
    Problem,
    best_of,
    end_iteration,
    initial_population,
    new_outcome,
    replace_if_better,
)

__all__ = ["CsParams", "abandon", "cs"]


class CsParams(NamedTuple):
    """Parameters of the cuckoo search.

    Attributes:
        Pa: A component moves in the random walk when its random number exceeds Pa, Eq. 35.
        alpha_l: Factor of the Levy step, Eq. 29.
        beta: Exponent of the Levy law, Eq. 34.
        heaviside: Keep the factor H(Pa - U) of Eq. 29 in the Levy step.
        normal_factor: Multiply the Levy step by a standard normal number, as Yang's and Deb's code
            does and Eq. 29 does not.
    """

    Pa: float
    alpha_l: float
    beta: float
    heaviside: bool
    normal_factor: bool


@kernel
def abandon(
    problem: Problem, X: Array, F: Array, Pa: float, best: Best, rng: np.random.Generator
) -> None:
    """Random walk of all nests along differences of two others, Eq. 35; greedy."""
    N, D = X.shape
    here, y = X.copy(), np.empty(D)
    a, b = np.empty(N, dtype=np.int64), np.empty(N, dtype=np.int64)
    permutation(N, a, rng)
    permutation(N, b, rng)
    for i in range(N):
        step = rng.random()
        for k in range(D):
            K = 1.0 if rng.random() > Pa else 0.0
            y[k] = here[i, k] + K * step * (here[a[i], k] - here[b[i], k])
        bound(y, problem.lower, problem.upper, problem.bounds, rng)
        replace_if_better(problem.objective, y, X, F, i, best)


@kernel
def cs(problem: Problem, params: CsParams, rng: np.random.Generator) -> Outcome:
    """Search with the cuckoo search.

    Symbols: ``X`` the nests, ``x*`` the best of them at the start of an iteration, ``y`` an egg.
    """
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    y = np.empty(D)
    sigma_u = levy_deviation(params.beta)
    for t in range(1, problem.iterations + 1):
        x_best = best.x.copy()
        for i in range(N):
            for k in range(D):
                step = levy_step(sigma_u, params.beta, rng)
                step *= params.alpha_l * (X[i, k] - x_best[k])  # (29)
                if params.normal_factor:
                    step *= rng.standard_normal()
                if params.heaviside and rng.random() > params.Pa:
                    step = 0.0
                y[k] = X[i, k] + step
            bound(y, problem.lower, problem.upper, problem.bounds, rng)
            replace_if_better(problem.objective, y, X, F, i, best)
        abandon(problem, X, F, params.Pa, best, rng)
        if end_iteration(problem, out, t):
            break
    return out
