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
from ikplan.arrays import Array
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
        beta: 0 "bat": one random number a bat in Eq. 5; 1 "component": a vector, as [S] prints.
        loudness: 0 "mean": A^t of Eq. 8 is the mean over the bats, as [K] says; 1 "own": A_i.
        noise: 0 "component": eps of Eq. 8 is drawn for every component; 1 "bat": one number, as
            [K] prints.
        record: 0 "always": x* is the best candidate seen; 1 "accepted": only a candidate that
            passes the test of the loudness becomes x*, as Algorithm 1 of [S] is printed.
        rate: The pulse rate before a bat's first move: 0 "zero", as Eq. 10 gives it; 1 "limit": r0.
        reading: 0 "printed"; 1 "shared": as circulating bat code has it. One loudness and one pulse
            rate for all bats, which change in every iteration; the walk x* + 0.1 N(0, 1) A where
            U < r; moves kept where U > A.
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
    beta: int
    loudness: int
    noise: int
    record: int
    rate: int
    reading: int


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
    if params.rate == 1:
        r[:] = r0
    shared = params.reading == 1
    trial = best if params.record == 0 else Best(np.empty(D), np.full(1, np.inf), out.evaluations)
    sign = 1.0 if params.sign == 1 else -1.0
    for t in range(1, problem.iterations + 1):
        if shared or (params.decay == 1 and t > 1):
            _quieten(A, r, r0, params, t if shared else t - 1)
        A_mean = A.mean()
        for i in range(N):
            beta = rng.random()  # (5)
            for k in range(D):
                if params.beta == 1 and k > 0:
                    beta = rng.random()
                frequency = params.fmin + (params.fmax - params.fmin) * beta
                V[i, k] += sign * (X[i, k] - best.x[k]) * frequency  # (6)
                Y[k] = X[i, k] + V[i, k]  # (7)
            bound_flight(Y, V[i], lower, upper, problem.bounds, rng)
            draw = rng.random()
            if (draw < r[i]) if shared else (draw > r[i]):
                _walk(best.x, A[i] if params.loudness == 1 else A_mean, params, Y, rng)  # (8)
                bound(Y, lower, upper, problem.bounds, rng)
            rival = best.f[0] if params.accept == 1 else F[i]
            if params.record == 1:
                trial.f[0] = np.inf
            f = consider(objective, Y, trial)
            draw = rng.random()
            accepted = f < rival and (draw > A[i] if shared else draw < A[i])
            if accepted:
                X[i] = Y
                F[i] = f
            if accepted and params.record == 1 and f < best.f[0]:
                best.f[0] = f
                best.x[:] = Y
            if accepted and params.decay == 0 and not shared:
                A[i] *= params.alpha  # (9)
                r[i] = r0[i] * (1.0 - math.exp(-params.gamma * t))  # (10)
        if end_iteration(problem, out, t):
            break
    return out


@kernel
def _quieten(A: Array, r: Array, r0: Array, params: BatParams, t: int) -> None:
    """Lower the loudness of every bat and raise its pulse rate, Eqs. 9 and 10."""
    for i in range(A.shape[0]):
        A[i] *= params.alpha
        r[i] = r0[i] * (1.0 - math.exp(-params.gamma * t))


@kernel
def _walk(x_best: Array, A: float, params: BatParams, Y: Array, rng: np.random.Generator) -> None:
    """Write a step of the random walk around x*, Eq. 8."""
    if params.reading == 1:
        for k in range(Y.shape[0]):
            Y[k] = x_best[k] + 0.1 * rng.standard_normal() * A
        return
    eps = signed(rng)
    for k in range(Y.shape[0]):
        if params.noise == 0 and k > 0:
            eps = signed(rng)
        Y[k] = x_best[k] + eps * A
