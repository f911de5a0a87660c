"""IK-BA: the bat algorithm with the start configuration in its update.

Source: [S] Slim, Rokbani, Neji, Terres, Beyrouthy, "Inverse Kinematic Solver Based on Bat Algorithm
for Robotic Arm Path Planning", Robotics 2023, 12, 38, section 4.2, Algorithm 2, Table 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.ik.metaheuristics.search import (
    Outcome,
    Problem,
    clip_into,
    end_iteration,
    initial_population,
    new_outcome,
    record,
)
from ikplan.ik.objective import evaluate

__all__ = ["IkBaParams", "ik_ba"]

VARIANTS = ("local", "both", "both_attract")
NOISES = ("uniform", "normal")
ACCEPTS = ("greedy", "loudness")


class IkBaParams(NamedTuple):
    """Parameters of IK-BA, [S] Table 1.

    Attributes:
        fmin: Smallest frequency.
        fmax: Largest frequency.
        alpha: Factor of the loudness per iteration, Eq. 9.
        gamma: Rate at which the pulse rate rises, Eq. 10.
        A0: Loudness before the first iteration.
        r0: Asymptote of the pulse rate.
        eps_scale: Factor of the noise of Eq. 14; 1 is the literal reading, 0.15 calibrated.
        noise: 0 uniform in [-1, 1), 1 standard normal.
        variant: 0 "local" evaluates Eq. 14 only; 1 "both" evaluates Eqs. 7 and 13 as well, as
            printed; 2 "both_attract" the same with the sign of Eq. 13 turned.
        accept: 0 "greedy" keeps every better candidate; 1 "loudness" only with probability A.
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


@kernel
def ik_ba(problem: Problem, params: IkBaParams, rng: np.random.Generator) -> Outcome:
    """Search with IK-BA.

    Symbols: ``X`` and ``V`` positions and velocities of the bats, ``x*`` the best position, ``q_s``
    the start configuration, ``A`` the loudness, ``r`` the pulse rate, ``eps`` the noise.
    """
    lower, upper, q_s = problem.lower, problem.upper, problem.q_s
    out = new_outcome(problem)
    if initial_population(problem, out, rng):
        return out
    X, F = out.X, out.F
    N, D = X.shape
    V = np.zeros((N, D))
    Y = X.copy()  # the bats that fly by Eqs. 7 and 13
    candidate = np.empty(D)
    sign = 1.0 if params.variant == 1 else -1.0
    for t in range(1, problem.iterations + 1):
        A = params.alpha**t * params.A0  # (9)
        r = params.r0 * (1.0 - math.exp(-params.gamma * t))  # (10)
        for i in range(N):
            if params.variant != 0:
                frequency = params.fmin + (params.fmax - params.fmin) * rng.random()  # (5)
                for k in range(D):
                    pull = Y[i, k] - 0.5 * (out.x[k] + q_s[k])
                    V[i, k] += sign * pull * frequency  # (13)
                    Y[i, k] += V[i, k]  # (7)
                    if Y[i, k] < lower[k] or Y[i, k] > upper[k]:
                        Y[i, k] = min(max(Y[i, k], lower[k]), upper[k])
                        V[i, k] = 0.0
                f = evaluate(problem.objective, Y[i])
                _consider(out, Y[i], f, A, params.accept, rng)
            for k in range(D):
                eps = rng.standard_normal() if params.noise == 1 else 2.0 * rng.random() - 1.0
                eps *= params.eps_scale
                candidate[k] = r * out.x[k] + (1.0 - r) * q_s[k] + eps * A  # (14)
            clip_into(candidate, lower, upper)
            f = evaluate(problem.objective, candidate)
            X[i] = candidate
            F[i] = f
            _consider(out, candidate, f, A, params.accept, rng)
        if end_iteration(problem, out, t):
            break
    return out


@kernel
def _consider(
    out: Outcome, x: np.ndarray, f: float, A: float, accept: int, rng: np.random.Generator
) -> None:
    """Count the candidate; make it the best if it is better and, under "loudness", drawn."""
    if accept == 1 and not (f < out.f[0] and rng.random() < A):
        out.evaluations[0] += 1
        return
    record(out, x, f)
