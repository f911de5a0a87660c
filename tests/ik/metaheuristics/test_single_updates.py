"""Each search's update, against the same equations written a second time from the same numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ikplan.ik.metaheuristics.bode_cs import bode_mutant
from ikplan.ik.metaheuristics.genetic import cross
from ikplan.ik.metaheuristics.gravitational import masses_into
from tests.ik.metaheuristics import references as ref
from tests.ik.metaheuristics.runs import problem, run

N, D = 7, 3


def first(seed: int, n: int = N) -> tuple[np.random.Generator, np.ndarray, np.ndarray]:
    """The generator after the first population, and that population."""
    rng = np.random.default_rng(seed)
    X, F = ref.start(rng, n, D)
    return rng, X, F


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("eps_scale", [1.0, 0.15])
def test_ik_ba_follows_equation_14(seed: int, eps_scale: float) -> None:
    rng, X, _ = first(seed)
    q_s = np.array([0.5, -0.2, 4.9])
    out = run("ik-ba", problem(D, N, 1, q_s=q_s), seed, eps_scale=eps_scale)
    np.testing.assert_allclose(out.X, ref.ik_ba(rng, X, q_s, eps_scale), rtol=1e-12)


def test_ik_ba_by_hand() -> None:
    # One bat, q_s = x0 = 2, in one dimension: r drops out of (14), and x = 2 + 0.97 eps.
    rng = np.random.default_rng(5)
    rng.random()
    eps = 2.0 * rng.random() - 1.0
    out = run("ik-ba", problem(1, 1, 1, q_s=[2.0], warm=1), 5)
    assert out.X[0, 0] == pytest.approx(2.0 + 0.97 * eps, rel=1e-14)


def test_loudness_keeps_ik_ba_from_its_best_candidate() -> None:
    # With A0 = 0 no candidate is ever accepted, however good.
    quiet = run("ik-ba", problem(D, N, 20), accept="loudness", A0=0.0)
    assert quiet.history[-1] == quiet.history[0]


@pytest.mark.parametrize("seed", range(3))
def test_ba_follows_equations_6_to_10(seed: int) -> None:
    rng, X, F = first(seed)
    out = run("ba", problem(D, N, 1), seed, beta="bat", rate="zero")
    np.testing.assert_allclose(out.X, ref.bat(rng, X, F), rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("strategy", ["rand-1", "best-1", "best-2", "rand-2", "current-to-best-1"])
def test_each_strategy_of_differential_evolution(strategy: str, seed: int) -> None:
    rng, X, F = first(seed)
    out = run(f"de-{strategy}", problem(D, N, 1), seed)
    np.testing.assert_allclose(out.X, ref.de(rng, X, F, strategy, 0.9, 0.1), rtol=1e-12)


def test_presets_of_rand_1_are_the_papers() -> None:
    rng, X, F = first(1)
    out = run("de-rand-1", problem(D, N, 1), 1, preset="slim", CR=0.5)
    np.testing.assert_allclose(out.X, ref.de(rng, X, F, "rand-1", 0.6, 0.1), rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_sde_adapts_its_factors(seed: int) -> None:
    rng, X, F = first(seed)
    out = run("sde", problem(D, N, 1), seed, F_initial="normal")
    np.testing.assert_allclose(out.X, ref.sde(rng, X, F), rtol=1e-12)
    rng, X, F = first(seed)
    out = run("sde", problem(D, N, 1), seed)
    np.testing.assert_allclose(out.X, ref.sde(rng, X, F, 0.9), rtol=1e-12)


@pytest.mark.parametrize("Jr", [0.0, 1.0])
def test_ode_jumps_to_its_opposites(Jr: float) -> None:
    rng, X, _ = first(4)
    out = run("ode", problem(D, N, 1), 4, Jr=Jr)
    np.testing.assert_allclose(out.X, ref.ode(rng, X, jumps=Jr == 1.0), rtol=1e-12)


@pytest.mark.parametrize(
    ("preset", "w", "c1", "c2", "scalar"),
    [
        ("slim", 1.1312, 2.0149, 0.53514, False),
        ("slim-permuted", 0.53514, 1.1312, 2.0149, False),
        ("kanagaraj", 0.3033, 2.4, 3.2, True),
        ("li", 0.9, 1.2, 1.2, False),
    ],
)
def test_pso_with_each_papers_parameters(
    preset: str, w: float, c1: float, c2: float, scalar: bool
) -> None:
    rng, X, F = first(2)
    out = run("pso", problem(D, N, 1), 2, preset=preset)
    np.testing.assert_allclose(out.X, ref.pso(rng, X, F, w, c1, c2, scalar), rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_abc_employed_and_onlooker_bees(seed: int) -> None:
    rng, X, F = first(seed)
    out = run("abc", problem(D, 2 * N, 1), seed)
    np.testing.assert_allclose(out.X, ref.abc(rng, X, F), rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_gsa_follows_equations_10_to_18(seed: int) -> None:
    rng, X, F = first(seed)
    out = run("gsa", problem(D, N, 2), seed)
    # The second iteration evaluates what the first one moved.
    np.testing.assert_allclose(out.X, ref.gsa(rng, X, F, 2), rtol=1e-12)


def test_masses_of_gsa_by_hand() -> None:
    M = np.empty(3)
    masses_into(np.array([1.0, 3.0, 2.0]), M)
    np.testing.assert_allclose(M, [2.0 / 3.0, 0.0, 1.0 / 3.0])
    masses_into(np.array([2.0, 2.0, 2.0]), M)
    np.testing.assert_allclose(M, 1.0 / 3.0)


@pytest.mark.parametrize("seed", [2, 6, 7, 11])
def test_woa_encircles_explores_and_spirals(seed: int) -> None:
    """The first of four iterations: a1 = 1.5, so that some whales explore."""
    rng, X, F = first(seed)
    expected = ref.woa(rng, X, F, 4, 5.0)
    after = min(ref.f(x) for x in expected)
    assert after < F.min(), "choose a seed whose first iteration finds something better"
    # A stop value between the two bests ends the search after that iteration.
    out = run("woa", problem(D, N, 4, stop_value=0.5 * (after + F.min())), seed)
    assert out.iterations[0] == 1
    np.testing.assert_allclose(out.X, expected, rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_cs_levy_step_and_abandonment(seed: int) -> None:
    for factor in (False, True):
        rng, X, F = first(seed)
        out = run("cs", problem(D, N, 1), seed, normal_factor=factor)
        np.testing.assert_allclose(out.X, ref.cs(rng, X, F, factor), rtol=1e-12)


def test_blend_crossover_stays_within_its_reach() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        a, b = np.array([1.0, -2.0]), np.array([3.0, 0.0])
        cross(a, b, 0.5, rng)
        for child in (a, b):
            assert 0.0 <= child[0] <= 4.0
            assert -3.0 <= child[1] <= 1.0


def test_ga_copies_its_elite_and_draws_the_rest_from_parents() -> None:
    rng, X, F = first(3)
    # Neither crossover nor mutation: the children are parents, the best one first.
    out = run("ga", problem(D, N, 1), 3, Pc=0.0, Pm=0.0)
    np.testing.assert_array_equal(out.X[0], X[F.argmin()])
    assert all(np.equal(X, child).all(axis=1).any() for child in out.X)
    winners = []
    for _ in range(N - 1 + (N - 1) % 2):
        a, b = int(rng.random() * N), int(rng.random() * N)
        winners.append(b if F[b] < F[a] else a)
        if len(winners) % 2 == 0:
            rng.random()  # whether to cross the pair
    np.testing.assert_array_equal(out.X[1:], X[winners[: N - 1]])


# BODE-CS: at s = 0, b1 = 0.9, b2 = 0.65, c1 = 0.65 + 0.25/3, c2 = 0.65 + 1.25/6.
SWARM = np.array([[1.0, 2.0], [3.0, -1.0], [0.5, 0.5], [-2.0, 4.0]])
BEST = np.array([0.25, -0.5])


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (0.95, BEST + 0.4 * (SWARM[1] - SWARM[2]) + 0.1 * (BEST - SWARM[3])),
        (0.80, SWARM[0] + 0.4 * (SWARM[1] - SWARM[2]) + 0.1 * (BEST - SWARM[3])),
        (0.70, BEST - 0.4 * (SWARM[1] - SWARM[2]) - 0.1 * (BEST - SWARM[3])),
        (0.10, SWARM[1] + 0.4 * (SWARM[2] - SWARM[3]) + 0.1 * (BEST - SWARM[1])),
    ],
)
def test_bode_draws_its_strategy_by_equation_27(draw: float, expected: np.ndarray) -> None:
    v = np.empty(2)
    assert bode_mutant(SWARM, 0, np.array([1, 2, 3]), BEST, 0.4, 0.1, 0.0, draw, v)
    np.testing.assert_allclose(v, expected, rtol=1e-14)


def test_bode_strategies_have_the_probabilities_of_equation_27() -> None:
    v, r = np.empty(2), np.array([1, 2, 3])
    grid = (np.arange(200_000) + 0.5) / 200_000
    for s, opposition in ((0.0, 0.25 / 6.0), (1.0, 0.25 / 6.0)):
        share = np.mean([not bode_mutant(SWARM, 0, r, BEST, 0.4, 0.1, s, d, v) for d in grid[::50]])
        assert share == pytest.approx(opposition, abs=5e-4)


def halton_start() -> tuple[np.ndarray, np.ndarray]:
    """The better of each of six Halton points in the plane and its opposite."""
    points = [[1 / 2, 1 / 3], [1 / 4, 2 / 3], [3 / 4, 1 / 9], [1 / 8, 4 / 9], [5 / 8, 7 / 9]]
    points.append([3 / 8, 2 / 9])
    X = -5.0 + 10.0 * np.array(points)
    # On the sphere a point and its opposite are equal, and the point stays.
    return X, np.array([ref.f(x) for x in X])


@pytest.mark.parametrize("generation", ["in_place", "synchronous"])
def test_one_iteration_of_bode(generation: str) -> None:
    """The first iteration of BODE-CS for a seed that chooses BODE."""
    n, seed = 6, 1
    rng = np.random.default_rng(seed)
    X, F = halton_start()
    assert rng.random() >= ((F.mean() - F.min()) / F.max()) ** 2
    low, high = X.min(axis=0), X.max(axis=0)
    best = X[F.argmin()].copy()
    after, f_best = X, F.min()
    if generation == "synchronous":
        after = X.copy()
    for j in range(n):
        r1, r2, r3 = ref.others(rng, n, -1, 3)
        draw = rng.random()
        if 0.65 + 1.25 / 6.0 < draw <= 0.9:
            v = high + low - (1.0 - 0.05 * rng.random()) * X[j]
        elif draw > 0.9:
            v = best + 0.4 * (X[r1] - X[r2]) + 0.1 * (best - X[r3])
        elif draw > 0.65 + 0.25 / 3.0:
            v = X[j] + 0.4 * (X[r1] - X[r2]) + 0.1 * (best - X[r3])
        elif draw > 0.65:
            v = best - 0.4 * (X[r1] - X[r2]) - 0.1 * (best - X[r3])
        else:
            v = X[r1] + 0.4 * (X[r2] - X[r3]) + 0.1 * (best - X[r1])
        u = ref.clip(ref.crossed(rng, X[j], v, 0.5))
        if ref.f(u) < F[j]:
            after[j], F[j] = u, ref.f(u)
        if ref.f(u) < f_best:
            f_best = ref.f(u)
            best = u.copy() if generation == "in_place" else best
    out = run("bode-cs", problem(2, n, 1), seed, generation=generation)
    assert out.evaluations[0] == 3 * n
    np.testing.assert_allclose(out.X, after, rtol=1e-12)


@pytest.mark.parametrize("heaviside", [False, True])
def test_one_iteration_of_the_improved_cuckoo_search(heaviside: bool) -> None:
    """The first iteration of BODE-CS for a seed that chooses the cuckoo search."""
    n = 6
    X, F = halton_start()
    chance = ((F.mean() - F.min()) / F.max()) ** 2
    seed = next(s for s in range(100) if np.random.default_rng(s).random() < chance)
    rng = np.random.default_rng(seed)
    rng.random()
    best = X[F.argmin()].copy()

    def offer(j: int, y: np.ndarray) -> None:
        nonlocal best
        y = ref.clip(y)
        if ref.f(y) < ref.f(X[j]):
            X[j] = y
        if ref.f(y) < ref.f(best):
            best = y.copy()

    for j in range(n):
        a_s = 0.5 * (math.cos(2.0 * math.pi * rng.random()) + 1.0)
        step = np.empty(2)
        for k in range(2):
            step[k] = a_s * ref.mantegna(rng)
            if heaviside and rng.random() > 0.25:
                step[k] = 0.0
        offer(j, X[j] + 0.01 * step * (X[j] - best))
    X = ref.walk(rng, X, 0.25)
    F = np.array([ref.f(x) for x in X])
    best = min([best, *X], key=ref.f).copy()
    low, high = X.min(axis=0), X.max(axis=0)
    for j in range(n):
        if rng.random() < 0.2:
            offer(j, high + low - (1.0 - 0.05 * rng.random()) * X[j])
        if rng.random() < 0.15 * (F.max() - F.mean()) / (F.max() - F.min()):
            offer(j, 0.7 * X[j] + 0.3 * best)
    out = run("bode-cs", problem(2, n, 1), seed, heaviside=heaviside)
    assert 4 * n <= out.evaluations[0] <= 6 * n
    np.testing.assert_allclose(out.X, X, rtol=1e-12)


def test_one_generation_of_mo_pso() -> None:
    n, q_s = 6, np.array([1.0, 1.0, 1.0])
    rng, X, F = first(26, n)
    G = np.array([[f, np.linalg.norm(x - q_s)] for f, x in zip(F, X, strict=True)])
    front = [i for i in range(n) if not any((G[j] < G[i]).all() for j in range(n))]
    assert len(front) > 1, "choose a seed with more than one candidate"
    low, span = G[front].min(axis=0), np.ptp(G[front], axis=0)
    cells = [tuple(np.minimum((20 * (G[i] - low) / span).astype(int), 19)) for i in front]
    assert len(set(cells)) == len(front), "choose a seed with one candidate a cell"
    # Cells are drawn in order, all with weight 10; then one of one member.
    by_cell = sorted(zip(cells, front, strict=True))
    leader = X[by_cell[int(rng.random() * len(front))][1]]
    rng.random()
    V = np.empty_like(X)
    for i in range(n):
        draws = rng.random((D, 2))
        V[i] = 2.0 * draws[:, 1] * (leader - X[i])
    X = X + V
    # Of the second third (2, 3) one is drawn anew; the share of the last third is 0 at t = T.
    redrawn = 2 + int(rng.random() * 2)
    X[redrawn] = -5.0 + 10.0 * rng.random(D)
    out = run("mo-pso", problem(D, n, 1, q_s=q_s), 26)
    np.testing.assert_allclose(out.X, ref.clip(X), rtol=1e-12)
