"""What every search shares: the problem, the outcome, bounds, the record of the best.

A search is a kernel ``(problem, params, rng) -> Outcome``. It draws its random numbers from the
``numpy.random.Generator`` passed in, angles are radians, and candidates are clipped to the bounds
before they are evaluated.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikplan._jit import kernel
from ikplan.ik.objective import Objective, evaluate

__all__ = ["Outcome", "Problem", "clip_into", "initial_population", "new_outcome", "record"]

Array = NDArray[np.float64]


class Problem(NamedTuple):
    """A search to be made.

    Attributes:
        objective: What is minimised.
        lower: Lower bounds, shape (D,) [rad or m].
        upper: Upper bounds, shape (D,) [rad or m].
        q_s: Start configuration, shape (D,): the previous point of the path, or home [rad or m].
        warm: Whether individual 0 of the first population is ``q_s``.
        population: N, the number of individuals.
        iterations: T, the largest number of iterations.
        stop_value: The search ends once the best value is this small.
    """

    objective: Objective
    lower: Array
    upper: Array
    q_s: Array
    warm: bool
    population: int
    iterations: int
    stop_value: float


class Outcome(NamedTuple):
    """What a search found.

    Attributes:
        x: Best position, shape (D,) [rad or m].
        f: Its value, shape (1,).
        evaluations: Calls of the objective so far, shape (1,); every candidate counts.
        iterations: Iterations done, shape (1,).
        history: Best value after the initialisation and after each iteration, shape (T + 1,).
        history_evaluations: Evaluations at those moments, shape (T + 1,).
        X: Last population, shape (N, D).
        F: Values of the last population, shape (N,).
    """

    x: Array
    f: Array
    evaluations: NDArray[np.int64]
    iterations: NDArray[np.int64]
    history: Array
    history_evaluations: NDArray[np.int64]
    X: Array
    F: Array


@kernel
def clip_into(x: Array, lower: Array, upper: Array) -> None:
    """Clip a position to the bounds, in place."""
    for k in range(x.shape[0]):
        if x[k] < lower[k]:
            x[k] = lower[k]
        elif x[k] > upper[k]:
            x[k] = upper[k]


@kernel
def new_outcome(problem: Problem) -> Outcome:
    """Return an outcome with nothing found yet."""
    N, T, D = problem.population, problem.iterations, problem.lower.shape[0]
    return Outcome(
        np.zeros(D),
        np.full(1, np.inf),
        np.zeros(1, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
        np.full(T + 1, np.inf),
        np.zeros(T + 1, dtype=np.int64),
        np.empty((N, D)),
        np.empty(N),
    )


@kernel
def record(outcome: Outcome, x: Array, f: float) -> None:
    """Count one evaluation, and keep the candidate if it is the best so far."""
    outcome.evaluations[0] += 1
    if f < outcome.f[0]:
        outcome.f[0] = f
        outcome.x[:] = x


@kernel
def end_iteration(problem: Problem, outcome: Outcome, t: int) -> bool:
    """Write the history of iteration t (0: the initialisation); return whether to stop."""
    outcome.iterations[0] = t
    outcome.history[t] = outcome.f[0]
    outcome.history_evaluations[t] = outcome.evaluations[0]
    return outcome.f[0] <= problem.stop_value


@kernel
def initial_population(problem: Problem, outcome: Outcome, rng: np.random.Generator) -> bool:
    """Draw the first population uniformly within the bounds, and evaluate it.

    Returns:
        Whether the stop value is reached already.
    """
    N, D = outcome.X.shape
    for i in range(N):
        for k in range(D):
            outcome.X[i, k] = problem.lower[k] + rng.random() * (problem.upper[k] - problem.lower[k])
        if i == 0 and problem.warm:
            outcome.X[0] = problem.q_s
            clip_into(outcome.X[0], problem.lower, problem.upper)
        outcome.F[i] = evaluate(problem.objective, outcome.X[i])
        record(outcome, outcome.X[i], outcome.F[i])
    return end_iteration(problem, outcome, 0)
