"""A real-coded genetic algorithm.

Source of N, T, Pm and Pc: [L] Li, Luo, Qiao, Machines 2023, 11(6), 648. It names no operators: the
tournament, the blend crossover (BLX, Eshelman, Schaffer 1993), the mutation and the elite are ours.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    initial_population,
    new_outcome,
)

__all__ = ["GaParams", "cross", "ga"]


class GaParams(NamedTuple):
    """Parameters of the genetic algorithm.

    Attributes:
        Pc: Probability of crossover, per pair.
        Pm: Probability of mutation, per individual.
        tournament: Individuals that compete to become a parent.
        blend: How far beyond its parents a child can be, as a fraction of their difference.
        mutation: 0 "uniform": a gene is drawn anew; 1 "gaussian": it is shifted.
        mutation_deviation: Standard deviation of the shift, as a fraction of the joint's range.
        elites: Best individuals that are carried over unchanged.
    """

    Pc: float
    Pm: float
    tournament: int
    blend: float
    mutation: int
    mutation_deviation: float
    elites: int


@kernel
def _parent(F: Array, size: int, rng: np.random.Generator) -> int:
    """Return the winner of a tournament."""
    winner = int(rng.random() * F.shape[0])
    for _ in range(size - 1):
        rival = int(rng.random() * F.shape[0])
        if F[rival] < F[winner]:
            winner = rival
    return winner


@kernel
def cross(a: Array, b: Array, blend: float, rng: np.random.Generator) -> None:
    """Blend crossover of two children, in place."""
    for k in range(a.shape[0]):
        low, high = min(a[k], b[k]), max(a[k], b[k])
        reach = blend * (high - low)
        a[k] = low - reach + rng.random() * (high - low + 2.0 * reach)
        b[k] = low - reach + rng.random() * (high - low + 2.0 * reach)


@kernel
def ga(problem: Problem, params: GaParams, rng: np.random.Generator) -> Outcome:
    """Search with a genetic algorithm.

    Symbols: ``X`` the parents, ``children`` the next generation, its first rows the elite.
    """
    lower, upper = problem.lower, problem.upper
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    elites = min(params.elites, N - 1)
    children = np.empty((N + 1, D))  # one to spare, where the children are odd in number
    values = np.empty(N)
    for t in range(1, problem.iterations + 1):
        order = ascending(F)
        for i in range(elites):
            children[i] = X[order[i]]
            values[i] = F[order[i]]
        for i in range(elites, N, 2):
            children[i] = X[_parent(F, params.tournament, rng)]
            children[i + 1] = X[_parent(F, params.tournament, rng)]
            if rng.random() < params.Pc:
                cross(children[i], children[i + 1], params.blend, rng)
        for i in range(elites, N):
            if rng.random() < params.Pm:
                k = int(rng.random() * D)
                if params.mutation == 0:
                    children[i, k] = lower[k] + rng.random() * (upper[k] - lower[k])
                else:
                    deviation = params.mutation_deviation * (upper[k] - lower[k])
                    children[i, k] += deviation * rng.standard_normal()
            bound(children[i], lower, upper, problem.bounds, rng)
            values[i] = consider(problem.objective, children[i], best)
        X[:] = children[:N]
        F[:] = values
        if end_iteration(problem, out, t):
            break
    return out
