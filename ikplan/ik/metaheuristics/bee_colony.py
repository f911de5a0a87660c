"""The artificial bee colony, as a stand-in for K-ABC.

Sources: Karaboga, Basturk, "A powerful and efficient algorithm for numerical function optimization:
artificial bee colony (ABC) algorithm", Journal of Global Optimization 2007, 39; the guided move is
of Zhu, Kwong, "Gbest-guided artificial bee colony algorithm", 2010. The update equations of K-ABC
(El-Sherbiny, Elhosseini, Haikal 2018), which [S] compares with, are not openly available.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.draw import distinct, signed
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    draw_within,
    end_iteration,
    initial_population,
    new_outcome,
    replace_if_better,
)

__all__ = ["AbcParams", "abc"]


class AbcParams(NamedTuple):
    """Parameters of the artificial bee colony.

    Attributes:
        move: 0 "standard"; 1 "guided" by the best source.
        psi_max: Largest pull to the best source, under "guided".
        fitness: 0 "value": 1 / (1 + fitness_scale f); 1 "rank": N - rank, the best first.
        fitness_scale: Brings the objective into the unit of the fitness: 1000 for millimetres.
        limit_factor: The limit of trials is this times SN D.
    """

    move: int
    psi_max: float
    fitness: int
    fitness_scale: float
    limit_factor: float


@kernel
def _neighbour(
    X: Array,
    x_best: Array,
    i: int,
    params: AbcParams,
    partner: Indices,
    y: Array,
    rng: np.random.Generator,
) -> None:
    """Write a neighbour of source i, which differs from it in one component."""
    j = int(rng.random() * X.shape[1])
    distinct(X.shape[0], i, partner, rng)
    y[:] = X[i]
    y[j] += signed(rng) * (X[i, j] - X[partner[0], j])
    if params.move == 1:
        y[j] += params.psi_max * rng.random() * (x_best[j] - X[i, j])


@kernel
def _choose(fitness: Array, total: float, rng: np.random.Generator) -> int:
    """Draw a source with a probability in proportion to its fitness."""
    mark, i = rng.random() * total, 0
    while i < fitness.shape[0] - 1 and mark >= fitness[i]:
        mark -= fitness[i]
        i += 1
    return i


@kernel
def _fitness_into(F: Array, params: AbcParams, fitness: Array) -> None:
    """Write the fitness of each source."""
    if params.fitness == 1:
        order = ascending(F)
        for rank in range(F.shape[0]):
            fitness[order[rank]] = F.shape[0] - rank
        return
    for i in range(F.shape[0]):
        fitness[i] = 1.0 / (1.0 + params.fitness_scale * F[i])


@kernel
def abc(problem: Problem, params: AbcParams, rng: np.random.Generator) -> Outcome:
    """Search with the artificial bee colony.

    Symbols: ``SN`` = N / 2 food sources ``X``, ``trial`` the failures in a row at each, ``limit``
    the number of failures after which a source is left.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    SN = problem.population // 2
    out = new_outcome(problem, SN)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    D = X.shape[1]
    y, fitness = np.empty(D), np.empty(SN)
    trial, partner = np.zeros(SN, dtype=np.int64), np.empty(1, dtype=np.int64)
    limit = params.limit_factor * SN * D
    for t in range(1, problem.iterations + 1):
        total = 0.0
        for bee in range(2 * SN):
            if bee == SN:
                _fitness_into(F, params, fitness)
                total = fitness.sum()
            # The employed bees visit every source, the onlookers choose by fitness.
            i = bee if bee < SN else _choose(fitness, total, rng)
            _neighbour(X, best.x, i, params, partner, y, rng)
            bound(y, lower, upper, problem.bounds, rng)
            better = replace_if_better(objective, y, X, F, i, best)
            trial[i] = 0 if better else trial[i] + 1
        i = int(np.argmax(trial))  # at most one scout
        if trial[i] > limit:
            draw_within(lower, upper, X[i], rng)
            F[i] = consider(objective, X[i], best)
            trial[i] = 0
        if end_iteration(problem, out, t):
            break
    return out
