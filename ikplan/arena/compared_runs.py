"""What a comparison found: rows, first hits, a summary, tests."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ikplan.arena.run import Run
from ikplan.arena.statistics import Tests, compare_values
from ikplan.arrays import Array

__all__ = ["TARGET_VALUES", "ComparedRuns"]

TARGET_VALUES = 10.0 ** -np.arange(2.0, 9.01, 0.2)
"""Values of the objective to be hit, 10 mm to 1 nm, five a decade [m]."""
_SHOWN = (1e-3, 1e-6)
"""Values that the table counts."""


@dataclass(frozen=True)
class ComparedRuns:
    """The runs of several solvers on the same targets.

    Attributes:
        robot: Name of the robot.
        dof: Number of its joints.
        budget: Most evaluations of a run.
        seeds: Seeds of the runs of each target.
        oriented: Whether the orientation counts.
        runs: Of each solver, a list a target of a run a seed.
    """

    robot: str
    dof: int
    budget: int
    seeds: list[int]
    oriented: bool
    runs: dict[str, list[list[Run]]]

    @property
    def solvers(self) -> list[str]:
        """Labels of the solvers, as they were given."""
        return list(self.runs)

    def values(self, name: str) -> Array:
        """Return the final values of a solver, shape (targets, seeds)."""
        return np.array([[run.value for run in row] for row in self.runs[name]])

    def best_values(self, name: str, evaluations: Array) -> Array:
        """Return the best value of every run after some evaluations; infinity before the first.

        The project's own searches are looked at after their first population and after each
        iteration, solvers from outside after each call of the objective.

        Args:
            name: Label of the solver.
            evaluations: Shape (m,).

        Returns:
            Shape (targets, seeds, m).
        """
        found = np.empty((len(self.runs[name]), len(self.seeds), len(evaluations)))
        for k, row in enumerate(self.runs[name]):
            for s, run in enumerate(row):
                at = np.searchsorted(run.steps, evaluations, side="right") - 1
                found[k, s] = np.where(at >= 0, run.values[np.maximum(at, 0)], np.inf)
        return found

    @cached_property
    def first_hits(self) -> dict[str, Array]:
        """Evaluations until each of ``TARGET_VALUES`` was reached; infinity where it was not.

        Shape (targets, seeds, len(TARGET_VALUES)) of each solver.
        """
        found = {}
        for name, rows in self.runs.items():
            hits = np.full((len(rows), len(self.seeds), len(TARGET_VALUES)), np.inf)
            for k, row in enumerate(rows):
                for s, run in enumerate(row):
                    # Values only fall: the first one at or below a target value.
                    at = np.searchsorted(-run.values, -TARGET_VALUES, side="left")
                    hit = at < len(run.values)
                    hits[k, s, hit] = run.steps[at[hit]]
            found[name] = hits
        return found

    def expected_evaluations(self, name: str, value: float) -> float:
        """Return the expected running time to a value: evaluations of all runs over runs that hit.

        Infinity where none does; Hansen et al., COCO, arXiv 1605.03560.
        """
        spent, hits = 0.0, 0
        for row in self.runs[name]:
            for run in row:
                below = np.flatnonzero(run.values <= value)
                hits += bool(below.size)
                spent += float(run.steps[below[0]]) if below.size else float(run.evaluations)
        return spent / hits if hits else math.inf

    @cached_property
    def tests(self) -> Tests:
        """Ranks, pairs and effect sizes of the final values."""
        return compare_values({name: self.values(name) for name in self.runs})

    def summary(self) -> list[dict[str, Any]]:
        """Return a row a solver, best mean rank first; None where no run reaches a value."""
        rows = []
        for name in sorted(self.runs, key=lambda n: (self.tests.ranks[n], n)):
            runs = [run for row in self.runs[name] for run in row]
            values = np.array([run.value for run in runs])
            low, median, high = np.quantile(values, [0.25, 0.5, 0.75])
            row: dict[str, Any] = {
                "solver": name,
                "mean_rank": self.tests.ranks[name],
                "median": float(median),
                "quartiles": (float(low), float(high)),
                "position_error_median": float(np.median([run.position_error for run in runs])),
                "motion_median": float(np.median([run.motion for run in runs])),
                "runs": len(runs),
            }
            if self.oriented:
                angles = [run.orientation_error for run in runs]
                row["orientation_error_median"] = float(np.nanmedian(angles))
            for value in _SHOWN:
                row[f"share_{value:.0e}"] = float((values <= value).mean())
                spent = self.expected_evaluations(name, value)
                row[f"expected_evaluations_{value:.0e}"] = spent if math.isfinite(spent) else None
            rows.append(row)
        return rows

    def rows(self) -> list[dict[str, Any]]:
        """Return a row a run: solver, target, seed and what was found."""
        return [
            {
                "solver": name,
                "target": k,
                "seed": seed,
                "value": run.value,
                "position_error": run.position_error,
                "orientation_error": run.orientation_error if self.oriented else None,
                "motion": run.motion,
                "evaluations": run.evaluations,
            }
            for name, targets in self.runs.items()
            for k, row in enumerate(targets)
            for seed, run in zip(self.seeds, row, strict=True)
        ]

    def to_csv(self) -> str:
        """Return the rows as CSV, with the first hits beside them (empty: not reached)."""
        text = io.StringIO()
        heads = [f"hit_{value:.1e}" for value in TARGET_VALUES]
        rows = self.rows()
        writer = csv.DictWriter(text, [*rows[0], *heads], lineterminator="\n")
        writer.writeheader()
        hits = np.concatenate([self.first_hits[n].reshape(-1, len(heads)) for n in self.runs])
        for row, hit in zip(rows, hits, strict=True):
            shown = [int(count) if math.isfinite(count) else "" for count in hit]
            writer.writerow({**row, **dict(zip(heads, shown, strict=True))})
        return text.getvalue()
