"""One iteration of each search, written a second time, in plain NumPy from the equations.

Each takes the generator in the order in which the search takes it, the first population and its
values, and returns the population after the iteration. ``f`` is the sphere, bounds are [-5, 5].
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

LOW, HIGH = -5.0, 5.0


def f(x: Any) -> float:
    return float(np.sum(np.asarray(x) ** 2))


def start(rng: np.random.Generator, n: int, d: int) -> tuple[Any, Any]:
    X = LOW + rng.random((n, d)) * (HIGH - LOW)
    return X, np.array([f(x) for x in X])


def clip(x: Any) -> Any:
    return np.clip(x, LOW, HIGH)


def others(rng: np.random.Generator, n: int, j: int, count: int) -> list[int]:
    drawn: list[int] = []
    while len(drawn) < count:
        i = int(rng.random() * n)
        if i != j and i not in drawn:
            drawn.append(i)
    return drawn


def crossed(rng: np.random.Generator, x: Any, v: Any, CR: float) -> Any:
    k_rand = int(rng.random() * len(x))
    take = [rng.random() < CR or k == k_rand for k in range(len(x))]
    return np.where(take, v, x)


def ik_ba(rng: np.random.Generator, X: Any, q_s: Any, eps_scale: float = 1.0) -> Any:
    values = np.array([f(x) for x in X])
    best, f_best = X[values.argmin()].copy(), values.min()
    A, r = 0.97, 1.0 - math.exp(-0.1)
    Y = np.empty_like(X)
    for i in range(len(X)):
        eps = eps_scale * (2.0 * rng.random(X.shape[1]) - 1.0)
        Y[i] = clip(r * best + (1.0 - r) * q_s + eps * A)
        if f(Y[i]) < f_best:
            best, f_best = Y[i].copy(), f(Y[i])
    return Y


def bat(rng: np.random.Generator, X: Any, F: Any) -> Any:
    """Slim's BA: frequency in [0, 2], loudness in [0, 1), r = 0 in the first iteration."""
    n, d = X.shape
    best, f_best = X[F.argmin()].copy(), F.min()
    A = rng.random(n)
    rng.random(n)  # the limits of the pulse rates, all 0.001
    mean = A.mean()
    X = X.copy()
    for i in range(n):
        frequency = 2.0 * rng.random()
        Y = clip(X[i] - (X[i] - best) * frequency)
        if rng.random() > 0.0:
            Y = clip(best + (2.0 * rng.random(d) - 1.0) * mean)
        accepted = f(Y) < F[i]
        if f(Y) < f_best:
            best, f_best = Y.copy(), f(Y)
        if rng.random() < A[i] and accepted:
            X[i] = Y
    return X


def de(rng: np.random.Generator, X: Any, F: Any, strategy: str, s: float, lam: float) -> Any:
    n = len(X)
    best = X[F.argmin()]
    after = X.copy()
    for j in range(n):
        if strategy == "rand-1":
            r1, r2, r3 = others(rng, n, j, 3)
            v = X[r1] + s * (X[r2] - X[r3])
        elif strategy == "best-1":
            r1, r2 = others(rng, n, j, 2)
            v = best + s * (X[r2] - X[r1])
        elif strategy == "best-2":
            r1, r2, r3, r4 = others(rng, n, j, 4)
            v = best + s * (X[r1] - X[r2]) + lam * (X[r3] - X[r4])
        elif strategy == "rand-2":
            r1, r2, r3, r4, r5 = others(rng, n, j, 5)
            v = X[r1] + s * (X[r2] - X[r3]) + lam * (X[r4] - X[r5])
        else:
            r1, r2 = others(rng, n, j, 2)
            v = X[j] + s * (best - X[j]) + lam * (X[r1] - X[r2])
        u = clip(crossed(rng, X[j], v, 0.5))
        if f(u) < F[j]:
            after[j] = u
    return after


def sde(rng: np.random.Generator, X: Any, F: Any, fixed: float | None = None) -> Any:
    """Omran's SDE; ``fixed``: the first factors, in place of those drawn."""
    n = len(X)
    scales = np.full(n, fixed)
    if fixed is None:
        scales = np.array([0.5 + 0.15 * rng.standard_normal() for _ in range(n)])
    after = X.copy()
    for j in range(n):
        r1, r2, r3 = others(rng, n, j, 3)
        r4, r5, r6 = others(rng, n, j, 3)
        s = abs(scales[r4] + 0.5 * rng.standard_normal() * (scales[r5] - scales[r6]))
        CR = min(max(0.5 + 0.15 * rng.standard_normal(), 0.0), 1.0)
        u = clip(crossed(rng, X[j], X[r1] + s * (X[r2] - X[r3]), CR))
        if f(u) < F[j]:
            after[j] = u
    return after


def best_half(X: Any, opposite: Any) -> Any:
    both = np.vstack([X, opposite])
    order = np.argsort([f(x) for x in both], kind="stable")
    return both[order[: len(X)]]


