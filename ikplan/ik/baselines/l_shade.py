"""L-SHADE: differential evolution that learns its factors, with a population that shrinks.

Source: Tanabe, Fukunaga, "Improving the Search Performance of SHADE Using Linear Population Size
Reduction", IEEE Congress on Evolutionary Computation 2014, Algorithms 1 and 2, section V; the
mutation is of Zhang, Sanderson, "JADE", 2009.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags
from ikplan.ik.baselines.counting import spend
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    draw_population,
    new_outcome,
)

__all__ = ["LShadeParams", "l_shade", "learn"]

LEAST = 4
"""Smallest population, N_min."""


class LShadeParams(NamedTuple):
    """Parameters of L-SHADE, with the paper's names.

    Attributes:
        per_joint: r_Ninit: the first population is this times D, at most a quarter of the budget.
        p: Share of the population of which a mutant follows one.
        memory: H, places of the memory of factors.
        archive: r_arc: most parents kept in the archive, by the population.
        repair: 0 "midpoint": a component outside goes half-way from the parent to the bound, as in
            JADE; 1 "bounds": as for the other searches.
    """

    per_joint: float
    p: float
    memory: int
    archive: float
    repair: int


@kernel
def learn(memory: Array, place: int, used: Array, gain: Array, n: int) -> None:
    """Write the weighted Lehmer mean of the successful factors into the memory."""
    over, under = 0.0, 0.0
    for k in range(n):
        over += gain[k] * used[k] * used[k]
        under += gain[k] * used[k]
    memory[place] = over / under if under > 0.0 else 0.0


@kernel
def _factor(mean: float, rng: np.random.Generator) -> float:
    """Draw F from the Cauchy distribution of scale 0.1: again until positive, at most 1."""
    F = 0.0
    while F <= 0.0:
        F = mean + 0.1 * math.tan(math.pi * (rng.random() - 0.5))
    return min(F, 1.0)


@kernel
def _rate(mean: float, rng: np.random.Generator) -> float:
    """Draw CR from the normal distribution of deviation 0.1, within [0, 1]; 0 for a mean of -1."""
    draw = rng.standard_normal()
    return 0.0 if mean < 0.0 else min(max(mean + 0.1 * draw, 0.0), 1.0)


@kernel
def _repair(problem: Problem, x: Array, u: Array, mode: int, rng: np.random.Generator) -> None:
    """Bring a trial inside the bounds."""
    if mode == 1:
        bound(u, problem.lower, problem.upper, problem.bounds, rng)
        return
    for k in range(u.shape[0]):
        if u[k] < problem.lower[k]:
            u[k] = 0.5 * (problem.lower[k] + x[k])
        elif u[k] > problem.upper[k]:
            u[k] = 0.5 * (problem.upper[k] + x[k])


@kernel
def _shrink(X: Array, F: Array, size: int, wanted: int) -> None:
    """Move the ``wanted`` best of ``size`` individuals to the front, best first."""
    order = ascending(F[:size])[:wanted]
    kept, values = X[order], F[order]
    X[:wanted] = kept
    F[:wanted] = values


@kernel
def _others(n: int, more: int, i: int, rng: np.random.Generator) -> tuple[int, int]:
    """Draw r1 below n and r2 below n + more, i, r1 and r2 distinct."""
    r1 = i
    while r1 == i:
        r1 = int(rng.random() * n)
    r2 = i
    while r2 in (i, r1):
        r2 = int(rng.random() * (n + more))
    return r1, r2


@kernel
def l_shade(problem: Problem, params: LShadeParams, rng: np.random.Generator) -> Outcome:
    """Search with L-SHADE, with a budget of N + N T evaluations.

    Symbols: ``X`` the population of ``n`` individuals, ``A`` the archive, ``M_F`` and ``M_CR`` the
    memories, ``S_F``, ``S_CR`` and ``gain`` what was successful in a generation and by how much.
    """
    D = problem.lower.shape[0]
    budget = problem.population * (problem.iterations + 1)
    first = max(min(round(params.per_joint * D), budget // 4), LEAST)
    out = new_outcome(problem, first)
    best = best_of(out)
    X, F = out.X, out.F
    draw_population(problem, X, rng)
    stop = False
    for i in range(first):
        if not stop:
            F[i], stop = spend(problem, out, best, X[i])
    n, kept = first, 0
    M_F, M_CR = np.full(params.memory, 0.5), np.full(params.memory, 0.5)
    place = 0
    A = np.empty((max(round(params.archive * first), 1), D))
    S_F, S_CR, gain = np.empty(first), np.empty(first), np.empty(first)
    replaced: Flags = np.zeros(first, dtype=np.bool_)
    U, values = np.empty((first, D)), np.empty(first)
    while not stop:
        order = ascending(F[:n])
        elite = max(round(params.p * n), 2)
        good = 0
        room = max(round(params.archive * n), 1)
        for i in range(n):
            r = int(rng.random() * params.memory)
            CR, scale = _rate(M_CR[r], rng), _factor(M_F[r], rng)
            guide = order[int(rng.random() * elite)]
            r1, r2 = _others(n, kept, i, rng)
            k_rand = int(rng.random() * D)
            for k in range(D):
                second = X[r2, k] if r2 < n else A[r2 - n, k]
                U[i, k] = X[i, k]
                if rng.random() < CR or k == k_rand:
                    U[i, k] += scale * (X[guide, k] - X[i, k]) + scale * (X[r1, k] - second)
            _repair(problem, X[i], U[i], params.repair, rng)
            values[i], stop = spend(problem, out, best, U[i])
            replaced[i] = values[i] <= F[i]
            if values[i] < F[i]:
                S_F[good], S_CR[good], gain[good] = scale, CR, F[i] - values[i]
                good += 1
            if stop:
                break
        if stop:
            break
        for i in range(n):
            if values[i] < F[i]:
                spot = kept if kept < room else int(rng.random() * room)
                A[spot] = X[i]
                kept = min(kept + 1, room)
            if replaced[i]:
                X[i] = U[i]
                F[i] = values[i]
        if good > 0:
            learn(M_F, place, S_F, gain, good)
            if M_CR[place] < 0.0 or S_CR[:good].max() == 0.0:
                M_CR[place] = -1.0
            else:
                learn(M_CR, place, S_CR, gain, good)
            place = (place + 1) % params.memory
        share = out.evaluations[0] / budget
        wanted = max(round(first + (LEAST - first) * share), LEAST)
        if wanted < n:
            _shrink(X, F, n, wanted)
            n = wanted
            kept = min(kept, max(round(params.archive * n), 1))
    _shrink(X, F, n, n)
    return Outcome(
        out.x,
        out.f,
        out.evaluations,
        out.iterations,
        out.history,
        out.history_evaluations,
        X[:n].copy(),
        F[:n].copy(),
        out.archive,
    )
