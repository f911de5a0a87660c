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
    seed: int,
    kind: int,
    N: int,
    T: int,
    variant: str = "local",
    noise: str = "uniform",
    accept: str = "greedy",
    eps_scale: float = 1.0,
    beta: str = "component",
    draws: str = "component",
) -> tuple[Any, list[float], int]:
    """Slim et al., Algorithm 2 and Eqs. 5-14; best position, its history, evaluations."""
    rng = np.random.default_rng(seed)
    D = len(Q_S)
    X = np.array([[LOW + rng.random() * (HIGH - LOW) for _ in range(D)] for _ in range(N)])
    X[0] = Q_S
    V = np.zeros((N, D))
    f_best, first = min((value(kind, x), tuple(x)) for x in X)
    best = np.array(first)
    history, evaluations = [f_best], N

    def consider(x: Any) -> None:
        nonlocal f_best, best, evaluations
        f = value(kind, x)
        evaluations += 1
        if f < f_best and (accept == "greedy" or rng.random() < A):
            f_best, best = f, x.copy()

    def draw(noise: str) -> float:
        if noise == "uniform":
            return 2.0 * rng.random() - 1.0
        eps = rng.standard_normal()
        while noise == "truncated" and abs(eps) > 1.0:
            eps = rng.standard_normal()
        return float(eps)

    for t in range(1, T + 1):
        A = 0.97**t  # (9), A0 = 1
        r = 1.0 - math.exp(-0.1 * t)  # (10), r0 = 1
        for i in range(N):
            if variant != "local":
                drawn = np.full(D, rng.random()) if beta == "bat" else rng.random(D)
                frequency = 2.0 * drawn  # (5)
                towards = X[i] - (best + Q_S) / 2.0
                V[i] = (
                    V[i] + (-towards if variant == "both_attract" else towards) * frequency
                )  # (13)
                flown = X[i] + V[i]  # (7)
                V[i] = np.where((flown < LOW) | (flown > HIGH), 0.0, V[i])
                X[i] = np.clip(flown, LOW, HIGH)
                consider(X[i])
            eps = np.array([draw(noise) for _ in range(1 if draws == "bat" else D)])
            placed = np.clip(r * best + (1.0 - r) * Q_S + eps_scale * eps * A, LOW, HIGH)  # (14)
            consider(placed)
            if variant == "overwritten":
                X[i] = placed
        history.append(f_best)
    return best, history, evaluations


@pytest.mark.parametrize("kind", [SPHERE, ROSENBROCK], ids=["sphere", "rosenbrock"])
@pytest.mark.parametrize(
    ("variant", "noise", "accept"),
    [
        *itertools.product(
            ["local", "both", "both_attract", "overwritten"],
            ["uniform", "normal", "truncated"],
            ["greedy", "loudness"],
        )
    ],
)
def test_a_run_is_that_of_the_equations(kind: int, variant: str, noise: str, accept: str) -> None:
    N, T = 6, 8
    for seed, eps_scale in ((1, 1.0), (2, 0.15)):
        task = problem(3, N, T, kind=kind, low=LOW, high=HIGH, q_s=Q_S, warm=1)
        options: dict[str, Any] = {
            "variant": variant,
            "noise": noise,
            "accept": accept,
            "eps_scale": eps_scale,
        }
        out = run("ik-ba", task, seed, **options)
        best, history, evaluations = reference(seed, kind, N, T, **options)
        np.testing.assert_allclose(out.x, best, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(out.history, history, rtol=1e-8)
        assert out.evaluations[0] == evaluations


@pytest.mark.parametrize("variant", ["local", "overwritten"])
@pytest.mark.parametrize(("beta", "draws"), [("bat", "component"), ("component", "bat")])
def test_one_random_number_a_bat(variant: str, beta: str, draws: str) -> None:
    task = problem(3, 6, 8, low=LOW, high=HIGH, q_s=Q_S, warm=1)
    options: dict[str, Any] = {"variant": variant, "beta": beta, "draws": draws}
    out = run("ik-ba", task, 3, **options)
    best, history, _ = reference(3, SPHERE, 6, 8, **options)
    np.testing.assert_allclose(out.x, best, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(out.history, history, rtol=1e-8)


def test_the_preset_is_the_noise_of_bat_code() -> None:
    task = problem(3, 6, 8, q_s=Q_S, warm=1)
    preset = run("ik-ba", task, 4, preset="bat-code")
    named = run("ik-ba", task, 4, noise="normal", eps_scale=0.1)
    np.testing.assert_array_equal(preset.history, named.history)
    assert not np.array_equal(preset.history, run("ik-ba", task, 4).history)


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