def ode(rng: np.random.Generator, X: Any, jumps: bool) -> Any:
    X = best_half(X, LOW + HIGH - X)
    X = de(rng, X, np.array([f(x) for x in X]), "rand-1", 0.9, 0.0)
    if jumps:
        X = best_half(X, X.min(axis=0) + X.max(axis=0) - X)
    return X


def pso(
    rng: np.random.Generator,
    P: Any,
    F: Any,
    w: float,
    c1: float,
    c2: float,
    scalar: bool = False,
) -> Any:
    """The particles' best positions; the first step starts at rest, at the best positions."""
    n, d = P.shape
    best, f_best = P[F.argmin()].copy(), F.min()
    after = P.copy()
    for i in range(n):
        draws = np.tile(rng.random(2), (d, 1)) if scalar else rng.random((d, 2))
        V = w * 0.0 + c1 * draws[:, 0] * 0.0 + c2 * draws[:, 1] * (best - P[i])
        limit = 0.5 * (HIGH - LOW)
        x = clip(P[i] + np.clip(V, -limit, limit))
        if f(x) < F[i]:
            after[i] = x
        if f(x) < f_best:
            best, f_best = x.copy(), f(x)
    return after


def abc(rng: np.random.Generator, X: Any, F: Any) -> Any:
    n, d = X.shape
    X, F = X.copy(), F.copy()
    fitness = np.zeros(n)
    for bee in range(2 * n):
        if bee == n:
            fitness = 1.0 / (1.0 + 1000.0 * F)
        i = bee
        if bee >= n:
            mark = rng.random() * fitness.sum()
            i = min(int(np.searchsorted(np.cumsum(fitness), mark, side="right")), n - 1)
        j = int(rng.random() * d)
        (k,) = others(rng, n, i, 1)
        v = X[i].copy()
        v[j] += (2.0 * rng.random() - 1.0) * (X[i, j] - X[k, j])
        v = clip(v)
        if f(v) < F[i]:
            X[i], F[i] = v, f(v)
    return X


def gsa(rng: np.random.Generator, X: Any, F: Any, iterations: int) -> Any:
    """Positions after the first of ``iterations`` moves."""
    n, d = X.shape
    m = (F - F.max()) / (F.min() - F.max())
    M = m / m.sum()
    G = 100.0 * math.exp(-1.0 / iterations)
    K = max(round(n * (1.0 - 0.98 / iterations)), 1)
    heaviest = np.argsort(F, kind="stable")[:K]
    after = np.empty_like(X)
    for i in range(n):
        a = np.zeros(d)
        for k in heaviest:
            if k != i:
                apart = X[k] - X[i]
                a += rng.random(d) * G * M[k] * apart / (np.linalg.norm(apart) + 2.0**-52)
        draws = rng.random(d)
        after[i] = clip(X[i] + draws * 0.0 + a)
    return after


def woa(rng: np.random.Generator, X: Any, F: Any, iterations: int, b: float) -> Any:
    n = len(X)
    best, f_best = X[F.argmin()].copy(), F.min()
    X = X.copy()
    a1, a2 = 2.0 - 2.0 / iterations, -1.0 - 1.0 / iterations
    for i in range(n):
        A, C = 2.0 * a1 * rng.random() - a1, 2.0 * rng.random()
        turn, p = (a2 - 1.0) * rng.random() + 1.0, rng.random()
        if p < 0.5:
            ref = best if abs(A) < 1.0 else X[int(rng.random() * n)]
            x = ref - A * abs(C * ref - X[i])
        else:
            x = abs(best - X[i]) * math.exp(b * turn) * math.cos(2.0 * math.pi * turn) + best
        X[i] = clip(x)
        if f(X[i]) < f_best:
            best, f_best = X[i].copy(), f(X[i])
    return X


def mantegna(rng: np.random.Generator) -> float:
    u = 0.6965745025576968 * rng.standard_normal()
    return float(u / abs(rng.standard_normal()) ** (1.0 / 1.5))


def order(rng: np.random.Generator, n: int) -> list[int]:
    drawn = list(range(n))
    for i in range(n):
        j = i + int(rng.random() * (n - i))
        drawn[i], drawn[j] = drawn[j], drawn[i]
    return drawn


def walk(rng: np.random.Generator, X: Any, Pa: float) -> Any:
    n, d = X.shape
    a, b = order(rng, n), order(rng, n)
    after = X.copy()
    for i in range(n):
        step = rng.random()
        K = rng.random(d) > Pa
        y = clip(X[i] + K * step * (X[a[i]] - X[b[i]]))
        if f(y) < f(X[i]):
            after[i] = y
    return after


def cs(rng: np.random.Generator, X: Any, F: Any, normal_factor: bool = False) -> Any:
    n, d = X.shape
    best = X[F.argmin()]
    after = X.copy()
    for i in range(n):
        y = X[i].copy()
        for k in range(d):
            step = mantegna(rng) * 0.01 * (X[i, k] - best[k])
            y[k] += step * (rng.standard_normal() if normal_factor else 1.0)
        y = clip(y)
        if f(y) < F[i]:
            after[i] = y
    return walk(rng, after, 0.25)
