"""What 10,050 evaluations by each search of the registry cost."""

from __future__ import annotations

from benchmarks.speed.measure import Figure, Section
from benchmarks.speed.solvers import rows

__all__ = ["SECTION"]


def run(effort: float) -> list[Figure]:
    """Time every search."""
    costs = rows(max(3, round(15 * effort)))
    return [Figure(c.name, c.ratio, "x FK", most=c.limit) for c in costs]


SECTION = Section("searches", "10,050 evaluations by each search, N = 50, on the iiwa", run)
