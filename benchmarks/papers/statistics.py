"""The tests that the papers made, and those they should have made; by SciPy.

Runs of two series share nothing: they are compared by Mann and Whitney's test over the runs, or, on
the same targets, by Wilcoxon's over the medians of each target. Every interval is a percentile
bootstrap of fixed random numbers, so that the same rows give the same report.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

__all__ = [
    "LEVEL",
    "Anova",
    "Comparison",
    "Estimate",
    "adjusted",
    "anova",
    "average_ranks",
    "estimate",
    "friedman",
    "holm",
    "over_runs",
    "over_targets",
    "paired",
    "paired_effect",
    "share",
    "summary",
    "welch",
]

Array = NDArray[np.float64]

LEVEL = 0.05
"""Level of every test, and one minus that of every interval."""
RESAMPLES = 1000


@dataclass(frozen=True)
class Estimate:
    """A figure with its 95 % interval.

    Attributes:
        value: The figure.
        low: Lower end of the interval.
        high: Upper end.
        n: What it is made of, such as "20 runs x 20 targets".
    """

    value: float
    low: float
    high: float
    n: str


@dataclass(frozen=True)
class Comparison:
    """A test of two series, with its effect.

    Attributes:
        p: p-value, adjusted where :func:`adjusted` made it.
        effect: Mann-Whitney: A12, the probability that a run of the first is smaller, 1/2 without
            a difference. Wilcoxon: 1/2 (1 - r) with r the matched-pairs rank-biserial correlation,
            so 1 where the first is smaller at every target.
        low: Lower end of the effect's 95 % interval.
        high: Upper end.
        n: What is compared.
        test: Name of the test.
    """

    p: float
    effect: float
    low: float
    high: float
    n: str
    test: str

    @property
    def first_is_smaller(self) -> bool:
        """Whether the first is smaller at the level of 0.05."""
        return self.p < LEVEL and self.effect > 0.5

    @property
    def second_is_smaller(self) -> bool:
        """Whether the second is smaller at the level of 0.05."""
        return self.p < LEVEL and self.effect < 0.5

    def told(self) -> str:
        """Return p and effect in words."""
        return f"p = {self.p:.1g}, {self.effect:.2f} ({self.low:.2f} to {self.high:.2f})"


def _resampled(size: int, seed: int) -> NDArray[np.int64]:
    rng = np.random.Generator(np.random.PCG64(seed))
    return rng.integers(0, size, (RESAMPLES, size))


def _interval(values: Array) -> tuple[float, float]:
    low, high = np.quantile(values, [0.5 * LEVEL, 1.0 - 0.5 * LEVEL])
    return float(low), float(high)


def estimate(
    grid: Array, statistic: Callable[[Array], float] = lambda v: float(v.mean())
) -> Estimate:
    """Return a statistic of all solves with a bootstrap interval over runs and targets.

    Args:
        grid: Values, shape (runs, targets) or (runs, targets, series): all series of a run and
            target are drawn together.
        statistic: Of an array of that shape.
    """
    runs, targets = grid.shape[:2]
    rows, columns = _resampled(runs, 1), _resampled(targets, 2)
    drawn = [statistic(grid[np.ix_(i, j)]) for i, j in zip(rows, columns, strict=True)]
    low, high = _interval(np.array(drawn))
    return Estimate(statistic(grid), low, high, f"{runs} runs x {targets} targets")


def share(values: Array, bound: float) -> Estimate:
    """Return the share of runs at or below a bound, with Wilson's interval."""
    n, hits = len(values), int((values <= bound).sum())
    result = stats.binomtest(hits, n).proportion_ci(1.0 - LEVEL, "wilson")
    return Estimate(hits / n, float(result.low), float(result.high), f"{n} runs")


def over_runs(a: Array, b: Array) -> Comparison:
    """Compare runs of two series by Mann and Whitney's test and A12 (Vargha, Delaney 2000).

    Args:
        a: A value a run of the first, shape (runs,).
        b: The same of the second; its runs are not those of the first.
    """
    less = (a[:, None] < b[None, :]) + 0.5 * (a[:, None] == b[None, :])
    rows, columns = _resampled(len(a), 3), _resampled(len(b), 4)
    drawn = less[rows[:, :, None], columns[:, None, :]].mean(axis=(1, 2))
    low, high = _interval(drawn)
    p = 1.0 if np.ptp(np.concatenate([a, b])) == 0.0 else float(stats.mannwhitneyu(a, b).pvalue)
    n = f"{len(a)} and {len(b)} runs"
    return Comparison(p, float(less.mean()), low, high, n, "Mann-Whitney, A12")


def over_targets(a: Array, b: Array) -> Comparison:
    """Compare two series on the same targets by Wilcoxon's test over one value a target.

    Args:
        a: Median over the runs of the first at each target, shape (targets,).
        b: The same of the second.
    """
    p, r = paired(a, b)
    low, high = _interval(0.5 * (1.0 - _paired_effects((a - b)[_resampled(len(a), 5)])))
    return Comparison(p, 0.5 * (1.0 - r), low, high, f"{len(a)} targets", "Wilcoxon, rank-biserial")


def adjusted(comparisons: Sequence[Comparison]) -> list[Comparison]:
    """Return the comparisons of one claim, one family, with p adjusted by Holm's method."""
    values = holm([c.p for c in comparisons])
    return [replace(c, p=p) for c, p in zip(comparisons, values, strict=True)]


def welch(values: Array, mean: float, deviation: float, n: int) -> float:
    """Return the p of Welch's test of runs against a printed mean, deviation (ddof 1) and n."""
    own = float(values.std(ddof=1))
    result = stats.ttest_ind_from_stats(
        float(values.mean()), own, len(values), mean, deviation, n, equal_var=False
    )
    return float(result.pvalue)


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
    return float(stats.wilcoxon(difference).pvalue), paired_effect(difference)


def paired_effect(difference: Array) -> float:
    """Return the matched-pairs rank-biserial correlation of differences; 0 without any."""
    return float(_paired_effects(difference[None])[0])


def _paired_effects(differences: Array) -> Array:
    """Return the matched-pairs rank-biserial correlation of each row, shape (rows,)."""
    zero = differences == 0.0
    # Zeros are left out: the smallest, so the ranks of the others are less by their number.
    ranks = stats.rankdata(np.abs(differences), axis=1) - zero.sum(axis=1, keepdims=True)
    ranks[zero] = 0.0
    total = ranks.sum(axis=1)
    signed = (ranks * np.sign(differences)).sum(axis=1)
    return np.asarray(np.divide(signed, total, out=np.zeros_like(total), where=total > 0.0))


def friedman(series: Mapping[str, Array]) -> float:
    """Return the p of Friedman's test over series on the same targets."""
    if len(series) < 3:
        return float("nan")
    return float(stats.friedmanchisquare(*series.values()).pvalue)


def average_ranks(series: Mapping[str, Array]) -> dict[str, float]:
    """Return the average rank of each series over the targets; 1 is the smallest value."""
    ranks = stats.rankdata(np.column_stack(list(series.values())), axis=1)
    return dict(zip(series, ranks.mean(axis=0).tolist(), strict=True))
