"""Rows of results: one a (case, series, run, target), kept as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["COLUMNS", "Table", "read_rows", "write_rows"]

COLUMNS = (
    "run",
    "target",
    "f",
    "eps_p",
    "delta_R",
    "theta_deg",
    "elongation_deg",
    "elongation_searched_deg",
    "n_eval",
    "n_iter",
    "seconds",
    "cpu_seconds",
    "violations",
)
"""eps_p in metres, joint motions in degrees; joint values [rad] follow as q1, q2, ..."""


class Table:
    """Rows of one series as columns.

    Args:
        data: Shape (rows, columns), columns as in COLUMNS and then the joint values.
    """

    def __init__(self, data: NDArray[np.float64]) -> None:
        self.data = data

    def __len__(self) -> int:
        return len(self.data)

    def __getitem__(self, column: str) -> NDArray[np.float64]:
        return self.data[:, COLUMNS.index(column)]

    @property
    def q(self) -> NDArray[np.float64]:
        """Joint values, shape (rows, dof) [rad]."""
        return self.data[:, len(COLUMNS) :]

    def grid(self, column: str) -> NDArray[np.float64]:
        """Return a column as runs by targets, shape (runs, targets)."""
        runs = len(np.unique(self["run"]))
        return self[column].reshape(runs, -1)

    def where(self, mask: NDArray[np.bool_]) -> Table:
        """Return the rows of some targets: ``mask`` has one flag a target."""
        return Table(self.data[mask[self["target"].astype(int)]])


def write_rows(path: Path, rows: Iterable[Sequence[float]], dof: int) -> None:
    """Write rows as CSV, at once or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".part")
    with temporary.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*COLUMNS, *(f"q{k + 1}" for k in range(dof))])
        writer.writerows([[repr(float(v)) for v in row] for row in rows])
    temporary.replace(path)


def read_rows(paths: Sequence[Path]) -> Table:
    """Read the rows of one series."""
    parts = []
    for path in paths:
        with path.open(newline="") as file:
            reader = csv.reader(file)
            header = next(reader)
            parts.append(np.array([[float(v) for v in row] for row in reader]))
            assert tuple(header[: len(COLUMNS)]) == COLUMNS
    return Table(np.vstack(parts))
