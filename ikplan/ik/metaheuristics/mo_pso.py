"""MO-PSO: particle swarm optimisation of position error and elongation together.

Sources: [S] Slim et al., Robotics 2023, 12, 38, Table 1; Coello Coello, Pulido, Lechuga, "Handling
Multiple Objectives With Particle Swarm Optimization", IEEE Transactions on Evolutionary Computation
2004, 8(3), which the implementation cited in [S] follows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.archive import (
    archive_into,
    dominates,
    draw_leader,
    knee,
)
from ikplan.ik.metaheuristics.bounds import CLIP, bound_flight
from ikplan.ik.metaheuristics.draw import subset
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    draw_within,
    end_iteration,
    initial_population,
    new_outcome,
)

__all__ = ["MoPsoParams", "mo_pso"]


class MoPsoParams(NamedTuple):
    """Parameters of MO-PSO.

    Attributes:
        w: Inertia.
        c1: Pull to the particle's own best position.
        c2: Pull to the leader.
        grid: Divisions of each objective.
        v_max: Largest velocity, as a fraction of each joint's range.
        mutation: Share of the second third of the swarm that is drawn anew.
        archive: Nr, the largest number of candidates kept.
        choice: Candidate reported: 0 "position", the smallest position error; 1 "knee", the one
            nearest to the ideal point, both objectives scaled to [0, 1].
    """

    w: float
    c1: float
    c2: float
    grid: int
    v_max: float
    mutation: float
    archive: int
    choice: int


@kernel
def _elongation(x: Array, q_s: Array) -> float:
    """Return f2 = ||x - q_s||, [S] Eq. 12."""
    total = 0.0
    for k in range(x.shape[0]):
        total += (x[k] - q_s[k]) ** 2
    return math.sqrt(total)


@kernel
def _mutate(problem: Problem, X: Array, share: float, t: int, rng: np.random.Generator) -> None:
    """Draw anew a share of the second third of the swarm, and a falling share of the last."""
    N, D = X.shape
    third = N // 3
    order = np.empty(third, dtype=np.int64)
    falling = (1.0 - t / problem.iterations) ** (5 * D)
    for part in range(1, 3):
        count = round((share if part == 1 else falling) * third)
        subset(third, count, order, rng)
        for m in range(count):
            draw_within(problem.lower, problem.upper, X[part * third + order[m]], rng)


@kernel
def _stop_at_bounds(
    problem: Problem, x: Array, v: Array, v_max: float, rng: np.random.Generator
) -> None:
    """Clamp the velocity, bring the position inside; clipped, its velocity turns around."""
    lower, upper = problem.lower, problem.upper
    for k in range(x.shape[0]):
        limit = v_max * (upper[k] - lower[k])
        v[k] = min(max(v[k], -limit), limit)
        if problem.bounds == CLIP and (x[k] < lower[k] or x[k] > upper[k]):
            v[k] = -v[k]
            x[k] = min(max(x[k], lower[k]), upper[k])
    bound_flight(x, v, lower, upper, problem.bounds, rng)


@kernel
def mo_pso(problem: Problem, params: MoPsoParams, rng: np.random.Generator) -> Outcome:
    """Search with MO-PSO; the outcome has the archive, and x is chosen from it.

    Symbols: ``X`` and ``V`` positions and velocities, ``P`` each particle's best position, ``h``
    the leader of a generation, f1 the objective, f2 the elongation.
    """
    objective = problem.objective
    out = new_outcome(problem, problem.population)
    stop = initial_population(problem, out, rng)
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    G, V, P = np.empty((N, 2)), np.zeros((N, D)), X.copy()
    for i in range(N):
        G[i, 0], G[i, 1] = F[i], _elongation(X[i], problem.q_s)
    own = G.copy()
    # A row a candidate: position, f1, f2.
    room = np.empty((params.archive + N, D + 2))
    size = archive_into(room, 0, X, G, params.archive)
    for t in range(1, problem.iterations + 1):
        if stop:
            break
        h = room[draw_leader(room[:size, D:], params.grid, rng), :D].copy()
        for i in range(N):
            for k in range(D):
                V[i, k] = (
                    params.w * V[i, k]
                    + params.c1 * rng.random() * (P[i, k] - X[i, k])
                    + params.c2 * rng.random() * (h[k] - X[i, k])
                )
                X[i, k] += V[i, k]
        _mutate(problem, X, params.mutation, t, rng)
        for i in range(N):
            _stop_at_bounds(problem, X[i], V[i], params.v_max, rng)
            F[i] = consider(objective, X[i], best)
            G[i, 0], G[i, 1] = F[i], _elongation(X[i], problem.q_s)
        size = archive_into(room, size, X, G, params.archive)
        for i in range(N):
            better = dominates(G[i, 0], G[i, 1], own[i, 0], own[i, 1])
            if not better and not dominates(own[i, 0], own[i, 1], G[i, 0], G[i, 1]):
                better = rng.random() < 0.5
            if better:
                P[i] = X[i]
                own[i] = G[i]
        stop = end_iteration(problem, out, t)
    if params.choice == 1:
        chosen = room[knee(room[:size, D:])]
        out.x[:] = chosen[:D]
        out.f[0] = chosen[D]
    return Outcome(
        out.x,
        out.f,
        out.evaluations,
        out.iterations,
        out.history,
        out.history_evaluations,
        X,
        F,
        room[:size].copy(),
    )
