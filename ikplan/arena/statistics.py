"""Tests of a comparison: which differences between solvers are there at all.

Runs of two solvers share nothing but the target, so that nothing is paired by run. A solver's
value on a target is its median over seeds; targets are the blocks.

Sources: Demsar, "Statistical Comparisons of Classifiers over Multiple Data Sets", JMLR 2006, 7 (the
Friedman test over blocks, and the diagram); Benavoli, Corani, Mangili, "Should We Really Use
Post-Hoc Tests Based on Mean-Ranks?", JMLR 2016, 17 (Wilcoxon's test for each pair instead); Vargha,
Delaney, J. Educational and Behavioral Statistics 2000, 25(2), the effect size A12; Holm, Scand. J.
Statistics 1979, 6(2).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.stats import friedmanchisquare, rankdata, wilcoxon

from ikplan.arrays import Array
from ikplan.ik.metaheuristic_seeds import generator

__all__ = ["Pair", "Tests", "a12", "compare_values", "holm"]

_RESAMPLES = 1000


@dataclass(frozen=True)
class Pair:
    """Two solvers.

    Attributes:
        a: The one with the lower mean rank.
        b: The other.
        p: Wilcoxon's signed-rank test over targets, two-sided.
        p_holm: The same, corrected by Holm over all pairs.
        effect: A12: probability that a run of ``a`` ends with the smaller value, mean over targets.
        effect_interval: 95 % interval of it, by resampling targets.
    """

    a: str
    b: str
    p: float
    p_holm: float
    effect: float
    effect_interval: tuple[float, float]


@dataclass(frozen=True)
class Tests:
    """What the values of all runs say.

    Attributes:
        ranks: Mean rank over targets of each solver, 1 the best.
        friedman_p: Friedman's test that all ranks are equal; NaN below three solvers or targets.
        pairs: Every pair, each once.
    """

    ranks: dict[str, float]
    friedman_p: float
    pairs: list[Pair]

    def groups(self, level: float = 0.05) -> list[list[str]]:
        """Return the runs of neighbours by rank within which no pair differs, two or more each."""
        order = sorted(self.ranks, key=lambda name: (self.ranks[name], name))
        differ = {frozenset((p.a, p.b)) for p in self.pairs if p.p_holm <= level}
        found: list[list[str]] = []
        for first in range(len(order)):
            last = first
            while last + 1 < len(order) and all(
                frozenset((order[last + 1], name)) not in differ for name in order[first : last + 1]
            ):
                last += 1
            if last > first and not (found and order[last] in found[-1]):
                found.append(order[first : last + 1])
        return found


def holm(p: list[float]) -> list[float]:
    """Return p values corrected for their number by Holm's step-down procedure."""
    corrected, largest = [0.0] * len(p), 0.0
    for done, k in enumerate(sorted(range(len(p)), key=lambda k: p[k])):
        largest = max(largest, min(1.0, (len(p) - done) * p[k]))
        corrected[k] = largest
    return corrected


def a12(a: Array, b: Array) -> float:
    """Return the probability that a value of ``a`` is smaller than one of ``b``; ties half."""
    less = (a[:, None] < b[None, :]).mean()
    return float(less + 0.5 * (a[:, None] == b[None, :]).mean())


def _wilcoxon_p(a: Array, b: Array) -> float:
    difference = a - b
    if not np.any(difference):
        return 1.0
    return float(wilcoxon(difference, zero_method="zsplit", method="auto").pvalue)


def compare_values(values: dict[str, Array]) -> Tests:
    """Test the final values of every solver.

    Args:
        values: Of each solver, shape (targets, seeds).
    """
    names = list(values)
    medians = np.array([np.median(values[name], axis=1) for name in names])
    ranks = rankdata(medians, axis=0).mean(axis=1)
    mean_ranks = {name: float(rank) for name, rank in zip(names, ranks, strict=True)}
    friedman = float("nan")
    if len(names) > 2 and medians.shape[1] > 2 and np.ptp(medians, axis=0).any():
        friedman = float(friedmanchisquare(*medians).pvalue)
    sure = sorted(names, key=lambda name: (mean_ranks[name], names.index(name)))
    drawn = generator(0, medians.shape[1]).integers(
        0, medians.shape[1], (_RESAMPLES, medians.shape[1])
    )
    found = []
    for a, b in itertools.combinations(sure, 2):
        effects = np.array([a12(x, y) for x, y in zip(values[a], values[b], strict=True)])
        low, high = np.quantile(effects[drawn].mean(axis=1), [0.025, 0.975])
        p = _wilcoxon_p(medians[names.index(a)], medians[names.index(b)])
        found.append((a, b, p, float(effects.mean()), (float(low), float(high))))
    corrected = holm([row[2] for row in found])
    pairs = [
        Pair(a, b, p, p_holm, effect, interval)
        for (a, b, p, effect, interval), p_holm in zip(found, corrected, strict=True)
    ]
    return Tests(mean_ranks, friedman, pairs)
