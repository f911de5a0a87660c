"""BODE-CS: bidirectional opposite differential evolution, or a cuckoo search, by turns.

Source: [L] Li, Luo, Qiao, "Inverse Kinematics of Robot Manipulator Based on BODE-CS Algorithm",
Machines 2023, 11(6), 648, section 3, Eqs. 18-42, Algorithm 2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.cuckoo import abandon
from ikplan.ik.metaheuristics.differential import crossover
from ikplan.ik.metaheuristics.draw import distinct, levy_deviation, levy_step
from ikplan.ik.metaheuristics.halton import halton_into
from ikplan.ik.metaheuristics.opposition import box_into
from ikplan.ik.metaheuristics.population import (
    Best,
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    new_outcome,
    place_start,
    replace_if_better,
)

__all__ = ["BodeCsParams", "bode_cs", "bode_mutant"]


class BodeCsParams(NamedTuple):
    """Parameters of BODE-CS, with the paper's names.

    Attributes:
        lam: Factor lambda of the second difference.
        Fmax: Eq. 23.
        Fmin: Eq. 23.
        Cmax: Largest crossover rate, Eq. 24.
        Cmin: Smallest crossover rate.
        alpha_l: Factor of the Levy step, Eq. 29.
        beta: Exponent of the Levy law.
        w_j: Weight of the nest, Eq. 37.
        w_gbest: Weight of the best nest, Eq. 37.
        Co: Probability of opposition at the start, Eq. 36.
        Cbi: Probability of the pull to the best, Eq. 38.
        Ccsor: Largest relative shift of an opposite, Eq. 26.
        Pamax: Pa at the start, Eq. 41.
        Pamin: Pa at the end.
        scaling: 0 "printed": F = (Fmax - Fmin)(2 - 2^s); 1 "plus_fmin": the same plus Fmin.
        exclude_self: Whether r1, r2, r3 differ from j as well as from each other.
        generation: 0 "in_place": a better trial takes its place, and x*, at once, as the loops of
            Algorithm 2 have it; 1 "synchronous": mutants are made of x(t), as Eqs. 17 and 28 have.
        heaviside: Keep the factor H(Pa - U) of Eq. 29 in the Levy step.
    """

    lam: float
    Fmax: float
    Fmin: float
    Cmax: float
    Cmin: float
    alpha_l: float
    beta: float
    w_j: float
    w_gbest: float
    Co: float
    Cbi: float
    Ccsor: float
    Pamax: float
    Pamin: float
    scaling: int
    exclude_self: bool
    generation: int
    heaviside: bool


@kernel
def _halton_start(problem: Problem, out: Outcome, best: Best) -> None:
    """First population: the better of each Halton point and its opposite, Eqs. 18-20 and 25."""
    lower, upper = problem.lower, problem.upper
    X, F = out.X, out.F
    opposite = np.empty(X.shape[1])
    halton_into(X)
    for j in range(X.shape[0]):
        for k in range(X.shape[1]):
            X[j, k] = lower[k] + X[j, k] * (upper[k] - lower[k])
    place_start(problem, X)
    for j in range(X.shape[0]):
        F[j] = consider(problem.objective, X[j], best)
        for k in range(X.shape[1]):
            opposite[k] = lower[k] + upper[k] - X[j, k]
        replace_if_better(problem.objective, opposite, X, F, j, best)


@kernel
def _opposite(x: Array, low: Array, high: Array, Ccsor: float, u: float, y: Array) -> None:
    """Write the opposite in the current box S, (26): Smax + Smin - (1 - Ccsor U()) x."""
    for k in range(x.shape[0]):
        y[k] = high[k] + low[k] - (1.0 - Ccsor * u) * x[k]


@kernel
def bode_mutant(
    X: Array,
    j: int,
    r: Indices,
    x_best: Array,
    F: float,
    lam: float,
    s: float,
    draw: float,
    v: Array,
) -> bool:
    """Write the mutant that ``draw`` selects, Eqs. 27 and 28.

    Args:
        X: Swarm, shape (N, D) [rad or m].
        j: Individual.
        r: Indices r1, r2, r3.
        x_best: x*, shape (D,) [rad or m].
        F: Factor of the first difference, Eq. 23.
        lam: Factor lambda of the second.
        s: t / T.
        draw: Uniform random number that chooses the strategy.
        v: Out: the mutant, shape (D,) [rad or m].

    Returns:
        False where the choice is the opposition, and ``v`` is not written.
    """
    b1, b2 = 0.9 - 0.2 * s * s, 0.65 - 0.2 * s * s
    c1, c2 = b2 + (b1 - b2) / 3.0, b2 + 5.0 * (b1 - b2) / 6.0  # (27)
    if c2 < draw <= b1:
        return False
    for k in range(v.shape[0]):
        x1, x2, x3 = X[r[0], k], X[r[1], k], X[r[2], k]
        if draw > b1:  # best-best/1
            v[k] = x_best[k] + F * (x1 - x2) + lam * (x_best[k] - x3)
        elif draw > c1:  # current-best/1
            v[k] = X[j, k] + F * (x1 - x2) + lam * (x_best[k] - x3)
        elif draw > b2:  # the reverse of the first
            v[k] = x_best[k] - F * (x1 - x2) - lam * (x_best[k] - x3)
        else:  # rand-best/1
            v[k] = x1 + F * (x2 - x3) + lam * (x_best[k] - x1)
    return True


@kernel
def _bode(
    problem: Problem, p: BodeCsParams, out: Outcome, best: Best, s: float, rng: np.random.Generator
) -> None:
    """One iteration of bidirectional opposite differential evolution."""
    X, F = out.X, out.F
    N, D = X.shape
    v, low, high = np.empty(D), np.empty(D), np.empty(D)
    r = np.empty(3, dtype=np.int64)
    box_into(X, low, high)
    scale = (p.Fmax - p.Fmin) * (2.0 - 2.0**s)  # (23)
    if p.scaling == 1:
        scale += p.Fmin
    CR = p.Cmin + (p.Cmax - p.Cmin) * s  # (24)
    parents, x_best = X, best.x
    if p.generation == 1:
        parents, x_best = X.copy(), best.x.copy()
    for j in range(N):
        distinct(N, j if p.exclude_self else -1, r, rng)
        if not bode_mutant(parents, j, r, x_best, scale, p.lam, s, rng.random(), v):
            _opposite(parents[j], low, high, p.Ccsor, rng.random(), v)
        crossover(parents[j], v, CR, rng)
        bound(v, problem.lower, problem.upper, problem.bounds, rng)
        replace_if_better(problem.objective, v, X, F, j, best)


@kernel
def _improved_cs(
    problem: Problem, p: BodeCsParams, out: Outcome, best: Best, s: float, rng: np.random.Generator
) -> None:
    """One iteration of the improved cuckoo search."""
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    X, F = out.X, out.F
    N, D = X.shape
    y, low, high = np.empty(D), np.empty(D), np.empty(D)
    sigma_u = levy_deviation(p.beta)
    Pa = p.Pamax - (p.Pamax - p.Pamin) * s  # (41)
    for j in range(N):
        a_s = 0.5 * (math.cos(2.0 * math.pi * rng.random()) + 1.0)  # (40)
        for k in range(D):
            step = a_s * levy_step(sigma_u, p.beta, rng)  # (39)
            if p.heaviside and rng.random() > Pa:
                step = 0.0
            y[k] = X[j, k] + p.alpha_l * step * (X[j, k] - best.x[k])  # (29)
        bound(y, lower, upper, problem.bounds, rng)
        replace_if_better(objective, y, X, F, j, best)
    abandon(problem, X, F, Pa, best, rng)
    box_into(X, low, high)
    f_min, f_max, f_ave = F.min(), F.max(), F.mean()
    pull = p.Cbi * (f_max - f_ave) / (f_max - f_min) if f_max > f_min else 0.0
    for j in range(N):
        if rng.random() < p.Co * (1.0 - s):  # (36)
            _opposite(X[j], low, high, p.Ccsor, rng.random(), y)
            bound(y, lower, upper, problem.bounds, rng)
            replace_if_better(objective, y, X, F, j, best)
        if rng.random() < pull:  # (38)
            for k in range(D):
                y[k] = p.w_j * X[j, k] + p.w_gbest * best.x[k]  # (37)
            bound(y, lower, upper, problem.bounds, rng)
            replace_if_better(objective, y, X, F, j, best)


@kernel
def bode_cs(problem: Problem, params: BodeCsParams, rng: np.random.Generator) -> Outcome:
    """Search with BODE-CS.

    Symbols: ``X`` the swarm with values ``F``, ``s`` = t / T, ``low`` and ``high`` the box S around
    the swarm, ``fit_det`` the probability of the cuckoo search in an iteration. The first
    population is not random: runs differ by later random numbers only.
    """
    out = new_outcome(problem, problem.population)
    best = best_of(out)
    F = out.F
    _halton_start(problem, out, best)
    if end_iteration(problem, out, 0):
        return out
    for t in range(problem.iterations):
        s = t / problem.iterations
        f_max = F.max()
        spread = (F.mean() - F.min()) / f_max if f_max > 0.0 else 0.0
        fit_det = spread * spread  # (42)
        if rng.random() < fit_det:
            _improved_cs(problem, params, out, best, s, rng)
        else:
            _bode(problem, params, out, best, s, rng)
        if end_iteration(problem, out, t + 1):
            break
    return out
