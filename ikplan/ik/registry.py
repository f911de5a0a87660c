"""The solvers by name.

A new solver is one file under ``metaheuristics/`` and one entry in ``catalogue/``.
"""

from __future__ import annotations

from ikplan.errors import InvalidRequest, near_names
from ikplan.ik.catalogue import CATALOGUE
from ikplan.ik.solver import Solver

__all__ = ["find_solver", "solvers"]


def solvers() -> list[Solver]:
    """Return every solver, sorted by name."""
    return sorted(CATALOGUE, key=lambda s: s.name)


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
