"""Whole runs against a second implementation that draws the same random numbers: to 1e-12."""

from __future__ import annotations

from typing import Any

import cma
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikplan.ik.baselines.cma_es import strategy_of
from ikplan.ik.baselines.eigen import eigen_into
from tests.ik.metaheuristics import second
from tests.ik.metaheuristics.runs import ROSENBROCK, SPHERE, problem, run

D = 4
Q_S = np.array([1.0, -0.5, 2.0, 4.9])


def value(kind: int) -> Any:
    def sphere(x: Any) -> float:
        return float(np.sum(x**2))

    def rosenbrock(x: Any) -> float:
        return float(np.sum(100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2))

    return sphere if kind == SPHERE else rosenbrock


def close(ours: Any, theirs: Any) -> None:
    np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


both = pytest.mark.parametrize("kind", [SPHERE, ROSENBROCK], ids=["sphere", "rosenbrock"])


@both
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"move": "guided"},
        {"fitness": "rank"},
        {"limit_factor": 0.2},  # scouts fly
    ],
    ids=str,
)
def test_abc(kind: int, options: dict[str, Any]) -> None:
    for seed in range(3):
        out = run("abc", problem(D, 12, 15, kind=kind), seed, **options)
        history, X = second.abc(value(kind), np.random.default_rng(seed), D, 12, 15, **options)
        close(out.history, history)
        close(out.X, X)


def test_scouts_flew() -> None:
    out = run("abc", problem(D, 12, 15), 0, limit_factor=0.2)
    assert out.evaluations[0] > 6 + 12 * 15


@both
@pytest.mark.parametrize("capacity", [200, 5])
def test_mo_pso(kind: int, capacity: int) -> None:
    for seed in range(3):
        task = problem(D, 15, 12, kind=kind, q_s=Q_S)
        out = run("mo-pso", task, seed, archive=capacity)
        history, X, kept = second.mo_pso(
            value(kind), np.random.default_rng(seed), Q_S, 15, 12, capacity=capacity
        )
        close(out.history, history)
        close(out.X, X)
        close(out.archive, [[*x, *g] for x, g in kept])


@both
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"beta": "bat"},
        {"loudness": "own"},
        {"noise": "bat"},
        {"record": "accepted"},
        {"rate": "zero"},
        {"reading": "shared"},
    ],
    ids=str,
)
def test_every_reading_of_the_bat_algorithm(kind: int, options: dict[str, Any]) -> None:
    for seed in range(3):
        out = run("ba", problem(D, 8, 12, kind=kind), seed, **options)
        history, X = second.bat(value(kind), np.random.default_rng(seed), D, 8, 12, **options)
        close(out.history, history)
        close(out.X, X)


@both
def test_l_shade(kind: int) -> None:
    N, T = 20, 30
    for seed in range(3):
        out = run("l-shade", problem(D, N, T, kind=kind), seed)
        spent, X = second.l_shade(value(kind), np.random.default_rng(seed), D, N * (T + 1))
        close(out.history, spent[N - 1 :: N])
        close(out.X, X)


@both
def test_cma_es(kind: int) -> None:
    N, T = 20, 15
    for seed in range(3):
        out = run("cma-es", problem(D, N, T, kind=kind), seed)
        spent = second.cma_es(value(kind), np.random.default_rng(seed), D, N * (T + 1))
        np.testing.assert_allclose(out.history, spent[N - 1 :: N], rtol=1e-9, atol=1e-12)


def test_cma_es_begins_again_with_twice_as_many() -> None:
    # On the sphere a run is over soon; a second one shows as candidates all over the box again.
    reach = [np.abs(run("cma-es", problem(2, 20, T), 1).X).max() for T in range(4, 60, 2)]
    converged = int(np.argmax(np.array(reach) < 1e-5))
    assert converged > 0
    assert max(reach[converged:]) > 0.5
    out = run("cma-es", problem(2, 20, 60), 1)
    spent = second.cma_es(value(SPHERE), np.random.default_rng(1), 2, 20 * 61)
    np.testing.assert_allclose(out.history, spent[19::20], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("n", [2, 6, 7, 30])
@pytest.mark.parametrize("growth", [1, 4])
def test_strategy_parameters_are_those_of_the_reference_code(n: int, growth: int) -> None:
    size = (4 + int(3 * np.log(n))) * growth
    ours = strategy_of(n, size)
    theirs = cma.CMAEvolutionStrategy(n * [0.0], 1.0, {"popsize": size, "verbose": -9}).sp
    assert ours.mu == theirs.weights.mu
    np.testing.assert_allclose(ours.mu_eff, theirs.weights.mueff)
    np.testing.assert_allclose(ours.w[: ours.mu], np.array(theirs.weights)[: ours.mu])
    np.testing.assert_allclose([ours.c_1, ours.c_mu], [theirs.c1, theirs.cmu])
    np.testing.assert_allclose(ours.c_c, theirs.cc)


def test_cma_es_needs_as_many_evaluations_as_the_reference_code() -> None:
    """To 1e-8 on Rosenbrock's function in six dimensions, without restarts on either side."""

    def theirs(seed: int) -> int:
        x0 = np.random.default_rng(seed).uniform(-5.0, 5.0, 6)
        options = {"seed": seed + 1, "verbose": -9, "ftarget": 1e-8, "maxfevals": 12_000}
        search = cma.CMAEvolutionStrategy(x0, 2.5, {**options, "bounds": [-5.0, 5.0]})
        search.optimize(value(ROSENBROCK))
        return int(search.result.evaluations)

    def ours(seed: int) -> int:
        out = run("cma-es", problem(6, 10, 1200, kind=ROSENBROCK, stop_value=1e-8), seed)
        return int(out.evaluations[0])

    ratio = np.median([ours(s) for s in range(15)]) / np.median([theirs(s) for s in range(15)])
    assert 0.75 < ratio < 1.3


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 9), power=st.integers(0, 6))
def test_eigenvalues_are_those_of_lapack(seed: int, n: int, power: int) -> None:
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n)) * 10.0 ** (power * rng.random(n))
    C = A @ A.T
    values, vectors = np.empty(n), np.empty((n, n))
    eigen_into(C, values, vectors)
    scale = float(np.linalg.norm(C))
    np.testing.assert_allclose(np.sort(values), np.linalg.eigvalsh(C), atol=1e-13 * scale * n)
    np.testing.assert_allclose(vectors @ np.diag(values) @ vectors.T, C, atol=1e-13 * scale * n)
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(n), atol=1e-13 * n)
