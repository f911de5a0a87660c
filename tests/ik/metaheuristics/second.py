"""Whole runs of searches, written a second time in plain NumPy from the equations.

Each takes the generator in the order in which the search takes it. ``f`` is any function, bounds
are [-5, 5] in every dimension.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.ik.metaheuristics.references import HIGH, LOW, clip, others

Function = Callable[[Any], float]


def first(rng: np.random.Generator, n: int, d: int) -> Any:
    return LOW + rng.random((n, d)) * (HIGH - LOW)


def abc(
    f: Function,
    rng: np.random.Generator,
    d: int,
    N: int,
    T: int,
    *,
    move: str = "standard",
    fitness: str = "value",
    limit_factor: float = 1.0,
) -> tuple[list[float], Any]:
    """Karaboga and Basturk's bees; the history of the best, and the sources."""
    sources = N // 2
    X = first(rng, sources, d)
    F = np.array([f(x) for x in X])
    failures = np.zeros(sources, dtype=int)
    best, value = X[F.argmin()].copy(), F.min()
    history = [float(value)]

    def visit(i: int) -> None:
        nonlocal best, value
        j = int(rng.random() * d)
        (k,) = others(rng, sources, i, 1)
        v = X[i].copy()
        v[j] += (2.0 * rng.random() - 1.0) * (X[i, j] - X[k, j])
        if move == "guided":
            v[j] += 1.5 * rng.random() * (best[j] - X[i, j])
        v = clip(v)
        new = f(v)
        if new < value:
            best, value = v.copy(), new
        failures[i] = 0 if new < F[i] else failures[i] + 1
        if new < F[i]:
            X[i], F[i] = v, new

    for _ in range(T):
        for i in range(sources):
            visit(i)
        weights = 1.0 / (1.0 + 1000.0 * F)
        if fitness == "rank":
            weights = np.empty(sources)
            weights[np.argsort(F, kind="stable")] = sources - np.arange(sources)
        for _ in range(sources):
            mark = rng.random() * weights.sum()
            chosen = 0
            while chosen < sources - 1 and mark >= weights[chosen]:
                mark -= weights[chosen]
                chosen += 1
            visit(chosen)
        worst = int(failures.argmax())
        if failures[worst] > limit_factor * sources * d:
            X[worst] = first(rng, 1, d)[0]
            F[worst] = f(X[worst])
            failures[worst] = 0
            if F[worst] < value:
                best, value = X[worst].copy(), F[worst]
        history.append(float(value))
    return history, X


def _dominates(a: Any, b: Any) -> bool:
    return bool((a <= b).all() and (a < b).any())


def _archive(kept: list[Any], shown: list[Any], capacity: int) -> list[Any]:
    """Coello's repository: entries are (position, objectives)."""
    for x, g in shown:
        if any(_dominates(h, g) for _, h in kept):
            continue
        kept = [(y, h) for y, h in kept if not _dominates(g, h)] + [(x, g)]
    if len(kept) <= capacity:
        return kept
    G = np.array([g for _, g in kept])
    crowding = np.zeros(len(kept))
    for m in range(2):
        by = np.argsort(G[:, m], kind="stable")
        span = G[by[-1], m] - G[by[0], m]
        crowding[by[[0, -1]]] = np.inf
        if span > 0.0:
            crowding[by[1:-1]] += (G[by[2:], m] - G[by[:-2], m]) / span
    gone = set(np.argsort(crowding, kind="stable")[: len(kept) - capacity].tolist())
    return [entry for i, entry in enumerate(kept) if i not in gone]


def _leader(rng: np.random.Generator, kept: list[Any], grid: int) -> Any:
    G = np.array([g for _, g in kept])
    low, span = G.min(axis=0), np.ptp(G, axis=0)
    places = [
        tuple(
            min(int(grid * (g[m] - low[m]) / span[m]), grid - 1) if span[m] > 0.0 else 0
            for m in range(2)
        )
        for g in G
    ]
    cells = sorted(set(places))
    weights = [10.0 / places.count(cell) for cell in cells]
    mark = rng.random() * sum(weights)
    chosen = cells[-1]
    for cell, weight in zip(cells, weights, strict=True):
        mark -= weight
        if mark < 0.0:
            chosen = cell
            break
    members = [i for i, place in enumerate(places) if place == chosen]
    return kept[members[int(rng.random() * len(members))]][0].copy()


