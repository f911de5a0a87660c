"""Particle swarm optimisation, in the parametrisations of three papers.

Sources: [S] Slim et al., Robotics 2023, 12, 38, Table 1 (after Lopez-Franco et al. 2022); [K]
Kanagaraj et al., MENDEL 2022, 28(1); [L] Li, Luo, Qiao, Machines 2023, 11(6), 648.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.ik.metaheuristics.bounds import bound_flight
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    initial_population,
    new_outcome,
)

__all__ = ["PsoParams", "pso"]


class PsoParams(NamedTuple):
    """Parameters of particle swarm optimisation.

    Attributes:
        w: Inertia in the first iteration.
        w_end: Inertia in the last iteration, linear in between.
        c1: Pull to the particle's own best position.
        c2: Pull to the swarm's best position.
        v_max: Largest velocity, as a fraction of each joint's range; 0: unlimited.
        draws: 0 "component": fresh random numbers for every component; 1 "particle": one pair a
            particle, as [K] prints it.
    """

    w: float
    w_end: float
    c1: float
    c2: float
    v_max: float
    draws: int


@kernel
def pso(problem: Problem, params: PsoParams, rng: np.random.Generator) -> Outcome:
    """Search with particle swarm optimisation.

    Symbols: ``X`` and ``V`` positions and velocities, ``P`` each particle's best position, ``x*``
    the swarm's (G in the papers), ``w`` the inertia.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    P, F = out.X, out.F
    N, D = P.shape
    X, V = P.copy(), np.zeros((N, D))
    T = problem.iterations
    for t in range(1, T + 1):
        w = params.w + (params.w_end - params.w) * (t - 1) / max(T - 1, 1)
        for i in range(N):
            r1, r2 = rng.random(), rng.random()
            for k in range(D):
                if params.draws == 0 and k > 0:
                    r1, r2 = rng.random(), rng.random()
                own, swarm = P[i, k] - X[i, k], best.x[k] - X[i, k]
                V[i, k] = w * V[i, k] + params.c1 * r1 * own + params.c2 * r2 * swarm
                if params.v_max > 0.0:
                    limit = params.v_max * (upper[k] - lower[k])
                    V[i, k] = min(max(V[i, k], -limit), limit)
                X[i, k] += V[i, k]
            bound_flight(X[i], V[i], lower, upper, problem.bounds, rng)
            f = consider(objective, X[i], best)
            if f < F[i]:
                P[i] = X[i]
                F[i] = f
        if end_iteration(problem, out, t):
            break
    return out
