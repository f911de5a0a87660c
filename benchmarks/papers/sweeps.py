"""S1 and S2: what IK-BA is for, by the distance of the start and by the number of joints."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.papers.experiment import Study
from benchmarks.papers.series import PLANNER, Series
from benchmarks.papers.sweep_cases import DIMENSIONS, DISTANCES, dimension_case, distance_case

__all__ = ["OWN", "SEARCHES", "dimensions", "distances"]

N, T = 50, 200
SEARCHES = [
    Series("IK-BA", "ik-ba", N, T, {"preset": "bat-code"}),
    Series("IK-BA, uniform noise", "ik-ba", N, T, {"preset": "slim"}),
    Series("DE, cloud", "de-rand-1", N, T, {"preset": "slim", "warm": "cloud"}),
    Series("PSO, cloud", "pso", N, T, {"preset": "slim-permuted", "warm": "cloud"}),
    Series("BODE-CS, warm", "bode-cs", N, 182, {"warm": "individual"}),
    Series("CMA-ES, cloud", "cma-es", N, T, {"warm": "cloud"}),
    Series("L-SHADE, cloud", "l-shade", N, T, {"warm": "cloud"}),
    Series("CMA-ES, cold", "cma-es", N, T),
]
"""All but the last are told where the arm is; about 10,000 evaluations each."""
OWN = Series("ikplan", PLANNER, params={"elongation": "independent"}, paper=False, max_runs=1)
RUNS = 5
"""Runs of each search: the targets are what the tests are over."""
SERIES = [*(replace(s, max_runs=RUNS) for s in SEARCHES), OWN]


def distances(thin: int) -> list[Study]:
    """Return a case a distance; every fifth of the targets where they are thinned at all."""
    del thin
    return [Study(distance_case(degrees), SERIES) for degrees in DISTANCES]


def dimensions(thin: int) -> list[Study]:
    """Return a case a number of joints."""
    del thin
    return [Study(dimension_case(dof), SERIES) for dof in DIMENSIONS]
