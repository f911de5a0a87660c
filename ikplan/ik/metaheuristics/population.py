"""What every search shares: the problem, the outcome, the record of the best, the population.

A search is a kernel ``(problem, params, rng) -> Outcome``. It draws its random numbers from the
``numpy.random.Generator`` passed in, angles are radians, and candidates are brought inside the
bounds before they are evaluated. Every call of the objective goes through :func:`consider`, which
counts it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags, Indices
from ikplan.copying import copy_into
from ikplan.ik.metaheuristics.bounds import clip
from ikplan.ik.objective import Objective, evaluate

__all__ = [
    "CLOUD",
    "COLD",
    "INDIVIDUAL",
    "Best",
    "Outcome",
    "Problem",
    "best_of",
    "consider",
    "draw_population",
    "draw_within",
    "end_iteration",
    "initial_population",
    "new_outcome",
    "replace_if_better",
]

Counter = Indices

COLD, INDIVIDUAL, CLOUD = 0, 1, 2
"""Use of the start configuration in the first population: none, as individual 0, or as the centre
of a normal cloud of 10 degrees around it."""

CLOUD_DEVIATION = 0.17453292519943295


class Problem(NamedTuple):
    """A search to be made.

    Attributes:
        objective: What is minimised.
        lower: Lower bounds, shape (D,) [rad or m].
        upper: Upper bounds, shape (D,) [rad or m].
        q_s: Start configuration, shape (D,): the previous point of the path, or home [rad or m].
        warm: COLD, INDIVIDUAL or CLOUD.
        bounds: What happens to a position outside, see :mod:`ikplan.ik.metaheuristics.bounds`.
        population: N, the number of individuals.
        iterations: T, the largest number of iterations.
        stop_value: The search ends once the best value is this small.
        cut: Shape (1,); once another thread makes it true, the search ends at the next chance, and
            what it found depends on the clock: it must not be used.
    """

    objective: Objective
    lower: Array
    upper: Array
    q_s: Array
    warm: int
    bounds: int
    population: int
    iterations: int
    stop_value: float
    cut: Flags


class Best(NamedTuple):
    """The best position so far, and what it took to find it.

    Attributes:
        x: Best position x*, shape (D,) [rad or m].
        f: Its value f*, shape (1,).
        evaluations: Calls of the objective so far, shape (1,); every candidate counts.
    """

    x: Array
    f: Array
    evaluations: Counter


class Outcome(NamedTuple):
    """What a search found.

    Attributes:
        x: Best position x*, shape (D,) [rad or m].
        f: Its value f*, shape (1,).
        evaluations: Calls of the objective, shape (1,); every candidate counts.
        iterations: Iterations done, shape (1,).
        history: Best value after the initialisation and after each iteration, shape (T + 1,).
        history_evaluations: Evaluations at those moments, shape (T + 1,).
        X: Last population, shape (N, D).
        F: Values of the last population, shape (N,).
        archive: MO-PSO only: the non-dominated candidates, with their two objectives in the last
            two columns, shape (k, D + 2); k = 0 for every other search.
    """

    x: Array
    f: Array
    evaluations: Counter
    iterations: Counter
    history: Array
    history_evaluations: Counter
    X: Array
    F: Array
    archive: Array


@kernel
def new_outcome(problem: Problem, rows: int) -> Outcome:
    """Return an outcome with nothing found yet, and ``rows`` individuals."""
    T, D = problem.iterations, problem.lower.shape[0]
    return Outcome(
        0.5 * (problem.lower + problem.upper),
        np.full(1, np.inf),
        np.zeros(1, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
        np.full(T + 1, np.inf),
        np.zeros(T + 1, dtype=np.int64),
        np.empty((rows, D)),
        np.full(rows, np.inf),
        np.empty((0, D + 2)),
    )


@kernel
def best_of(out: Outcome) -> Best:
    """Return the part of an outcome that :func:`consider` writes."""
    return Best(out.x, out.f, out.evaluations)


@kernel
def consider(objective: Objective, x: Array, best: Best) -> float:
    """Evaluate a candidate, count it, keep it if it is the best so far; return its value."""
    f = evaluate(objective, x)
    best.evaluations[0] += 1
    if f < best.f[0]:
        best.f[0] = f
        copy_into(best.x, x)
    return f


@kernel
def replace_if_better(
    objective: Objective, y: Array, X: Array, F: Array, i: int, best: Best
) -> bool:
    """Greedy selection: individual i becomes y if that is strictly better; return whether."""
    f = consider(objective, y, best)
    if f < F[i]:
        copy_into(X[i], y)
        F[i] = f
        return True
    return False


@kernel
def end_iteration(problem: Problem, out: Outcome, t: int) -> bool:
    """Write the history of iteration t (0: the initialisation); return whether to stop."""
    out.iterations[0] = t
    out.history[t] = out.f[0]
    out.history_evaluations[t] = out.evaluations[0]
    return bool(out.f[0] <= problem.stop_value or problem.cut[0])


@kernel
def draw_within(lower: Array, upper: Array, x: Array, rng: np.random.Generator) -> None:
    """Draw a position uniformly within the bounds."""
    for k in range(x.shape[0]):
        x[k] = lower[k] + rng.random() * (upper[k] - lower[k])


@kernel
def place_start(problem: Problem, X: Array) -> None:
    """Make the start configuration individual 0, unless the search starts cold."""
    if problem.warm != COLD:
        copy_into(X[0], problem.q_s)
        clip(X[0], problem.lower, problem.upper)


@kernel
def draw_population(problem: Problem, X: Array, rng: np.random.Generator) -> None:
    """Draw the first population, without evaluating it."""
    for i in range(X.shape[0]):
        if problem.warm == CLOUD:
            for k in range(X.shape[1]):
                X[i, k] = problem.q_s[k] + CLOUD_DEVIATION * rng.standard_normal()
            clip(X[i], problem.lower, problem.upper)
        else:
            draw_within(problem.lower, problem.upper, X[i], rng)
    place_start(problem, X)


@kernel
def initial_population(problem: Problem, out: Outcome, rng: np.random.Generator) -> bool:
    """Draw the first population and evaluate it.

    Returns:
        Whether the stop value is reached already.
    """
    draw_population(problem, out.X, rng)
    best = best_of(out)
    for i in range(out.X.shape[0]):
        out.F[i] = consider(problem.objective, out.X[i], best)
    return end_iteration(problem, out, 0)
