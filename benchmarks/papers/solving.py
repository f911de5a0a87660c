"""One run of one series on a case: every target, in order."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.case import Case
from benchmarks.papers.own import OWN
from benchmarks.papers.series import Series, context_of
from ikplan.ik.metaheuristic_seeds import WARM, generator
from ikplan.ik.metaheuristics.bounds import BOUNDS
from ikplan.ik.metaheuristics.population import Outcome, Problem
from ikplan.ik.registry import find_solver
from ikplan.ik.solver import Solver
from ikplan.kinematics.forward import forward

__all__ = ["FLOOR", "run_series", "warm_up"]

Array = NDArray[np.float64]

FLOOR = 1e-18
"""Values below this count as this in geometric means of convergence curves."""


def _search(
    case: Case, series: Series, solver: Solver, values: Any, k: int, q_s: Array, rng: Any
) -> Outcome:
    lower, upper = case.arm.search_bounds(case.q_start)
    d = case.width
    penalise = values.get("wrist_limits") == "penalise"
    problem = Problem(
        case.objective(k, q_s, penalise),
        np.array(lower[:d]),
        np.array(upper[:d]),
        np.array(q_s[:d]),
        WARM.index(values["warm"]),
        BOUNDS.index(values.get("bounds", "clip")),
        series.population or 1,
        series.iterations,
        case.stop_value,
        np.zeros(1, dtype=np.bool_),
    )
    outcome: Outcome = solver.load()(problem, solver.pack(values), rng)
    return outcome


def row_of(
    case: Case, k: int, run: int, q: Array, q_before: Array, f: float, spent: tuple[float, ...]
) -> list[float]:
    """Return the row of a solution.

    Args:
        case: The case.
        k: Target.
        run: Run.
        q: Solution, shape (dof,) [rad].
        q_before: Configuration before, shape (dof,) [rad].
        f: Value of the objective.
        spent: Evaluations, iterations, seconds, processor seconds.
    """
    R, p = forward(case.arm.chain, np.ascontiguousarray(q))
    eps_p = float(np.linalg.norm(p - case.p[k]))
    delta_R = float(np.linalg.norm(R - case.R[k])) if case.oriented else float("nan")
    theta = (
        2.0 * np.degrees(np.arcsin(min(1.0, delta_R / np.sqrt(8.0)))) if case.oriented else np.nan
    )
    step = np.degrees(q - q_before)
    outside = (q < case.arm.lower - 1e-9) | (q > case.arm.upper + 1e-9)
    return [
        run,
        k,
        f,
        eps_p,
        delta_R,
        float(theta),
        float(np.linalg.norm(step)),
        float(np.linalg.norm(step[: case.width])),
        *spent,
        float(outside.sum()),
        *q,
    ]


def run_series(
    case: Case, series: Series, run: int, seed: int = 0
) -> tuple[list[list[float]], Array]:
    """Run a series once.

    Args:
        case: The case.
        series: The series.
        run: Run, from 0.
        seed: Seed of the whole report; each draws other random numbers in every solve.

    Returns:
        A row a target, and the convergence over the targets: geometric mean, median and mean of
        the best value after each iteration, of the reachable targets and then of the others (NaN
        where there are none), shape (6, T + 1).
    """
    if series.method in OWN:
        found = OWN[series.method](case, series, run, seed=seed)
        q_before = case.start(0)
        rows = []
        for k in range(case.count):
            if case.starts is not None:
                q_before = case.start(k)
            q, f, spent = found[k]
            rows.append(row_of(case, k, run, q, q_before, f, spent))
            q_before = q
        return rows, np.empty((6, 0))
    solver = find_solver(series.method)
    values = solver.check(series.params)
    tracks = case.tracks if series.tracks is None else series.tracks
    rows, histories = [], np.empty((case.count, series.iterations + 1))
    q_s = q_before = case.start(0)
    for k in range(case.count):
        if case.starts is not None:
            q_s = q_before = case.start(k)
        rng = generator(seed, *context_of(case.name, series, run, k))
        wall, cpu = time.perf_counter(), time.thread_time()
        outcome = _search(case, series, solver, values, k, q_s, rng)
        q = case.complete(outcome.x, k, q_s)
        wall, cpu = time.perf_counter() - wall, time.thread_time() - cpu
        done = int(outcome.iterations[0])
        spent = (float(outcome.evaluations[0]), float(done), wall, cpu)
        rows.append(row_of(case, k, run, q, q_before, float(outcome.f[0]), spent))
        history = outcome.history[: series.iterations + 1]
        last = min(done, series.iterations)
        histories[k] = np.where(np.arange(len(history)) <= last, history, history[last])
        q_before = q
        if tracks:
            q_s = q
    histories = np.maximum(np.nan_to_num(histories, posinf=1e3), FLOOR)
    curves = [_convergence(histories[mask]) for mask in (case.reachable, ~case.reachable)]
    return rows, np.vstack(curves)


def _convergence(histories: Array) -> Array:
    """Return geometric mean, median and mean over the rows, shape (3, T + 1)."""
    if len(histories) == 0:
        return np.full((3, histories.shape[1]), np.nan)
    geometric = np.exp(np.log(histories).mean(axis=0))
    return np.array([geometric, np.median(histories, axis=0), histories.mean(axis=0)])


def warm_up(case: Case, series: Series) -> None:
    """Load, or compile, what a series needs before it is timed."""
    if series.method in OWN:
        OWN[series.method](case, series, 0, count=1)
        return
    solver = find_solver(series.method)
    short = Series(series.name, series.method, series.population, 2, series.params)
    values = solver.check(series.params)
    outcome = _search(case, short, solver, values, 0, case.q_start, generator(0))
    case.complete(outcome.x, 0, case.q_start)
