"""A solver from outside as an entry of the registry: the same calls as a compiled search."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike
from pydantic import Field

from ikplan.errors import InvalidRequest
from ikplan.ik.solver import Parameter, Solver, common_parameters

__all__ = ["Minimise", "OutsideSolver", "make_outside_solver"]

Minimise = Callable[..., ArrayLike | None]
"""``minimise(objective, rng, **parameters)``: searches until it ends or its budget is spent."""

_POPULATION, _ITERATIONS = 20, 30
"""Evaluations of a search inside a plan, where nobody says how many: those of the own searches."""


class OutsideSolver(Solver):
    """A solver that is a function of Python.

    Its budget is N T evaluations; it may use them as it likes.
    """

    minimise: Minimise = Field(exclude=True)

    @property
    def searches(self) -> bool:
        """It is run as a search."""
        return True

    def load(self) -> Callable[..., Any]:
        """Return the function behind the signature of a compiled search."""
        return functools.partial(super().load(), self.minimise)

    def pack(self, values: Any) -> dict[str, Any]:
        """Return the keyword arguments of the function."""
        return {p.name: values[p.name] for p in self.own_parameters()}


def make_outside_solver(
    name: str,
    minimise: Minimise,
    *,
    title: str = "",
    source: str = "",
    notes: str = "",
    parameters: list[Parameter] | None = None,
) -> OutsideSolver:
    """Return the entry of a solver that is a function of Python.

    Args:
        name: What ``method`` calls it.
        minimise: ``minimise(objective, rng, **parameters)``, see :func:`ikplan.register_solver`.
        title: What it is, in a few words.
        source: Where it is from.
        notes: Anything else to say of it.
        parameters: Its own parameters, given to ``minimise`` by name.

    Raises:
        InvalidRequest: No name, a parameter of a name that every search has, or no function.
    """
    if not isinstance(name, str) or not name or name != name.strip():
        raise InvalidRequest("name: must be a word", field="name", allowed="a word")
    if not callable(minimise):
        raise InvalidRequest(
            "minimise: must be a function (objective, rng, **parameters)",
            field="minimise",
            allowed="minimise(objective, rng, **parameters)",
        )
    common = common_parameters()
    taken = {p.name for p in common} | {"preset"}
    for parameter in parameters or []:
        if parameter.name in taken:
            raise InvalidRequest(
                f"parameters: every search has a parameter {parameter.name!r} already",
                field="parameters",
                allowed=f"names beside {', '.join(sorted(taken))}",
            )
    return OutsideSolver(
        name=name,
        title=title or name,
        source=source or "registered from outside",
        family="outside",
        notes=notes,
        parameters=[*(parameters or []), *common],
        population=_POPULATION,
        iterations=_ITERATIONS,
        evaluations="at most N T",
        module="ikplan.ik.outside.searching",
        kernel="search",
        minimise=minimise,
    )
