"""WOA, the whale optimisation algorithm.

Sources: [K] Kanagaraj et al., MENDEL 2022, 28(1), Eqs. 19-23; Mirjalili, Lewis, "The Whale
Optimization Algorithm", Advances in Engineering Software 2016, 95.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    initial_population,
    new_outcome,
)

__all__ = ["WoaParams", "woa"]


class WoaParams(NamedTuple):
    """Parameters of the whale optimisation.

    Attributes:
        b: Shape of the spiral.
        literal: Eq. 20 as [K] prints it: no absolute value, and always towards x*.
    """

    b: float
    literal: bool


@kernel
def woa(problem: Problem, params: WoaParams, rng: np.random.Generator) -> Outcome:
    """Search with the whale optimisation algorithm.

    Symbols: ``X`` the whales, ``x*`` the best position, ``A``, ``C``, ``l`` and ``p`` as in the
    papers.
    """
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    T = problem.iterations
    reference = np.empty(D)
    for t in range(1, T + 1):
        a1 = 2.0 - 2.0 * t / T
        a2 = -1.0 - t / T
        for i in range(N):
            A = 2.0 * a1 * rng.random() - a1
            C = 2.0 * rng.random()
            l = (a2 - 1.0) * rng.random() + 1.0  # noqa: E741 - (23)
            p = rng.random()
            if p < 0.5:
                reference[:] = best.x
                if abs(A) >= 1.0 and not params.literal:
                    reference[:] = X[int(rng.random() * N)]
                for k in range(D):
                    distance = C * reference[k] - X[i, k]
                    if not params.literal:
                        distance = abs(distance)
                    X[i, k] = reference[k] - A * distance  # (19), the distance of (20)
            else:
                spiral = math.exp(params.b * l) * math.cos(2.0 * math.pi * l)
                for k in range(D):
                    X[i, k] = abs(best.x[k] - X[i, k]) * spiral + best.x[k]  # (22)
            bound(X[i], problem.lower, problem.upper, problem.bounds, rng)
            F[i] = consider(problem.objective, X[i], best)
        if end_iteration(problem, out, t):
            break
    return out
