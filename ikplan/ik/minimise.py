"""The searches of inverse kinematics on any objective, in plain Python.

A search is a kernel whose only look at its objective is
:func:`ikplan.ik.objective.evaluate`. Here the same source runs as Python, with another function in
the place of that one: a search is written once, and what it finds for a function is what its
kernel finds for the same values. Its own work is some 10 microseconds a candidate, so this is for
objectives that take longer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import CodeType, FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest, near_names
from ikplan.ik.objective import evaluate
from ikplan.ik.registry import find_solver, solvers

__all__ = ["RANDOM", "Minimum", "minimise", "minimisers"]

RANDOM = "random"
"""Name of the search that draws every candidate uniformly: what others are measured by."""
_POSES_ONLY = ("ik-ba", "mo-pso")
# Half of a search's candidates are in its first population at most.
_LEAST_ITERATIONS = 2


@dataclass(frozen=True)
class Minimum:
    """What a search found.

    Attributes:
        x: The best candidate, shape (D,).
        value: Its value.
        X: Every candidate that was evaluated, in order, shape (n, D).
        values: Their values, shape (n,).
    """

    x: Array
    value: float
    X: Array
    values: Array


class _BudgetSpent(Exception):
    """The last evaluation is made."""


def minimisers() -> list[str]:
    """Return the names of the searches that minimise any objective."""
    found = [s.name for s in solvers() if s.family == "metaheuristic" and s.searches]
    return [*(name for name in found if name not in _POSES_ONLY), RANDOM]


def minimise(
    objective: Callable[[Array], float],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    solver: str = "bode-cs",
    budget: int = 300,
    rng: np.random.Generator | int = 0,
    population: int | None = None,
    start: ArrayLike | None = None,
    stop_value: float = -math.inf,
    params: Mapping[str, bool | int | float | str] | None = None,
) -> Minimum:
    """Minimise a function within bounds.

    Args:
        objective: From a candidate, shape (D,), to its value; infinite values are allowed, NaN
            counts as infinite.
        lower: Lower bounds, shape (D,).
        upper: Upper bounds, shape (D,).
        solver: One of :func:`minimisers`.
        budget: Evaluations at most.
        rng: A generator, or the seed of one. The same seed gives the same candidates.
        population: Candidates an iteration; None: that of the planner, at most a quarter of the
            budget.
        start: A candidate of the first population, shape (D,); None: none.
        stop_value: The search ends once a value is this small.
        params: Parameters of the solver by name.

    Returns:
        The best candidate, and all of them.

    Raises:
        InvalidRequest: No such solver or parameter, or bounds that make no sense.
    """
    low, high = np.array(lower, dtype=np.float64), np.array(upper, dtype=np.float64)
    if low.ndim != 1 or low.shape != high.shape or not len(low) or not (low <= high).all():
        raise InvalidRequest(
            "bounds: lower and upper are as many numbers each, lower ones first", field="bounds"
        )
    if not np.isfinite([low, high]).all():
        raise InvalidRequest("bounds: must be finite", field="bounds", allowed="finite numbers")
    if budget < 1:
        raise InvalidRequest("budget: must be 1 or more", field="budget", allowed="1 or more")
    names = minimisers()
    if solver not in names:
        near = near_names(solver, names)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InvalidRequest(
            f"solver: {solver!r} minimises poses only or is not known{hint} Solvers: "
            f"{', '.join(names)}",
            field="solver",
            allowed=names,
        )
    drawn = np.random.default_rng(rng)
    X: list[Array] = []
    values: list[float] = []

    def value_of(x: Array) -> float:
        if len(X) == budget:
            raise _BudgetSpent
        candidate = np.array(x)
        found = float(objective(candidate.copy()))
        X.append(candidate)
        values.append(math.inf if math.isnan(found) else found)
        if values[-1] <= stop_value or len(X) == budget:
            raise _BudgetSpent
        return values[-1]

    try:
        if solver == RANDOM:
            if start is not None:
                value_of(np.clip(np.asarray(start, dtype=np.float64), low, high))
            while True:
                value_of(low + drawn.random(len(low)) * (high - low))
        _search(value_of, low, high, solver, budget, drawn, population, start, params or {})
    except _BudgetSpent:
        pass
    best = int(np.argmin(values))
    return Minimum(X[best].copy(), values[best], np.array(X), np.array(values))


def _search(
    value_of: Callable[[Array], float],
    low: Array,
    high: Array,
    name: str,
    budget: int,
    rng: np.random.Generator,
    population: int | None,
    start: ArrayLike | None,
    params: Mapping[str, bool | int | float | str],
) -> None:
    """Run a solver's kernel as Python."""
    from ikplan.ik.metaheuristics.bounds import BOUNDS
    from ikplan.ik.metaheuristics.population import COLD, INDIVIDUAL, Problem

    chosen = find_solver(name)
    checked = chosen.check(params)
    least = chosen.min_population
    usual = min(chosen.planner_population or 20, max(budget // 4, 1))
    size = max(population or usual, least)
    iterations = max(math.ceil(budget / size) - 1, _LEAST_ITERATIONS)
    middle = 0.5 * (low + high) if start is None else np.array(start, dtype=np.float64)
    problem = Problem(
        value_of,  # type: ignore[arg-type]
        low,
        high,
        middle,
        COLD if start is None else INDIVIDUAL,
        BOUNDS.index(str(checked["bounds"])),
        size,
        iterations,
        -math.inf,
        np.zeros(1, dtype=np.bool_),
    )
    function = _in_python(chosen.load(), {_code(evaluate): _evaluated}, {})
    # Kernels divide by zero as numpy does.
    with np.errstate(all="ignore"):
        function(problem, chosen.pack(checked), rng)


def _evaluated(objective: Callable[[Array], float], x: Array) -> float:
    return objective(x)


def _code(function: Any) -> CodeType | None:
    """The code of a kernel or function of ours, None of anything else."""
    plain = getattr(function, "py_func", function)
    if isinstance(plain, FunctionType) and plain.__module__.startswith("ikplan."):
        return plain.__code__
    return None


def _names(code: CodeType) -> set[str]:
    """Names of globals that code may look up, in nested functions too."""
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            found |= _names(constant)
    return found


def _in_python(
    function: Any,
    instead: Mapping[CodeType | None, Callable[..., Any]],
    made: dict[CodeType, FunctionType],
) -> Callable[..., Any]:
    """Return a kernel as a Python function that calls kernels as Python functions.

    Args:
        function: The kernel.
        instead: Functions to take in place of kernels, by the code of these.
        made: Those made already, by code; it grows.
    """
    plain: FunctionType = getattr(function, "py_func", function)
    code = plain.__code__
    if code in instead:
        return instead[code]
    if code in made:
        return made[code]
    names = dict(plain.__globals__)
    copy = FunctionType(code, names, plain.__name__, plain.__defaults__, plain.__closure__)
    made[code] = copy
    for name in sorted(_names(code)):
        other = plain.__globals__.get(name)
        if other is not None and _code(other) is not None:
            names[name] = _in_python(other, instead, made)
    return copy
