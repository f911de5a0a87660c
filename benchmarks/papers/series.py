"""A series: one solver, its parameters and its budget."""

from __future__ import annotations

import hashlib
import json
import zlib
from dataclasses import dataclass, field
from typing import Any

from ikplan.ik.registry import find_solver

__all__ = ["OPTIMUM", "PLANNER", "Series", "context_of", "references"]

PLANNER = "planner"
"""Method of the series of the project's own planner."""
OPTIMUM = "optimum"
"""Method of the series of the true optimum."""


@dataclass(frozen=True)
class Series:
    """One solver, its parameters and its budget.

    Attributes:
        name: Label in the tables.
        method: Name of a solver, or PLANNER, or OPTIMUM.
        population: N; None: the method has none.
        iterations: T.
        params: Parameters that differ from the defaults.
        paper: Whether it is a series of the paper itself, and so in its statistics.
        max_runs: Most runs made of it.
        tracks: Whether each target starts from the solution of the one before; None: as the case.
    """

    name: str
    method: str
    population: int | None = None
    iterations: int = 0
    params: dict[str, Any] = field(default_factory=dict)
    paper: bool = True
    max_runs: int = 1000
    tracks: bool | None = None

    def digest(self) -> str:
        """Return a digest of what its results depend on."""
        params = self.params
        if self.method not in (PLANNER, OPTIMUM):
            params = find_solver(self.method).check(params)  # with the defaults of the day
        data = [self.method, self.population, self.iterations, params, self.tracks]
        return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:8]


def references(population: int, iterations: int) -> list[Series]:
    """Return the two searches of no paper that every comparison has, at the same budget."""
    return [
        Series("CMA-ES", "cma-es", population, iterations, paper=False),
        Series("L-SHADE", "l-shade", population, iterations, paper=False),
    ]


def context_of(case: str, series: Series, run: int, target: int) -> tuple[int, int, int]:
    """Return the context of the random numbers of one solve.

    A CRC of "case/series", the run and the target: no two solves share a stream.
    """
    return zlib.crc32(f"{case}/{series.name}".encode()), run, target
