"""Searches on the sphere and Rosenbrock's function converge to stated values.

Values are medians of nine seeds, N = 40, T = 250, four dimensions in [-4, 7], which is not centred
on the optimum. They are three to ten times what was measured. As many random samples reach 0.43 on
the sphere and 27 on Rosenbrock's function.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.ik.metaheuristics.runs import POPULATION_SEARCHES, ROSENBROCK, SPHERE, problem, run

LIMITS = {
    # search, with an option: (sphere, Rosenbrock)
    "abc": (1e-27, 0.1),
    "ba": (1e-5, 0.1),
    "cma-es": (1e-15, 1e-13),
    "l-shade": (1e-20, 1e-8),
    "bat": (0.08, 10.0),
    "bat decay=iteration": (0.03, 20.0),
    "bat decay=iteration noise=component": (1e-6, 0.5),
    "bode-cs": (1e-60, 1e-20),
    "cs": (1e-8, 0.1),
    "de-best-1": (1e-21, 1e-3),
    "de-best-2": (1e-21, 1e-3),
    "de-current-to-best-1": (0.15, 12.0),
    "de-rand-1": (1e-13, 0.5),
    "de-rand-2": (1e-13, 0.5),
    "ga": (5e-6, 0.5),
    "gsa": (0.05, 8.0),
    "gsa alpha=20": (1e-17, 6.0),
    "ik-ba": (1e-7, 1.0),
    "mo-pso": (0.25, 9.0),
    "ode": (1e-26, 0.01),
    "pso preset=kanagaraj": (0.01, 6.0),
    "pso preset=li": (1e-35, 0.1),
    "sde": (1e-14, 0.6),
    "sde F_initial=normal": (1e-28, 0.6),
    "woa": (1e-70, 0.05),
}
OPTIONS: dict[str, dict[str, object]] = {
    "bat decay=iteration": {"decay": "iteration"},
    "bat decay=iteration noise=component": {"decay": "iteration", "noise": "component"},
    "sde F_initial=normal": {"F_initial": "normal"},
    "gsa alpha=20": {"alpha": 20.0},
    "pso preset=kanagaraj": {"preset": "kanagaraj"},
    "pso preset=li": {"preset": "li"},
}


def median(name: str, kind: int) -> float:
    q_s = [2.5, 2.5, 2.5, 2.5]
    task = problem(4, 40, 250, kind=kind, low=-4.0, high=7.0, q_s=q_s)
    options = OPTIONS.get(name, {})
    return float(np.median([run(name.split()[0], task, s, **options).f[0] for s in range(9)]))


def test_every_search_has_its_limits() -> None:
    assert {name.split()[0] for name in LIMITS} == set(POPULATION_SEARCHES)


@pytest.mark.parametrize("name", LIMITS)
def test_sphere(name: str) -> None:
    assert median(name, SPHERE) <= LIMITS[name][0]


@pytest.mark.parametrize("name", LIMITS)
def test_rosenbrock(name: str) -> None:
    assert median(name, ROSENBROCK) <= LIMITS[name][1]


def test_an_inertia_above_one_does_not_converge() -> None:
    # Slim's parameters, w = 1.13: no better than random sampling, as the catalogue's note says.
    assert median("pso", SPHERE) > 0.01
