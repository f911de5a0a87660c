"""Every option of IK-BA, over whole runs, against the equations written a second time."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from .metaheuristics.runs import ROSENBROCK, SPHERE, problem, run

LOW, HIGH = -2.0, 3.0
Q_S = np.array([0.7, -1.1, 2.9])


def value(kind: int, x: Any) -> float:
    if kind == SPHERE:
        return float(np.sum(x**2))
    return float(np.sum(100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2))


def reference(
    seed: int, kind: int, N: int, T: int, variant: str, noise: str, accept: str, eps_scale: float
) -> tuple[Any, list[float], int]:
    """Slim et al., Algorithm 2 and Eqs. 5-14; best position, its history, evaluations."""
    rng = np.random.default_rng(seed)
    D = len(Q_S)
    X = np.array([[LOW + rng.random() * (HIGH - LOW) for _ in range(D)] for _ in range(N)])
    X[0] = Q_S
    V = np.zeros((N, D))
    f_best, best = min((value(kind, x), tuple(x)) for x in X)
    best = np.array(best)
    history, evaluations = [f_best], N

    def consider(x: Any) -> None:
        nonlocal f_best, best, evaluations
        f = value(kind, x)
        evaluations += 1
        if f < f_best and (accept == "greedy" or rng.random() < A):
            f_best, best = f, x.copy()

    for t in range(1, T + 1):
        A = 0.97**t  # (9), A0 = 1
        r = 1.0 - math.exp(-0.1 * t)  # (10), r0 = 1
        for i in range(N):
            if variant != "local":
                frequency = 2.0 * rng.random()  # (5)
                towards = X[i] - (best + Q_S) / 2.0
                V[i] = V[i] + (towards if variant == "both" else -towards) * frequency  # (13)
                flown = X[i] + V[i]  # (7)
                V[i] = np.where((flown < LOW) | (flown > HIGH), 0.0, V[i])
                X[i] = np.clip(flown, LOW, HIGH)
                consider(X[i])
            if noise == "uniform":
                eps = np.array([2.0 * rng.random() - 1.0 for _ in range(D)])
            else:
                eps = np.array([rng.standard_normal() for _ in range(D)])
            consider(np.clip(r * best + (1.0 - r) * Q_S + eps_scale * eps * A, LOW, HIGH))  # (14)
        history.append(f_best)
    return best, history, evaluations


@pytest.mark.parametrize("kind", [SPHERE, ROSENBROCK], ids=["sphere", "rosenbrock"])
@pytest.mark.parametrize(
    ("variant", "noise", "accept"),
    [
        *itertools.product(
            ["local", "both", "both_attract"], ["uniform", "normal"], ["greedy", "loudness"]
        )
    ],
)
def test_a_run_is_that_of_the_equations(kind: int, variant: str, noise: str, accept: str) -> None:
    N, T = 6, 8
    for seed, eps_scale in ((1, 1.0), (2, 0.15)):
        task = problem(3, N, T, kind=kind, low=LOW, high=HIGH, q_s=Q_S, warm=1)
        options = {"variant": variant, "noise": noise, "accept": accept, "eps_scale": eps_scale}
        out = run("ik-ba", task, seed, **options)
        best, history, evaluations = reference(seed, kind, N, T, **options)
        np.testing.assert_allclose(out.x, best, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(out.history, history, rtol=1e-8)
        assert out.evaluations[0] == evaluations


def test_the_papers_budget_is_10050_evaluations() -> None:
    out = run("ik-ba", problem(3, 50, 200))
    assert out.evaluations[0] == 10_050
    assert out.history_evaluations[1] == 100
    assert out.iterations[0] == 200


def test_greedy_acceptance_reaches_further_than_the_loudness_does() -> None:
    """Spec: gated by the loudness, the best hardly changes once the loudness has vanished."""
    task = problem(3, 30, 500)
    greedy = np.median([run("ik-ba", task, s).f[0] for s in range(9)])
    gated = np.median([run("ik-ba", task, s, accept="loudness").f[0] for s in range(9)])
    assert greedy < 1e-9 < gated
