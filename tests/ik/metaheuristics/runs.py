"""Searches on test functions, run as the registry runs them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.ik.metaheuristics.bounds import BOUNDS
from ikplan.ik.metaheuristics.population import COLD, Outcome, Problem
from ikplan.ik.objective import ROSENBROCK, SPHERE, function_objective
from ikplan.ik.registry import find_solver, solvers
from ikplan.ik.solver import Solver

POPULATION_SEARCHES = [s.name for s in solvers() if s.population is not None]


def problem(
    dimensions: int,
    population: int,
    iterations: int,
    *,
    kind: int = SPHERE,
    low: float = -5.0,
    high: float = 5.0,
    q_s: Any = None,
    warm: int = COLD,
    bounds: str = "clip",
    stop_value: float = -1.0,
) -> Problem:
    """A test function on [low, high] in every dimension."""
    start = np.full(dimensions, 1.0) if q_s is None else np.array(q_s, dtype=np.float64)
    return Problem(
        function_objective(kind),
        np.full(dimensions, low),
        np.full(dimensions, high),
        start,
        warm,
        BOUNDS.index(bounds),
        population,
        iterations,
        stop_value,
        np.zeros(1, dtype=np.bool_),
    )


def packed(name: str, **params: Any) -> tuple[Solver, Any]:
    """A solver and the parameter tuple of its kernel."""
    solver = find_solver(name)
    return solver, solver.pack(solver.check(params))


def run(name: str, task: Problem, seed: int = 0, **params: Any) -> Outcome:
    """Run a search with the random numbers of a seed."""
    solver, values = packed(name, **params)
    outcome: Outcome = solver.load()(task, values, np.random.default_rng(seed))
    return outcome


__all__ = ["POPULATION_SEARCHES", "ROSENBROCK", "SPHERE", "packed", "problem", "run"]
