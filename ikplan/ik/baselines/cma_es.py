"""CMA-ES with restarts of a growing population (IPOP-CMA-ES), active update.

Sources: Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv:1604.00772, Figure 6 and Table 1;
Auger, Hansen, "A Restart CMA Evolution Strategy With Increasing Population Size", IEEE Congress on
Evolutionary Computation 2005.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.ik.baselines.counting import draw_first, spend
from ikplan.ik.baselines.eigen import eigen_into
from ikplan.ik.metaheuristics.bounds import bound
from ikplan.ik.metaheuristics.order import ascending
from ikplan.ik.metaheuristics.population import (
    CLOUD,
    CLOUD_DEVIATION,
    COLD,
    Outcome,
    Problem,
    best_of,
    new_outcome,
)

__all__ = ["CmaParams", "Strategy", "cma_es", "strategy_of"]

CONDITION = 1e14
"""Largest condition number of the covariance; beyond it the search begins again."""


class CmaParams(NamedTuple):
    """Parameters of CMA-ES.

    Attributes:
        sigma: First step size, as a fraction of each joint's range.
        growth: Factor of lambda at each restart; 2 is IPOP.
        tol_f: A run ends once its values differ by less than this.
        tol_x: A run ends once no step is longer than this, as a fraction of the joint's range.
    """

    sigma: float
    growth: float
    tol_f: float
    tol_x: float


class Strategy(NamedTuple):
    """What Table 1 of the tutorial derives from n and lambda.

    Attributes:
        w: Weights, the best first, the last of them negative, shape (lambda,).
        mu: Number of parents.
        mu_eff: Variance effective selection mass.
        c_sigma: Rate of the path of the step size.
        d_sigma: Its damping.
        c_c: Rate of the path of the covariance.
        c_1: Rate of the rank-one update.
        c_mu: Rate of the rank-mu update.
        chi: Expected length of a standard normal vector.
    """

    w: Array
    mu: int
    mu_eff: float
    c_sigma: float
    d_sigma: float
    c_c: float
    c_1: float
    c_mu: float
    chi: float


@kernel
def strategy_of(n: int, size: int) -> Strategy:
    """Return the strategy parameters for n dimensions and ``size`` = lambda candidates."""
    mu = size // 2
    w = np.empty(size)
    for i in range(size):
        w[i] = math.log(0.5 * (size + 1.0)) - math.log(i + 1.0)
    mu_eff = w[:mu].sum() ** 2 / (w[:mu] ** 2).sum()
    mu_eff_minus = w[mu:].sum() ** 2 / (w[mu:] ** 2).sum()
    c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0)
    d_sigma = 1.0 + 2.0 * max(0.0, math.sqrt((mu_eff - 1.0) / (n + 1.0)) - 1.0) + c_sigma
    c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n)
    c_1 = 2.0 / ((n + 1.3) ** 2 + mu_eff)
    c_mu = 2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0) ** 2 + mu_eff)
    c_mu = min(1.0 - c_1, c_mu)
    negative = min(
        1.0 + c_1 / c_mu,
        1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0),
        (1.0 - c_1 - c_mu) / (n * c_mu),
    )
    plus, minus = 0.0, 0.0
    for i in range(size):
        if w[i] >= 0.0:
            plus += w[i]
        else:
            minus -= w[i]
    for i in range(size):
        w[i] *= 1.0 / plus if w[i] >= 0.0 else negative / minus
    chi = math.sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n))
    return Strategy(w, mu, mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi)


@kernel
def _whiten(B: Array, d: Array, y: Array, z: Array) -> None:
    """Write C^(-1/2) y, with C = B diag(d)^2 B^T."""
    n = y.shape[0]
    z[:] = 0.0
    for i in range(n):
        along = 0.0
        for k in range(n):
            along += B[k, i] * y[k]
        along /= d[i]
        for k in range(n):
            z[k] += along * B[k, i]


@kernel
def _adapt(
    C: Array, s: Strategy, Y: Array, order: Indices, p_c: Array, heard: float, B: Array, d: Array
) -> None:
    """Update the covariance, Eq. 47 of the tutorial; ``heard`` is h_sigma."""
    n = C.shape[0]
    z = np.empty(n)
    keep = 1.0 - s.c_1 - s.c_mu * s.w.sum() + s.c_1 * (1.0 - heard) * s.c_c * (2.0 - s.c_c)
    for a in range(n):
        for b in range(n):
            C[a, b] = keep * C[a, b] + s.c_1 * p_c[a] * p_c[b]
    for i in range(s.w.shape[0]):
        y = Y[order[i]]
        weight = s.w[i]
        if weight < 0.0:
            _whiten(B, d, y, z)
            weight *= n / max((z * z).sum(), 1e-300)
        for a in range(n):
            for b in range(n):
                C[a, b] += s.c_mu * weight * y[a] * y[b]


@kernel
def _decompose(C: Array, B: Array, d: Array) -> bool:
    """Write C = B diag(d)^2 B^T; return whether its condition is sound."""
    eigen_into(C, d, B)
    low, high = d.min(), d.max()
    if not (low > 0.0 and high <= CONDITION * low):
        return False
    for k in range(d.shape[0]):
        d[k] = math.sqrt(d[k])
    return True


@kernel
def cma_es(problem: Problem, params: CmaParams, rng: np.random.Generator) -> Outcome:
    """Search with CMA-ES, with a budget of N + N T evaluations.

    Symbols: ``m`` the mean, ``sigma`` the step size and ``C`` the covariance of the distribution,
    in coordinates in which every joint's range is 1; ``p_s`` and ``p_c`` the evolution paths,
    ``Y`` the steps of a generation of ``size`` (lambda) candidates. A candidate outside the bounds
    is brought inside and takes part as it is then. The outcome has the last N candidates.
    """
    lower, upper = problem.lower, problem.upper
    n, N = lower.shape[0], problem.population
    span = upper - lower
    out = new_outcome(problem, N)
    best = best_of(out)
    size = 4 + int(3.0 * math.log(n))
    m, x, first = np.empty(n), np.empty(n), True
    stop = False
    while not stop:
        if first and problem.warm != COLD:
            m[:] = problem.q_s
            bound(m, lower, upper, 0, rng)
        else:
            draw_first(lower, upper, m, rng)
        sigma = params.sigma
        if first and problem.warm == CLOUD:
            sigma = CLOUD_DEVIATION / span.mean()
        s = strategy_of(n, size)
        C, B, d = np.eye(n), np.eye(n), np.ones(n)
        p_s, p_c, z = np.zeros(n), np.zeros(n), np.empty(n)
        Y, F = np.empty((size, n)), np.empty(size)
        memory = 10 + math.ceil(30.0 * n / size)
        recent = np.full(memory, np.inf)
        wait = max(int(1.0 / (10.0 * n * (s.c_1 + s.c_mu))), 1)
        generation = 0
        while not stop:
            for i in range(size):
                for k in range(n):
                    z[k] = d[k] * rng.standard_normal()
                for k in range(n):
                    step = 0.0
                    for a in range(n):
                        step += B[k, a] * z[a]
                    x[k] = m[k] + sigma * step * span[k]
                if first and generation == 0 and i == 0:
                    x[:] = m  # the start itself is never lost
                bound(x, lower, upper, problem.bounds, rng)
                row = out.evaluations[0] % N
                F[i], stop = spend(problem, out, best, x)
                out.X[row] = x
                out.F[row] = F[i]
                if stop:
                    break
                for k in range(n):
                    Y[i, k] = (x[k] - m[k]) / (sigma * span[k])
            if stop:
                break
            generation += 1
            order = ascending(F)
            y = np.zeros(n)
            for i in range(s.mu):
                for k in range(n):
                    y[k] += s.w[i] * Y[order[i], k]
            for k in range(n):
                m[k] += sigma * y[k] * span[k]
            _whiten(B, d, y, z)
            for k in range(n):
                p_s[k] = (1.0 - s.c_sigma) * p_s[k]
                p_s[k] += math.sqrt(s.c_sigma * (2.0 - s.c_sigma) * s.mu_eff) * z[k]
            length = math.sqrt((p_s * p_s).sum())
            settled = math.sqrt(1.0 - (1.0 - s.c_sigma) ** (2 * generation))
            heard = 1.0 if length / settled < (1.4 + 2.0 / (n + 1.0)) * s.chi else 0.0
            for k in range(n):
                p_c[k] = (1.0 - s.c_c) * p_c[k]
                p_c[k] += heard * math.sqrt(s.c_c * (2.0 - s.c_c) * s.mu_eff) * y[k]
            _adapt(C, s, Y, order, p_c, heard, B, d)
            sigma *= math.exp(min(1.0, s.c_sigma / s.d_sigma * (length / s.chi - 1.0)))
            if generation % wait == 0 and not _decompose(C, B, d):
                break
            recent[generation % memory] = F[order[0]]
            worst = max(recent.max(), F.max())
            if worst - min(recent.min(), F.min()) < params.tol_f:
                break
            longest = 0.0
            for k in range(n):
                longest = max(longest, sigma * max(abs(p_c[k]), math.sqrt(C[k, k])))
            if not params.tol_x < longest < 1e4:
                break
        size = max(int(size * params.growth), size)
        first = False
    return out
