"""SDE, self-adaptive differential evolution.

Source: Omran, Salman, Engelbrecht, "Self-adaptive Differential Evolution", 2005; the comparison and
F = 0.9 are of [L] Li, Luo, Qiao, Machines 2023, 11(6), 648.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.differential import crossover, rand_1
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

__all__ = ["SdeParams", "sde"]


class SdeParams(NamedTuple):
    """Parameters of self-adaptive differential evolution.

    Attributes:
        F_initial: 0 "normal": the first factors are drawn; 1 "fixed": they are ``F``.
        F: First factor of every individual, under "fixed".
        F_mean: Mean of the first factors.
        F_deviation: Their standard deviation.
        change_deviation: Standard deviation of the factor of the difference of factors.
        CR_mean: Mean of the crossover rate.
        CR_deviation: Its standard deviation.
    """

    F_initial: int
    F: float
    F_mean: float
    F_deviation: float
    change_deviation: float
    CR_mean: float
    CR_deviation: float


@kernel
def sde(problem: Problem, params: SdeParams, rng: np.random.Generator) -> Outcome:
    """Search with self-adaptive differential evolution.

    Symbols: ``scale`` is the paper's F_i, ``X`` the parents, ``v`` a mutant and then the trial. A
    new factor lives on with its trial only: without selection the factors would grow without end.
    """
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    v = np.empty(D)
    r, s = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    scale = np.full(N, params.F)
    if params.F_initial == 0:
        for j in range(N):
            scale[j] = params.F_mean + params.F_deviation * rng.standard_normal()
    for t in range(1, problem.iterations + 1):
        parents, scales = X.copy(), scale.copy()
        for j in range(N):
            distinct(N, j, r, rng)
            distinct(N, j, s, rng)
            change = params.change_deviation * rng.standard_normal()
            own_scale = abs(scales[s[0]] + change * (scales[s[1]] - scales[s[2]]))
            CR = params.CR_mean + params.CR_deviation * rng.standard_normal()
            rand_1(parents, r, own_scale, v)
            crossover(parents[j], v, min(max(CR, 0.0), 1.0), rng)
            bound(v, problem.lower, problem.upper, problem.bounds, rng)
            if replace_if_better(problem.objective, v, X, F, j, best):
                scale[j] = own_scale
        if end_iteration(problem, out, t):
            break
    return out
