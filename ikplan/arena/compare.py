"""Compare solvers on the same targets, from the same starts, with the same evaluations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arena.comparison import Comparison
from ikplan.arena.objective import bodies_of
from ikplan.arena.run import Entrant, Run, run_once
from ikplan.arena.targets import make_problems
from ikplan.errors import InvalidRequest
from ikplan.ik.registry import find_solver
from ikplan.robots import Robot

__all__ = ["compare"]


def compare(
    solvers: Iterable[str | tuple[str, Mapping[str, Any]]],
    robot: Robot,
    targets: int | Sequence[Any] = 20,
    seeds: int | Sequence[int] = 10,
    budget: int = 10_000,
    *,
    kind: str = "position",
    start: ArrayLike | None = None,
    start_distance: float | None = None,
    scene: Mapping[str, Any] | None = None,
    params: Mapping[str, Any] | None = None,
    population: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Run solvers on the same targets and hold them to each other.

    Every solver is told the start where it can use it (``warm: individual``), minimises the same
    objective, and evaluates at most ``budget`` candidates; only raw searches count, nothing is
    refined.

    Args:
        solvers: Names of searches, of the project or registered; or pairs of a name and its
            parameters. A label may stand before: ``("ik-ba 0.1", {"method": "ik-ba", ...})``.
        robot: The robot.
        targets: How many random ones, or a list of poses as for :func:`ikplan.solve_ik`.
        seeds: How many runs a target, or their seeds.
        budget: Most evaluations of a run.
        kind: What is drawn: "position" or "pose".
        start: Start configuration, shape (dof,) [rad or m]; None: home.
        start_distance: Where targets are drawn: starts within this angle a joint of the
            configuration that a target comes from [rad]; None: ``start``.
        scene: Bodies to keep clear of, as a term of the objective; None: no such term.
        params: Parameters of all, such as ``{"weight_motion": 0.05}``.
        population: N of all; None: each that of its paper.
        progress: Called with runs done and runs in all.

    Returns:
        All runs, with tables, tests and figures.

    Raises:
        InvalidRequest: An argument is wrong.
    """
    entrants = _entrants(solvers, params or {}, population)
    numbers = list(range(seeds)) if isinstance(seeds, int | np.integer) else [int(s) for s in seeds]
    if not numbers or min(numbers) < 0 or len(set(numbers)) < len(numbers):
        raise InvalidRequest(
            "seeds: must be 1 at least, or different whole numbers from 0", field="seeds"
        )
    if budget < 1:
        raise InvalidRequest("budget: must be 1 at least", field="budget", allowed="at least 1")
    problems = make_problems(robot, targets, kind, start, start_distance, numbers[0])
    model = bodies_of(robot, scene)
    count = len(entrants) * len(problems.targets) * len(numbers)
    runs: dict[str, list[list[Run]]] = {}
    done = 0
    for entrant in entrants:
        rows = []
        for k, target in enumerate(problems.targets):
            row = []
            for seed in numbers:
                row.append(
                    run_once(robot, entrant, target, problems.starts[k], seed, k, budget, model)
                )
                done += 1
                if progress is not None:
                    progress(done, count)
            rows.append(row)
        runs[entrant.label] = rows
    oriented = any(target.oriented for target in problems.targets)
    return Comparison(robot.name, robot.dof, budget, numbers, oriented, runs)


def _entrants(
    solvers: Iterable[str | tuple[str, Mapping[str, Any]]],
    params: Mapping[str, Any],
    population: int | None,
) -> list[Entrant]:
    """Return the solvers as they enter, each under a label of its own."""
    found: list[Entrant] = []
    for given in solvers:
        label, own = (given, {}) if isinstance(given, str) else (given[0], dict(given[1]))
        method = str(own.pop("method", label))
        known = {p.name for p in find_solver(method).parameters}
        warm = {"warm": "individual"} if "warm" in known else {}
        found.append(Entrant(label, method, {**warm, **params, **own}, population))
    labels = [entrant.label for entrant in found]
    if not labels or len(set(labels)) < len(labels):
        raise InvalidRequest(
            "solvers: must be one at least, each under a label of its own",
            field="solvers",
            allowed='names, or (label, {"method": name, ...})',
        )
    return found
