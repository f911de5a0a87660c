"""GSA, the gravitational search algorithm.

Sources: [K] Kanagaraj et al., MENDEL 2022, 28(1), Eqs. 10-18, with Eq. 11 corrected; Rashedi,
Nezamabadi-pour, Saryazdi, "GSA: A Gravitational Search Algorithm", Information Sciences 2009.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.bounds import bound_flight
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    draw_population,
    end_iteration,
    new_outcome,
)

__all__ = ["GsaParams", "gsa", "masses_into"]


EPS = 2.220446049250313e-16


class GsaParams(NamedTuple):
    """Parameters of the gravitational search.

    Attributes:
        G0: Gravity at the start, Eq. 10.
        alpha: How fast it falls, Eq. 10.
        K_end: Share of the individuals that still attract at the end.
    """

    G0: float
    alpha: float
    K_end: float


@kernel
def masses_into(F: Array, M: Array) -> None:
    """Write the masses, Eqs. 11 (corrected) and 12."""
    least, worst = F.min(), F.max()
    if least == worst:
        M[:] = 1.0 / F.shape[0]
        return
    for i in range(F.shape[0]):
        M[i] = (F[i] - worst) / (least - worst)
    M /= M.sum()


@kernel
def gsa(problem: Problem, params: GsaParams, rng: np.random.Generator) -> Outcome:
    """Search with the gravitational search algorithm.

    Symbols: ``X``, ``V`` and ``a`` positions, velocities and accelerations, ``M`` masses, ``G``
    gravity, ``K`` the number of individuals that attract. The population is evaluated at the start
    of an iteration, so that N T candidates are evaluated in all.
    """
    out = new_outcome(problem, problem.population)
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    T = problem.iterations
    draw_population(problem, X, rng)
    V, a, M, here = np.zeros((N, D)), np.empty(D), np.empty(N), np.empty((N, D))
    for t in range(1, T + 1):
        for i in range(N):
            F[i] = consider(problem.objective, X[i], best)
        if end_iteration(problem, out, t) or t == T:
            break
        masses_into(F, M)
        G = params.G0 * math.exp(-params.alpha * t / T)  # (10)
        K = max(round(N * (1.0 - (1.0 - params.K_end) * t / T)), 1)
        heaviest = ascending(F)[:K]
        here[:] = X
        for i in range(N):
            if problem.cut[0]:  # an iteration of a large population takes minutes
                break
            a[:] = 0.0
            for k in heaviest:
                if k == i:
                    continue
                square = 0.0
                for d in range(D):
                    square += (here[k, d] - here[i, d]) ** 2
                pull = G * M[k] / (math.sqrt(square) + EPS)  # (13); M_i cancels in (18)
                for d in range(D):
                    a[d] += rng.random() * pull * (here[k, d] - here[i, d])  # (14)
            for d in range(D):
                V[i, d] = rng.random() * V[i, d] + a[d]  # (17), a of (18)
                X[i, d] += V[i, d]  # (16)
            bound_flight(X[i], V[i], problem.lower, problem.upper, problem.bounds, rng)
    return out
