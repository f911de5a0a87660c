"""The tests that the papers made, and those they should have made; by SciPy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

__all__ = [
    "Anova",
    "anova",
    "average_ranks",
    "friedman",
    "holm",
    "paired",
    "summary",
]

Array = NDArray[np.float64]


def summary(values: Array, ddof: int = 1) -> list[float]:
    """Return mean, median, standard deviation, maximum and minimum."""
    v = np.asarray(values, dtype=np.float64).ravel()
    spread = float(v.std(ddof=ddof)) if len(v) > ddof else float("nan")
    return [float(v.mean()), float(np.median(v)), spread, float(v.max()), float(v.min())]


@dataclass(frozen=True)
class Anova:
    """One-way analysis of variance, and three tests that need less of the data."""

    ss_between: float
    ss_within: float
    df: tuple[int, int]
    F: float
    p: float
    levene: float
    welch: float
    kruskal: float


def anova(groups: Sequence[Array]) -> Anova:
    """Analyse groups: ANOVA, Levene, Alexander-Govern (for unequal variances), Kruskal-Wallis."""
    if min(len(g) for g in groups) < 3:
        raise ValueError("an analysis of variance needs three runs at least")
    every = np.concatenate(groups)
    between = sum(len(g) * (g.mean() - every.mean()) ** 2 for g in groups)
    within = sum(((g - g.mean()) ** 2).sum() for g in groups)
    F, p = stats.f_oneway(*groups)
    return Anova(
        float(between),
        float(within),
        (len(groups) - 1, len(every) - len(groups)),
        float(F),
        float(p),
        float(stats.levene(*groups).pvalue),
        float(stats.alexandergovern(*groups).pvalue),
        float(stats.kruskal(*groups).pvalue),
    )


def holm(p: Sequence[float]) -> list[float]:
    """Return p-values adjusted by Holm's step-down method."""
    order = np.argsort(p)
    adjusted, running = [0.0] * len(p), 0.0
    for rank, i in enumerate(order):
        running = max(running, (len(p) - rank) * float(p[i]))
        adjusted[i] = min(running, 1.0)
    return adjusted


def paired(a: Array, b: Array) -> tuple[float, float]:
    """Compare two series on the same targets.

    Returns:
        Wilcoxon's signed-rank p, and the matched-pairs rank-biserial correlation: -1 where a is
        smaller throughout, 1 where b is.
    """
    difference = np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)
    difference = difference[difference != 0.0]
    if len(difference) == 0:
        return 1.0, 0.0
    ranks = stats.rankdata(np.abs(difference))
    effect = float((ranks * np.sign(difference)).sum() / ranks.sum())
    return float(stats.wilcoxon(difference).pvalue), effect


def friedman(series: Mapping[str, Array]) -> float:
    """Return the p of Friedman's test over series on the same targets."""
    if len(series) < 3:
        return float("nan")
    return float(stats.friedmanchisquare(*series.values()).pvalue)


def average_ranks(series: Mapping[str, Array]) -> dict[str, float]:
    """Return the average rank of each series over the targets; 1 is the smallest value."""
    ranks = stats.rankdata(np.column_stack(list(series.values())), axis=1)
    return dict(zip(series, ranks.mean(axis=0).tolist(), strict=True))
