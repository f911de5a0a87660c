"""The series of E1, and what a run of them amounts to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.rows import Table
from benchmarks.papers.series import OPTIMUM, PLANNER, Series, references

__all__ = [
    "AROUND",
    "CLOUD",
    "CONTROLS",
    "GREEDY",
    "IK_BA",
    "LEAST",
    "MISS",
    "OWN",
    "PAPER",
    "REFERENCES",
    "UNIFORM",
    "WHOLE",
    "WRIST",
    "around",
    "per_run",
]

Array = NDArray[np.float64]

N, T = 50, 200
MISS = 0.05
"""Error that counts as a miss [cm]: several times what the noise of IK-BA explains."""
IK_BA = Series("IK-BA", "ik-ba", N, T, {"preset": "bat-code"})
"""With the noise of circulating bat code, 0.1 N(0, 1)."""
UNIFORM = Series("IK-BA, uniform noise", "ik-ba", N, T, {"preset": "slim"}, paper=False)
PRINTED_PSO = Series("PSO, as printed", "pso", N, T, {"preset": "slim"}, paper=False)
RIVALS = [
    Series("BA", "ba", N, T),
    Series("DE", "de-rand-1", N, T, {"preset": "slim"}),
    Series("PSO", "pso", N, T, {"preset": "slim-permuted"}),
    Series("ABC", "abc", N, T),
    Series("MO-PSO", "mo-pso", N, T),
]
PAPER = [IK_BA, *RIVALS]
REFERENCES = references(N, T)


def around(series: Series) -> Series:
    """Return the series with a first population around the start."""
    params = {**series.params, "warm": "cloud"}
    return replace(series, name=f"{series.name}, cloud", params=params, paper=False)


CLOUD = around(IK_BA)
"""IK-BA with the first population around the start."""
AROUND = [around(s) for s in [*PAPER, *REFERENCES]]
"""All with the first population drawn around the start: [S] does not say how it is drawn."""
CONTROLS = [
    *REFERENCES,
    UNIFORM,
    PRINTED_PSO,
    Series("BA, tuned", "ba", N, T, {"alpha": 0.97, "gamma": 0.1}, paper=False),
    Series("MO-PSO, knee", "mo-pso", N, T, {"choice": "knee"}, paper=False),
    *AROUND,
    around(UNIFORM),
]
WRIST = Series(
    "IK-BA, wrist limits",
    "ik-ba",
    N,
    T,
    {"preset": "bat-code", "wrist_limits": "penalise"},
    paper=False,
)
WHOLE = Series("ikplan", PLANNER, params={"elongation": "global"}, paper=False)
GREEDY = Series("ikplan, greedy", PLANNER, params={"elongation": "tracking"}, paper=False)
LEAST = Series("least motion", OPTIMUM, paper=False)
OWN = [WHOLE, GREEDY, LEAST]


def per_run(table: Table, column: str, factor: float = 1.0) -> Array:
    """Return the mean over the path of each run."""
    values: Array = factor * table.grid(column).mean(axis=1)
    return values
