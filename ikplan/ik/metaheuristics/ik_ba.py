"""IK-BA: the bat algorithm with the start configuration in its update.

Source: [S] Slim, Rokbani, Neji, Terres, Beyrouthy, "Inverse Kinematic Solver Based on Bat Algorithm
for Robotic Arm Path Planning", Robotics 2023, 12, 38, section 4.2, Algorithm 2, Table 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.copying import copy_into
from ikplan.ik.metaheuristics.bounds import bound, bound_flight
from ikplan.ik.metaheuristics.draw import signed
from ikplan.ik.metaheuristics.population import (
    Best,
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    initial_population,
    new_outcome,
)
from ikplan.ik.objective import Objective, evaluate

__all__ = ["IkBaParams", "ik_ba"]


class IkBaParams(NamedTuple):
    """Parameters of IK-BA, [S] Table 1.

    Attributes:
        fmin: Smallest frequency.
        fmax: Largest frequency.
        alpha: Factor of the loudness per iteration, Eq. 9.
        gamma: Rate at which the pulse rate rises, Eq. 10.
        A0: Loudness before the first iteration.
        r0: Asymptote of the pulse rate.
        eps_scale: Factor of the noise of Eq. 14.
        noise: 0 uniform in [-1, 1); 1 standard normal; 2 standard normal, drawn again until it is
            within [-1, 1].
        variant: 0 "local" evaluates Eq. 14 only; 1 "both" also evaluates the bats that fly by
            Eqs. 7 and 13, two candidates a bat where Algorithm 2 has one; 2 "both_attract" the same
            with the sign of Eq. 13 turned. These bats fly on from where they are; 3 "overwritten":
            from the position of Eq. 14, which takes the place of theirs in Algorithm 2.
        accept: 0 "greedy" keeps every better candidate; 1 "loudness" only with probability A.
        first_t: The t of the first iteration.
        beta: 0 "component": Eq. 5 draws a vector, as printed; 1 "bat": one number a bat. Not used
            by "local".
        draws: 0 "component": eps of Eq. 14 is drawn for every joint; 1 "bat": one number a bat.
    """

    fmin: float
    fmax: float
    alpha: float
    gamma: float
    A0: float
    r0: float
    eps_scale: float
    noise: int
    variant: int
    accept: int
    first_t: int
    beta: int
    draws: int


@kernel
def ik_ba(problem: Problem, params: IkBaParams, rng: np.random.Generator) -> Outcome:
    """Search with IK-BA.

    Symbols: ``X`` and ``V`` positions and velocities of the bats, ``x*`` the best position, ``q_s``
    the start configuration, ``A`` the loudness, ``r`` the pulse rate, ``eps`` the noise.
    """
    objective, lower, upper, q_s = problem.objective, problem.lower, problem.upper, problem.q_s
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    V = np.zeros((N, D))
    Y = X.copy()  # the bats that fly by Eqs. 7 and 13
    sign = -1.0 if params.variant == 2 else 1.0
    for iteration in range(1, problem.iterations + 1):
        t = iteration - 1 + params.first_t
        A = params.alpha**t * params.A0  # (9)
        r = params.r0 * (1.0 - math.exp(-params.gamma * t))  # (10)
        for i in range(N):
            if params.variant != 0:
                if params.variant == 3:
                    copy_into(Y[i], X[i])
                beta = rng.random()  # (5)
                for k in range(D):
                    if params.beta == 0 and k > 0:
                        beta = rng.random()
                    frequency = params.fmin + (params.fmax - params.fmin) * beta
                    V[i, k] += sign * (Y[i, k] - 0.5 * (best.x[k] + q_s[k])) * frequency  # (13)
                    Y[i, k] += V[i, k]  # (7)
                bound_flight(Y[i], V[i], lower, upper, problem.bounds, rng)
                _heard(objective, Y[i], best, A, params.accept, rng)
            eps = _noise(params.noise, rng)
            for k in range(D):
                if params.draws == 0 and k > 0:
                    eps = _noise(params.noise, rng)
                X[i, k] = r * best.x[k] + (1.0 - r) * q_s[k] + params.eps_scale * eps * A  # (14)
            bound(X[i], lower, upper, problem.bounds, rng)
            F[i] = _heard(objective, X[i], best, A, params.accept, rng)
        if end_iteration(problem, out, iteration):
            break
    return out


@kernel
def _noise(distribution: int, rng: np.random.Generator) -> float:
    """Draw eps of Eq. 14: 0 uniform in [-1, 1), 1 standard normal, 2 the same within [-1, 1]."""
    if distribution == 0:
        return signed(rng)
    eps = rng.standard_normal()
    while distribution == 2 and abs(eps) > 1.0:
        eps = rng.standard_normal()
    return eps


@kernel
def _heard(
    objective: Objective,
    x: np.ndarray,
    best: Best,
    A: float,
    accept: int,
    rng: np.random.Generator,
) -> float:
    """Consider a candidate; under "loudness" it becomes x* only with probability A."""
    if accept == 0:
        return consider(objective, x, best)
    f = evaluate(objective, x)
    best.evaluations[0] += 1
    if f < best.f[0] and rng.random() < A:
        best.f[0] = f
        copy_into(best.x, x)
    return f
