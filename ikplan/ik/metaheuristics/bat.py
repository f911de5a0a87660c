"""The bat algorithm, in the parametrisations of Slim et al. (BA) and of Kanagaraj et al. (BAT).

Sources: [S] Slim et al., Robotics 2023, 12, 38, Algorithm 1, Eqs. 5-10, Table 1; [K] Kanagaraj,
Sheik Masthan, Yu, MENDEL 2022, 28(1), 41-54, Eqs. 4-9; Yang, "A New Metaheuristic Bat-Inspired
Algorithm", 2010, for what they leave open.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.ik.metaheuristics.bounds import bound, bound_flight
from ikplan.ik.metaheuristics.draw import signed
from ikplan.ik.metaheuristics.population import (
    Outcome,
    Problem,
    best_of,
    consider,
    end_iteration,
    initial_population,
    new_outcome,
)

__all__ = ["BatParams", "bat"]


class BatParams(NamedTuple):
    """Parameters of the bat algorithm.

    Attributes:
        fmin: Smallest frequency, Eq. 5 of [S].
        fmax: Largest frequency.
        alpha: Factor of the loudness, Eq. 9 (omega in [K]).
        gamma: Rate at which the pulse rate rises, Eq. 10.
        A_low: Smallest initial loudness.
        A_high: Largest initial loudness.
        r0_low: Smallest limit of the pulse rate.
        r0_high: Largest limit of the pulse rate.
        sign: 0 "attract": bats fly towards x*; 1 "literal": away from it, as Eq. 6 is printed.
        accept: 0 "own": compare with the bat's own value; 1 "best": with f*, as printed in [S].
        decay: 0 "accept": loudness and pulse rate change on acceptance only; 1 "iteration": once
            every iteration.
    """

    fmin: float
    fmax: float
    alpha: float
    gamma: float
    A_low: float
    A_high: float
    r0_low: float
    r0_high: float
    sign: int
    accept: int
    decay: int


@kernel
def bat(problem: Problem, params: BatParams, rng: np.random.Generator) -> Outcome:
    """Search with the bat algorithm.

    Symbols: ``X`` and ``V`` positions and velocities of the bats, ``x*`` the best position, ``A``
    the loudness and ``r`` the pulse rate of each bat, ``r0`` its limit, ``eps`` the noise.
    """
    objective, lower, upper = problem.objective, problem.lower, problem.upper
    out = new_outcome(problem, problem.population)
    if initial_population(problem, out, rng):
        return out
    best = best_of(out)
    X, F = out.X, out.F
    N, D = X.shape
    V = np.zeros((N, D))
    Y = np.empty(D)
    A, r, r0 = np.empty(N), np.zeros(N), np.empty(N)
    for i in range(N):
        A[i] = params.A_low + rng.random() * (params.A_high - params.A_low)
    for i in range(N):
        r0[i] = params.r0_low + rng.random() * (params.r0_high - params.r0_low)
    sign = 1.0 if params.sign == 1 else -1.0
    for t in range(1, problem.iterations + 1):
        A_mean = A.mean()
        for i in range(N):
            frequency = params.fmin + (params.fmax - params.fmin) * rng.random()  # (5)
            for k in range(D):
                V[i, k] += sign * (X[i, k] - best.x[k]) * frequency  # (6)
                Y[k] = X[i, k] + V[i, k]  # (7)
            bound_flight(Y, V[i], lower, upper, problem.bounds, rng)
            if rng.random() > r[i]:
                for k in range(D):
                    Y[k] = best.x[k] + signed(rng) * A_mean  # (8)
                bound(Y, lower, upper, problem.bounds, rng)
            rival = best.f[0] if params.accept == 1 else F[i]
            f = consider(objective, Y, best)
            accepted = rng.random() < A[i] and f < rival
            if accepted:
                X[i] = Y
                F[i] = f
            if accepted and params.decay == 0:
                A[i] *= params.alpha  # (9)
                r[i] = r0[i] * (1.0 - math.exp(-params.gamma * t))  # (10)
        if params.decay == 1:
            A *= params.alpha
            r[:] = r0 * (1.0 - math.exp(-params.gamma * t))
        if end_iteration(problem, out, t):
            break
    return out
