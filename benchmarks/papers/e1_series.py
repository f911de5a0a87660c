"""The series of E1, and what a run of them amounts to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.rows import Table
from benchmarks.papers.series import OPTIMUM, PLANNER, Series

__all__ = [
    "CALIBRATED",
    "CLOUD",
    "CLOUDS",
    "CONTROLS",
    "GREEDY",
    "IK_BA",
    "LEAST",
    "MISS",
    "OWN",
    "PAPER",
    "WHOLE",
    "WRIST",
    "per_run",
]

Array = NDArray[np.float64]

N, T = 50, 200
MISS = 0.05
"""Error that counts as a miss [cm]: several times what the noise of IK-BA explains."""
IK_BA = Series("IK-BA", "ik-ba", N, T)
CALIBRATED = Series("IK-BA, eps 0.15", "ik-ba", N, T, {"eps_scale": 0.15}, paper=False)
RIVALS = [
    Series("BA", "ba", N, T),
    Series("DE", "de-rand-1", N, T, {"preset": "slim"}),
    Series("PSO", "pso", N, T, {"preset": "slim"}),
    Series("ABC", "abc", N, T),
    Series("MO-PSO", "mo-pso", N, T),
]
PAPER = [IK_BA, *RIVALS]
CLOUD = Series(
    "IK-BA, eps 0.15, cloud", "ik-ba", N, T, {"eps_scale": 0.15, "warm": "cloud"}, paper=False
)
"""The first population drawn around the start: [S] does not say how it is drawn."""
CLOUDS = [
    CLOUD,
    *(
        replace(s, name=f"{s.name}, cloud", params={**s.params, "warm": "cloud"}, paper=False)
        for s in PAPER
    ),
]
CONTROLS = [
    CALIBRATED,
    Series("IK-BA, loudness", "ik-ba", N, T, {"accept": "loudness"}, paper=False),
    Series("BA, tuned", "ba", N, T, {"alpha": 0.97, "gamma": 0.1}, paper=False),
    Series("MO-PSO, knee", "mo-pso", N, T, {"choice": "knee"}, paper=False),
    *(
        replace(s, name=f"{s.name}, warm", params={**s.params, "warm": "individual"}, paper=False)
        for s in RIVALS
    ),
    *CLOUDS,
]
WRIST = Series("IK-BA, wrist limits", "ik-ba", N, T, {"wrist_limits": "penalise"}, paper=False)
WHOLE = Series("ikplan", PLANNER, params={"elongation": "global"}, paper=False)
GREEDY = Series("ikplan, greedy", PLANNER, params={"elongation": "tracking"}, paper=False)
LEAST = Series("least motion", OPTIMUM, paper=False)
OWN = [WHOLE, GREEDY, LEAST]


def per_run(table: Table, column: str, factor: float = 1.0) -> Array:
    """Return the mean over the path of each run."""
    values: Array = factor * table.grid(column).mean(axis=1)
    return values