def mo_pso(
    f: Function, rng: np.random.Generator, q_s: Any, N: int, T: int, *, capacity: int = 200
) -> tuple[list[float], Any, list[Any]]:
    """Coello's MOPSO with the parameters of Slim et al.; history, swarm, archive."""
    d, third, most = len(q_s), N // 3, 0.05 * (HIGH - LOW)

    def objectives(x: Any) -> Any:
        return np.array([f(x), math.sqrt(float(((x - q_s) ** 2).sum()))])

    X = first(rng, N, d)
    V = np.zeros_like(X)
    P = [(x.copy(), objectives(x)) for x in X]
    kept = _archive([], [(x.copy(), g) for x, g in P], capacity)
    value = min(g[0] for _, g in P)
    history = [float(value)]
    for t in range(1, T + 1):
        h = _leader(rng, kept, 20)
        for i in range(N):
            draws = rng.random((d, 2))
            V[i] = (
                0.5 * V[i] + 2.0 * draws[:, 0] * (P[i][0] - X[i]) + 2.0 * draws[:, 1] * (h - X[i])
            )
            X[i] = X[i] + V[i]
        for part, share in ((1, 0.5), (2, (1.0 - t / T) ** (5 * d))):
            count, places = round(share * third), list(range(third))
            for m in range(count):
                j = m + int(rng.random() * (third - m))
                places[m], places[j] = places[j], places[m]
            for m in range(count):
                X[part * third + places[m]] = first(rng, 1, d)[0]
        shown = []
        for i in range(N):
            V[i] = np.clip(V[i], -most, most)
            V[i] = np.where((X[i] < LOW) | (X[i] > HIGH), -V[i], V[i])
            X[i] = clip(X[i])
            shown.append((X[i].copy(), objectives(X[i])))
            value = min(value, shown[-1][1][0])
        kept = _archive(kept, shown, capacity)
        for i, (x, g) in enumerate(shown):
            better = _dominates(g, P[i][1])
            if not better and not _dominates(P[i][1], g):
                better = rng.random() < 0.5
            if better:
                P[i] = (x, g)
        history.append(float(value))
    return history, X, kept


def bat(
    f: Function, rng: np.random.Generator, d: int, N: int, T: int, **o: Any
) -> tuple[list[float], Any]:
    """Slim's Algorithm 1; o: beta, loudness, noise, record, rate, reading."""
    X = first(rng, N, d)
    F = np.array([f(x) for x in X])
    V = np.zeros_like(X)
    A, r0 = rng.random(N), 0.001 + rng.random(N) * 0.0
    shared = o.get("reading") == "shared"
    r = r0.copy() if o.get("rate", "limit") == "limit" else np.zeros(N)
    best, value = X[F.argmin()].copy(), F.min()
    history = [float(value)]
    for t in range(1, T + 1):
        if shared:
            A, r = 0.5 * A, r0 * (1.0 - math.exp(-0.5 * t))
        mean = A.mean()
        for i in range(N):
            one = o.get("beta", "component") == "bat"
            beta = np.full(d, rng.random()) if one else rng.random(d)
            V[i] = V[i] - (X[i] - best) * 2.0 * beta
            y = X[i] + V[i]
            V[i] = np.where((y < LOW) | (y > HIGH), 0.0, V[i])
            y = clip(y)
            draw = rng.random()
            if (draw < r[i]) if shared else (draw > r[i]):
                loud = A[i] if o.get("loudness") == "own" else mean
                if shared:
                    y = clip(best + 0.1 * rng.standard_normal(d) * loud)
                elif o.get("noise") == "bat":
                    y = clip(best + (2.0 * rng.random() - 1.0) * loud)
                else:
                    y = clip(best + (2.0 * rng.random(d) - 1.0) * loud)
            new = f(y)
            improves = new < F[i]
            if o.get("record") != "accepted" and new < value:
                best, value = y.copy(), new
            draw = rng.random()
            if improves and ((draw > A[i]) if shared else (draw < A[i])):
                X[i], F[i] = y, new
                if o.get("record") == "accepted" and new < value:
                    best, value = y.copy(), new
                if not shared:
                    A[i] *= 0.5
                    r[i] = r0[i] * (1.0 - math.exp(-0.5 * t))
        history.append(float(value))
    return history, X


