"""A comparison as Markdown."""

from __future__ import annotations

import math
from typing import Any

from ikplan.arena.compared_runs import ComparedRuns

__all__ = ["comparison_table"]


def _number(value: float | None) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.3g}"


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def comparison_table(found: ComparedRuns) -> str:
    """Return the summary and the tests of each pair."""
    count = len(next(iter(found.runs.values())))
    lines = [
        f"{found.robot}, {count} targets, {len(found.seeds)} runs each, "
        f"at most {found.budget:,} evaluations a run.",
        "",
    ]
    heads = ["solver", "mean rank", "median value", "quartiles", "tool [mm]"]
    heads += ["orientation [deg]"] if found.oriented else []
    heads += ["motion [rad]", "<= 1e-3", "evaluations to it", "<= 1e-6", "evaluations to it"]
    lines += [_row(heads), _row(["---"] * len(heads))]
    for row in found.summary():
        lines.append(_row(_cells(row, oriented=found.oriented)))
    tests = found.tests
    if math.isfinite(tests.friedman_p):
        lines += ["", f"Friedman's test over targets: p = {_number(tests.friedman_p)}."]
    if tests.pairs:
        heads = ["pair", "p (Wilcoxon over targets)", "p (Holm)", "A12 [95 % interval]"]
        lines += ["", _row(heads), _row(["---"] * len(heads))]
        for pair in tests.pairs:
            low, high = pair.effect_interval
            effect = f"{pair.effect:.2f} [{low:.2f}, {high:.2f}]"
            cells = [f"{pair.a} before {pair.b}", _number(pair.p), _number(pair.p_holm), effect]
            lines.append(_row(cells))
    return "\n".join(lines) + "\n"


def _cells(row: dict[str, Any], *, oriented: bool) -> list[str]:
    low, high = row["quartiles"]
    cells = [
        row["solver"],
        f"{row['mean_rank']:.2f}",
        _number(row["median"]),
        f"{_number(low)} to {_number(high)}",
        _number(1e3 * row["position_error_median"]),
    ]
    if oriented:
        cells.append(_number(math.degrees(row["orientation_error_median"])))
    cells.append(f"{row['motion_median']:.2f}")
    for value in ("1e-03", "1e-06"):
        cells.append(f"{100.0 * row[f'share_{value}']:.0f} %")
        cells.append(_number(row[f"expected_evaluations_{value}"]))
    return cells
