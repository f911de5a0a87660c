"""The figure of a comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from ikplan.arena.compared_runs import ComparedRuns
from ikplan.errors import InvalidRequest
from ikplan.plans.figures.style import colour, line_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


__all__ = ["draw_comparison"]

_LEAST = 1e-12
"""Values below are drawn here: what is left is rounding."""
_LEVEL = 0.05


def draw_comparison(found: ComparedRuns, axes: Any = None) -> Figure:
    """Draw fixed budget, share of target values reached, evaluations to a value, and mean ranks.

    Args:
        found: The comparison.
        axes: Four axes; None: a new figure.

    Raises:
        InvalidRequest: Not four axes.
    """
    if axes is None:
        figure = Figure(figsize=(11.0, 8.0), layout="constrained")
        axes = figure.subplots(2, 2)
        figure.suptitle(
            f"{found.robot}: {len(next(iter(found.runs.values())))} targets, "
            f"{len(found.seeds)} runs each"
        )
    four = list(np.asarray(axes, dtype=object).ravel())
    if len(four) != 4:
        raise InvalidRequest("axes: must be four", field="axes", allowed="4 axes")
    styles = {name: (colour(k), line_style(k)) for k, name in enumerate(found.solvers)}
    counts = np.unique(np.geomspace(1, found.budget, 160).astype(np.int64)).astype(np.float64)
    _fixed_budget(four[0], found, styles, counts)
    _reached(four[1], found, styles, counts)
    _evaluations(four[2], found, styles)
    _ranks(four[3], found, styles)
    drawn: Figure = four[0].figure
    return drawn


def _fixed_budget(ax: Axes, found: ComparedRuns, styles: Any, counts: Any) -> None:
    for name, (shade, dash) in styles.items():
        values = found.best_values(name, counts).reshape(-1, len(counts))
        seen = np.isfinite(values).all(axis=0)
        low, median, high = np.quantile(
            np.maximum(values[:, seen], _LEAST), [0.25, 0.5, 0.75], axis=0
        )
        ax.fill_between(counts[seen], low, high, color=shade, alpha=0.12, linewidth=0)
        ax.plot(counts[seen], median, color=shade, linestyle=dash, label=name)
    ax.set(xscale="log", yscale="log", xlabel="evaluations", ylabel="best value [m]")
    ax.set_title("median and quartiles of all runs", fontsize=10)
    ax.legend(fontsize=8, frameon=False)


def _reached(ax: Axes, found: ComparedRuns, styles: Any, counts: Any) -> None:
    for name, (shade, dash) in styles.items():
        hits = found.first_hits[name].ravel()
        share = (hits[None, :] <= counts[:, None]).mean(axis=1)
        ax.plot(counts, share, color=shade, linestyle=dash, label=name)
    ax.set(xscale="log", ylim=(0.0, 1.0), xlabel="evaluations")
    ax.set_ylabel("share of runs and values, 10 mm to 1 nm")
    ax.set_title("values reached", fontsize=10)


def _evaluations(ax: Axes, found: ComparedRuns, styles: Any) -> None:
    values = 10.0 ** -np.arange(2.0, 9.01, 0.5)
    for name, (shade, dash) in styles.items():
        spent = np.array([found.expected_evaluations(name, value) for value in values])
        met = np.isfinite(spent)
        ax.plot(values[met], spent[met], color=shade, linestyle=dash, marker=".", label=name)
    # Nothing may be drawn at all: where no run reaches any value.
    ax.set(xscale="log", yscale="log", xlim=(1.5e-2, 7e-10), ylim=(10.0, 100.0 * found.budget))
    ax.set(xlabel="value to be reached [m]", ylabel="expected evaluations")
    ax.set_title("all evaluations over runs that reach it", fontsize=10)


def _ranks(ax: Axes, found: ComparedRuns, styles: Any) -> None:
    """The critical difference diagram: a bar joins neighbours of which no pair differs."""
    tests = found.tests
    order = sorted(tests.ranks, key=lambda name: (tests.ranks[name], name))
    n = len(order)
    for row, name in enumerate(order):
        shade, _ = styles[name]
        ax.plot(tests.ranks[name], n - row, "o", color=shade)
        ax.annotate(
            f"{name}  {tests.ranks[name]:.2f}",
            (tests.ranks[name], n - row),
            xytext=(8, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    for group in tests.groups(_LEVEL):
        rows = [n - order.index(name) for name in group]
        left = min(tests.ranks[name] for name in group) - 0.12
        ax.plot([left, left], [min(rows) - 0.2, max(rows) + 0.2], color="#333333", linewidth=3)
    ax.set(xlim=(0.6, n + 1.2), ylim=(0.4, n + 0.6), xlabel="mean rank over targets", yticks=[])
    ax.set_title(f"a bar joins what does not differ (Wilcoxon, Holm, {_LEVEL:g})", fontsize=10)
