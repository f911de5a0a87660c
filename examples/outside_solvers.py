"""Solvers of other packages in the arena: ``python examples/outside_solvers.py``.

Each adapter is a function of the objective and a random generator; the objective ends it where the
budget is spent. Adapters of packages that are not installed are left out.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan


def random_descent(objective: Any, rng: np.random.Generator) -> None:
    """Steps from the best so far, longer after a success and shorter after a failure."""
    best, step = objective.start, 0.5
    value = float(objective(best))
    while True:
        candidates = best + step * rng.standard_normal((10, objective.dof))
        values = objective(candidates)
        k = int(values.argmin())
        if values[k] < value:
            best, value, step = candidates[k], float(values[k]), 1.3 * step
        else:
            step *= 0.8


def cma_es(objective: Any, rng: np.random.Generator) -> None:
    """CMA-ES of the package cma, restarted with twice the population (IPOP)."""
    import cma

    width, start, population = objective.upper - objective.lower, objective.start, 0
    while True:
        options = {
            "bounds": [list(objective.lower), list(objective.upper)],
            "CMA_stds": list(width),
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,  # the random numbers are those of `rng`
            "verbose": -9,
            "tolfun": 1e-14,
            "tolfunhist": 1e-14,
        } | ({"popsize": population} if population else {})
        strategy = cma.CMAEvolutionStrategy(np.clip(start, *_inner(objective)), 0.2, options)
        population = 2 * strategy.popsize
        while not strategy.stop():
            candidates = strategy.ask()
            strategy.tell(candidates, list(objective(np.array(candidates))))
        start = objective.lower + width * rng.random(objective.dof)


def _inner(objective: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bounds that a start may lie on: CMA-ES wants it inside."""
    edge = 1e-9 * (objective.upper - objective.lower)
    return objective.lower + edge, objective.upper - edge


def l_shade(objective: Any, rng: np.random.Generator) -> None:
    """L-SHADE of the package mealpy."""
    from mealpy import SHADE

    _mealpy(SHADE.L_SHADE(epoch=max(objective.budget // 50, 1), pop_size=50), objective, rng)


def grey_wolf(objective: Any, rng: np.random.Generator) -> None:
    """The grey wolf optimiser (GWO) of the package mealpy."""
    from mealpy import GWO

    _mealpy(GWO.OriginalGWO(epoch=max(objective.budget // 50, 1), pop_size=50), objective, rng)


def _mealpy(optimiser: Any, objective: Any, rng: np.random.Generator) -> None:
    from mealpy import FloatVar

    problem = {
        "bounds": FloatVar(lb=list(objective.lower), ub=list(objective.upper)),
        "minmax": "min",
        "obj_func": lambda x: float(objective(x)),
        "log_to": None,
    }
    np.random.seed(int(rng.integers(2**31)))  # noqa: NPY002 - L-SHADE draws from there as well
    optimiser.solve(problem, seed=int(rng.integers(2**31)))


def pattern_search(objective: Any, rng: np.random.Generator) -> None:
    """The pattern search of Hooke and Jeeves, of the package pymoo, from new places to the end."""
    from pymoo.algorithms.soo.nonconvex.pattern import PatternSearch
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    class _Pose(Problem):  # type: ignore[misc]
        def _evaluate(self, X: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
            out["F"] = objective(X)[:, None]

    problem = _Pose(n_var=objective.dof, n_obj=1, xl=objective.lower, xu=objective.upper)
    while True:
        minimize(problem, PatternSearch(), ("n_gen", 200), seed=int(rng.integers(2**31)))


def one_plus_one(objective: Any, rng: np.random.Generator) -> None:
    """The (1 + 1) evolution strategy of the package nevergrad."""
    import nevergrad

    space = nevergrad.p.Array(init=objective.start).set_bounds(objective.lower, objective.upper)
    space.random_state = np.random.RandomState(int(rng.integers(2**31)))
    search = nevergrad.optimizers.OnePlusOne(parametrization=space, budget=objective.budget)
    while True:
        candidate = search.ask()
        search.tell(candidate, float(objective(candidate.value)))


ADAPTERS: dict[str, tuple[Callable[..., None], str | None]] = {
    "random-descent": (random_descent, None),
    "pycma": (cma_es, "cma"),
    "mealpy-l-shade": (l_shade, "mealpy"),
    "gwo": (grey_wolf, "mealpy"),
    "pattern-search": (pattern_search, "pymoo"),
    "one-plus-one": (one_plus_one, "nevergrad"),
}
"""The adapters, and the package that each needs."""


def register() -> list[str]:
    """Register every adapter whose package is installed; return their names."""
    found = []
    for name, (minimise, package) in ADAPTERS.items():
        if package is None or importlib.util.find_spec(package) is not None:
            source = package or "examples/outside_solvers.py"
            title = (minimise.__doc__ or "").splitlines()[0]
            ikplan.register_solver(name, minimise, title=title, source=source, replace=True)
            found.append(name)
    return found


def main() -> None:
    """Compare them with five of the project's solvers, and write the figure."""
    outside = register()
    own = ["ik-ba", "bode-cs", "de-best-1", "pso", "cma-es"]
    robot = ikplan.load_robot("iiwa14")
    found = ikplan.compare([*own, *outside], robot, targets=20, seeds=5, budget=5000)
    sys.stdout.write(found.table())
    for file in found.save("out/arena"):
        sys.stdout.write(f"wrote {file}\n")


if __name__ == "__main__":
    main()