def l_shade(f: Function, rng: np.random.Generator, d: int, budget: int) -> tuple[list[float], Any]:
    """Tanabe's and Fukunaga's L-SHADE; the best after each evaluation, and the population."""
    n0 = max(min(round(18.0 * d), budget // 4), 4)
    X = first(rng, n0, d)
    F = np.array([f(x) for x in X])
    spent = list(np.minimum.accumulate(F))
    M_F, M_CR, place = [0.5] * 6, [0.5] * 6, 0
    archive: list[Any] = []
    while True:
        n = len(X)
        ranked = np.argsort(F, kind="stable")
        trials = []
        for i in range(n):
            r = int(rng.random() * 6)
            normal = rng.standard_normal()
            CR = 0.0 if M_CR[r] < 0.0 else min(max(M_CR[r] + 0.1 * normal, 0.0), 1.0)
            s = 0.0
            while s <= 0.0:
                s = M_F[r] + 0.1 * math.tan(math.pi * (rng.random() - 0.5))
            s = min(s, 1.0)
            guide = X[ranked[int(rng.random() * max(round(0.11 * n), 2))]]
            r1 = r2 = i
            while r1 == i:
                r1 = int(rng.random() * n)
            while r2 in (i, r1):
                r2 = int(rng.random() * (n + len(archive)))
            second = X[r2] if r2 < n else archive[r2 - n]
            k_rand = int(rng.random() * d)
            take = np.array([(rng.random() < CR) or k == k_rand for k in range(d)])
            u = np.where(take, X[i] + s * (guide - X[i]) + s * (X[r1] - second), X[i])
            u = np.where(u < LOW, 0.5 * (LOW + X[i]), np.where(u > HIGH, 0.5 * (HIGH + X[i]), u))
            new = f(u)
            spent.append(min(spent[-1], new))
            if len(spent) == budget:
                return [float(v) for v in spent], X[np.argsort(F, kind="stable")]
            trials.append((u, new, s, CR))
        room = max(round(2.6 * n), 1)
        gains: list[tuple[float, float, float]] = []
        for i, (u, new, s, CR) in enumerate(trials):
            if new < F[i]:
                gains.append((F[i] - new, s, CR))
                if len(archive) < room:
                    archive.append(X[i].copy())
                else:
                    archive[int(rng.random() * room)] = X[i].copy()
            if new <= F[i]:
                X[i], F[i] = u, new
        if gains:
            w, S, C = np.array(gains).T
            M_F[place] = float((w * S * S).sum() / (w * S).sum())
            if M_CR[place] < 0.0 or C.max() == 0.0:
                M_CR[place] = -1.0
            else:
                M_CR[place] = float((w * C * C).sum() / (w * C).sum())
            place = (place + 1) % 6
        wanted = max(round(n0 + (4 - n0) * len(spent) / budget), 4)
        if wanted < n:
            keep = np.argsort(F, kind="stable")[:wanted]
            X, F = X[keep], F[keep]
            archive = archive[: max(round(2.6 * wanted), 1)]


def jacobi(C: Any) -> tuple[Any, Any]:
    """Cyclic Jacobi by whole rotation matrices."""
    n = len(C)
    A, B = C.copy(), np.eye(n)
    for _ in range(30):
        if (np.triu(A, 1) ** 2).sum() <= 1e-32 * (np.diag(A) ** 2).sum():
            break
        for p in range(n):
            for q in range(p + 1, n):
                if A[p, q] == 0.0:
                    continue
                tau = (A[q, q] - A[p, p]) / (2.0 * A[p, q])
                t = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
                c = 1.0 / math.hypot(1.0, t)
                G = np.eye(n)
                G[p, p] = G[q, q] = c
                G[p, q], G[q, p] = t * c, -t * c
                A, B = G.T @ A @ G, B @ G
    return np.diag(A).copy(), B


def cma_es(f: Function, rng: np.random.Generator, d: int, budget: int) -> list[float]:
    """The tutorial's CMA-ES with restarts; the best after each evaluation."""
    spent: list[float] = []
    size, span = 4 + int(3.0 * math.log(d)), HIGH - LOW
    beginning = True
    while True:
        m, sigma = first(rng, 1, d)[0], 0.25
        raw = np.log(0.5 * (size + 1.0)) - np.log(np.arange(1, size + 1))
        mu = size // 2
        eff = raw[:mu].sum() ** 2 / (raw[:mu] ** 2).sum()
        eff_minus = raw[mu:].sum() ** 2 / (raw[mu:] ** 2).sum()
        cs = (eff + 2.0) / (d + eff + 5.0)
        ds = 1.0 + 2.0 * max(0.0, math.sqrt((eff - 1.0) / (d + 1.0)) - 1.0) + cs
        cc = (4.0 + eff / d) / (d + 4.0 + 2.0 * eff / d)
        c1 = 2.0 / ((d + 1.3) ** 2 + eff)
        cm = min(1.0 - c1, 2.0 * (0.25 + eff + 1.0 / eff - 2.0) / ((d + 2.0) ** 2 + eff))
        scale = min(1 + c1 / cm, 1 + 2 * eff_minus / (eff + 2), (1 - c1 - cm) / (d * cm))
        w = np.where(raw >= 0, raw / raw[raw >= 0].sum(), scale * raw / -raw[raw < 0].sum())
        chi = math.sqrt(d) * (1.0 - 1.0 / (4.0 * d) + 1.0 / (21.0 * d * d))
        C, B, D = np.eye(d), np.eye(d), np.ones(d)
        ps, pc = np.zeros(d), np.zeros(d)
        recent = [math.inf] * (10 + math.ceil(30.0 * d / size))
        wait = max(int(1.0 / (10.0 * d * (c1 + cm))), 1)
        g = 0
        while True:
            X = []
            for i in range(size):
                x = m + sigma * span * (B @ (D * rng.standard_normal(d)))
                if beginning and g == 0 and i == 0:
                    x = m.copy()
                X.append(clip(x))
                spent.append(min(f(X[-1]), spent[-1] if spent else math.inf))
                if len(spent) == budget:
                    return spent
            F = np.array([f(x) for x in X])
            Y = (np.array(X) - m) / (sigma * span)
            g += 1
            by = np.argsort(F, kind="stable")
            y = (w[:mu, None] * Y[by[:mu]]).sum(axis=0)
            m = m + sigma * span * y
            root = B @ np.diag(1.0 / D) @ B.T
            ps = (1.0 - cs) * ps + math.sqrt(cs * (2.0 - cs) * eff) * (root @ y)
            length = float(np.linalg.norm(ps))
            heard = length / math.sqrt(1.0 - (1.0 - cs) ** (2 * g)) < (1.4 + 2.0 / (d + 1.0)) * chi
            pc = (1.0 - cc) * pc + heard * math.sqrt(cc * (2.0 - cc) * eff) * y
            C = (1.0 - c1 - cm * w.sum() + c1 * (1 - heard) * cc * (2.0 - cc)) * C
            C = C + c1 * np.outer(pc, pc)
            for i in range(size):
                v = Y[by[i]]
                weight = w[i] if w[i] >= 0 else w[i] * d / float(((root @ v) ** 2).sum())
                C = C + cm * weight * np.outer(v, v)
            sigma *= math.exp(min(1.0, cs / ds * (length / chi - 1.0)))
            if g % wait == 0:
                values, B = jacobi(C)
                if not (values.min() > 0.0 and values.max() <= 1e14 * values.min()):
                    break
                D = np.sqrt(values)
            recent[g % len(recent)] = F.min()
            if max(*recent, F.max()) - min(*recent, F.min()) < 1e-12:
                break
            if sigma * max(np.abs(pc).max(), np.sqrt(np.diag(C)).max()) <= 1e-12:
                break
        size, beginning = 2 * size, False


__all__ = ["abc", "bat", "cma_es", "jacobi", "l_shade", "mo_pso"]
