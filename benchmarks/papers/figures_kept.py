"""The figures kept of every series: the median of each target, mean and maximum of each run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers.rows import read_rows

__all__ = ["FLOOR", "NEAR", "figures_of", "same_figures"]

COLUMNS = ("eps_p", "theta_deg", "elongation_deg")
NEAR = 1e-6
"""Figures within this share of each other are the same, as far as single precision tells."""
FLOOR = 1e-9
"""Below this [m or deg] a figure is rounding, and differs from one processor to another."""


def figures_of(label: str, paths: list[Path]) -> dict[str, NDArray[np.float32]]:
    """Return the figures of the rows of a series, by "case/series/figure".

    Args:
        label: "case/series".
        paths: The rows of each run.
    """
    table = read_rows(paths)
    made = {}
    for column in COLUMNS:
        grid = table.grid(column)
        if not np.isnan(grid).all():
            made[f"{label}/{column}"] = np.median(grid, axis=0).astype(np.float32)
    grid = table.grid("eps_p")
    runs = np.array([grid.mean(axis=1), grid.max(axis=1)])
    made[f"{label}/runs"] = runs.astype(np.float32)
    return made


def same_figures(label: str, paths: list[Path], kept: Mapping[str, NDArray[np.float32]]) -> bool:
    """Whether rows have the figures that are kept, within :data:`NEAR`.

    Args:
        label: "case/series".
        paths: The rows of each run.
        kept: The figures kept, by "case/series/figure".
    """
    for name, made in figures_of(label, paths).items():
        if name not in kept or kept[name].shape != made.shape:
            return False
        old, new = kept[name].astype(np.float64), made.astype(np.float64)
        if not np.allclose(new, old, rtol=NEAR, atol=FLOOR, equal_nan=True):
            return False
    return True
