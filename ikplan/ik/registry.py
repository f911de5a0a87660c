"""The solvers by name: those of the catalogue, of installed packages, and of this process.

A new compiled solver of the project is one file under ``metaheuristics/`` and one entry in
``catalogue/``. A package brings its own by the entry point ``ikplan.solvers``, each a
:class:`~ikplan.ik.solver.Solver` or a function ``minimise(objective, rng)``; a program by
:func:`register_solver`.
"""

from __future__ import annotations

import functools
from importlib.metadata import EntryPoint, entry_points

from ikplan.errors import InvalidRequest, near_names
from ikplan.ik.catalogue import CATALOGUE
from ikplan.ik.outside.registering import Minimise, make_outside_solver
from ikplan.ik.solver import Parameter, Solver

__all__ = ["ENTRY_POINTS", "find_solver", "register_solver", "replacements", "solvers"]

ENTRY_POINTS = "ikplan.solvers"
"""Group of the entry points that bring solvers."""

_registered: dict[str, Solver] = {}
_replaced: list[Solver] = []


def register_solver(
    solver: str | Solver,
    minimise: Minimise | None = None,
    *,
    title: str = "",
    source: str = "",
    notes: str = "",
    parameters: list[Parameter] | None = None,
    replace: bool = False,
) -> Solver:
    """Enter a solver of your own, for this process.

    It is then a ``method`` like any other: of :func:`ikplan.solve_ik`, of plans and of
    :func:`ikplan.compare`, with the same objective, bounds, budget and random numbers.

    Args:
        solver: Its name; or the whole entry, of a compiled search.
        minimise: ``minimise(objective, rng, **parameters)``. ``objective`` is a
            :class:`~ikplan.ik.outside.pose_objective.PoseObjective`: it maps candidates, shape
            (n, dof), to their values, shape (n,), and has ``lower``, ``upper``, ``start``,
            ``budget`` and ``remaining``. ``rng`` is a ``numpy.random.Generator``: with random
            numbers from anywhere else a plan cannot be repeated. The best candidate evaluated
            counts; an array that is returned is evaluated once more. Where the budget is spent, the
            objective raises ``BudgetSpent``: let it pass.
        title: What it is, in a few words.
        source: Where it is from.
        notes: Anything else to say of it.
        parameters: Its own parameters, given to ``minimise`` by name.
        replace: Take the place of one that was registered before.

    Returns:
        The entry.

    Raises:
        InvalidRequest: The name is taken, or an argument is wrong.
    """
    if isinstance(solver, Solver):
        entry = solver
    else:
        entry = make_outside_solver(
            solver,
            minimise,  # type: ignore[arg-type]
            title=title,
            source=source,
            notes=notes,
            parameters=parameters,
        )
    taken = {s.name for s in solvers()} - (set(_registered) if replace else set())
    if entry.name in taken:
        raise InvalidRequest(
            f"name: there is a solver {entry.name!r} already; take another name"
            + (", or replace=True" if entry.name in _registered else ""),
            field="name",
            allowed=f"none of {', '.join(sorted(taken))}",
        )
    if entry.name in _registered:
        _replaced.append(_registered[entry.name])
    _registered[entry.name] = entry
    return entry


def replacements() -> int:
    """Return how many entries were replaced: what was looked up by name before may be another."""
    return len(_replaced)


@functools.cache
def _installed() -> dict[str, Solver]:
    """Return the solvers of installed packages, by name."""
    found: dict[str, Solver] = {}
    for point in sorted(entry_points(group=ENTRY_POINTS), key=lambda p: (p.name, p.value)):
        entry = _loaded(point)
        if entry.name in found or any(s.name == entry.name for s in CATALOGUE):
            raise InvalidRequest(
                f"entry point {point.name} = {point.value}: there is a solver {entry.name!r} "
                "already; uninstall one of the two packages",
                field="ik.method",
            )
        found[entry.name] = entry
    return found


def _loaded(point: EntryPoint) -> Solver:
    try:
        value = point.load()
    except Exception as error:  # whatever the other package raises
        raise InvalidRequest(
            f"entry point {point.name} = {point.value} of {ENTRY_POINTS} cannot be loaded: {error}",
            field="ik.method",
        ) from error
    if isinstance(value, Solver):
        return value
    return make_outside_solver(point.name, value, source=point.value)


def solvers() -> list[Solver]:
    """Return every solver, sorted by name."""
    known = [*CATALOGUE, *_installed().values(), *_registered.values()]
    return sorted(known, key=lambda s: s.name)


def find_solver(name: str) -> Solver:
    """Return the solver of that name.

    Raises:
        InvalidRequest: There is none; near names and all names given.
    """
    by_name = {s.name: s for s in solvers()}
    if name not in by_name:
        near = near_names(name, by_name)
        hint = f"; did you mean {near[0]!r}?" if near else "."
        raise InvalidRequest(
            f"ik.method: no solver named {name!r}{hint} Solvers: {', '.join(by_name)}",
            field="ik.method",
            allowed=list(by_name),
        )
    return by_name[name]
