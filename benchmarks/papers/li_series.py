"""The series of [L], shared by E7, E8 and E9."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.papers.series import OPTIMUM, PLANNER, Series

__all__ = ["LEAST", "OWN", "controls", "equal_evaluations", "li_series", "newton_series"]

OWN = Series("ikplan", PLANNER, params={"elongation": "independent"}, paper=False, max_runs=3)
LEAST = Series("closed form", OPTIMUM, paper=False)


def li_series(population: int, iterations: int) -> list[Series]:
    """Return the eleven series of the paper's tables, BODE-CS first."""
    methods = {
        "BODE-CS": ("bode-cs", {}),
        "DE/rand/1": ("de-rand-1", {}),
        "DE/best/1": ("de-best-1", {}),
        "DE/best/2": ("de-best-2", {}),
        "DE/rand/2": ("de-rand-2", {}),
        "DE/cur-best/1": ("de-current-to-best-1", {}),
        "SDE": ("sde", {}),
        "CS": ("cs", {}),
        "PSO": ("pso", {"preset": "li"}),
        "GA": ("ga", {}),
        "ODE": ("ode", {}),
    }
    return [
        Series(name, method, population, iterations, dict(params))
        for name, (method, params) in methods.items()
    ]


def controls(population: int, iterations: int) -> list[Series]:
    """Return what the paper should have compared with as well."""
    by_name = {s.name: s for s in li_series(population, iterations)}
    # About as many evaluations as differential evolution: N a generation.
    shares = {"BODE-CS": 0.91, "CS": 0.5, "ODE": 0.75}
    return [
        Series(
            "DE/cur-best/1, F = lambda = 0.5",
            "de-current-to-best-1",
            population,
            iterations,
            {"F": 0.5, "lam": 0.5},
            paper=False,
        ),
        *(
            replace(
                by_name[name],
                name=f"{name}, equal evaluations",
                iterations=round(iterations * share),
                paper=False,
            )
            for name, share in shares.items()
        ),
        Series("SDE, F drawn", "sde", population, iterations, {"F_initial": "normal"}, False),
        Series(
            "BODE-CS, synchronous",
            "bode-cs",
            population,
            iterations,
            {"generation": "synchronous"},
            paper=False,
        ),
        Series(
            "BODE-CS, H of Eq. 29", "bode-cs", population, iterations, {"heaviside": True}, False
        ),
        Series("CS, N(0, 1)", "cs", population, iterations, {"normal_factor": True}, False),
        Series("CS, H of Eq. 29", "cs", population, iterations, {"heaviside": True}, False),
        Series(
            "BODE-CS, F + Fmin",
            "bode-cs",
            population,
            iterations,
            {"scaling": "plus_fmin"},
            paper=False,
        ),
        Series(
            "PSO, w 0.7298",
            "pso",
            population,
            iterations,
            {"preset": "li", "w": 0.7298, "w_end": 0.7298},
            paper=False,
        ),
    ]


def equal_evaluations(paper: list[Series], every: list[Series]) -> list[Series]:
    """Return the paper's series, each where there is one at equal evaluations that instead."""
    by_name = {s.name: s for s in every}
    return [by_name.get(f"{s.name}, equal evaluations", s) for s in paper]


def newton_series() -> list[Series]:
    """Return the four readings of Newton-Raphson."""
    variants: dict[str, dict[str, object]] = {
        "Newton-Raphson": {},
        "Newton-Raphson, clipped": {"limits": "clip"},
        "Newton-Raphson, damped": {"damping": 1e-3},
        "Newton-Raphson, 20 restarts": {"restarts": 20},
    }
    return [Series(name, "newton-raphson", None, 100, params) for name, params in variants.items()]
