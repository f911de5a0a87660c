"""The figures of E1."""

from __future__ import annotations

import numpy as np

from benchmarks.papers.document import Document
from benchmarks.papers.e1_series import CALIBRATED, IK_BA, PAPER, WHOLE, per_run
from benchmarks.papers.experiment import Results, Study
from benchmarks.papers.plots import boxes, curves, new_figure, paths_3d
from ikplan.kinematics.forward import forward_batch

__all__ = ["draw"]


def draw(study: Study, results: Results, document: Document) -> None:
    """Draw box plots, errors and motion by point, joints and paths."""
    case = study.case
    tables = {s.name: results.tables[case.name, s.name] for s in [*PAPER, CALIBRATED]}
    figure, axes = new_figure(11.0, 3.4, 3)
    boxes(
        axes[0],
        {n: per_run(t, "eps_p", 100.0) for n, t in tables.items()},
        "position error [cm]",
        log=True,
    )
    boxes(
        axes[1],
        {n: per_run(t, "elongation_deg") for n, t in tables.items()},
        "joint variation [deg]",
    )
    boxes(
        axes[2],
        {n: per_run(t, "cpu_seconds", 1e3) for n, t in tables.items()},
        "processor time [ms]",
    )
    document.figure(
        figure,
        f"{case.name}-boxes",
        f"{case.name}: means over the path of each run (Figures 10-12 of the paper)",
    )
    every = {s.name: results.tables[case.name, s.name] for s in [*PAPER, CALIBRATED, WHOLE]}
    figure, axes = new_figure(10.0, 3.6, 2)
    curves(
        axes[0],
        {n: np.maximum(100.0 * t.grid("eps_p").mean(axis=0), 1e-14) for n, t in every.items()},
        "point",
        "mean position error [cm]",
        log=True,
        first=1,
    )
    curves(
        axes[1],
        {n: t.grid("elongation_deg").mean(axis=0) for n, t in every.items()},
        "point",
        "mean joint variation [deg]",
        first=1,
        legend=False,
    )
    document.figure(figure, f"{case.name}-points", f"{case.name}: by point (Figures 6-8)")
    figure, axes = new_figure(11.0, 3.2, 3)
    for ax, name in zip(axes, (IK_BA.name, "DE", WHOLE.name), strict=True):
        q = np.degrees(results.tables[case.name, name].q[:20])
        lines = {f"q{k + 1}": q[:, k] for k in range(7)}
        curves(ax, lines, "point", f"{name} [deg]", first=1, legend=ax is axes[0])
    document.figure(figure, f"{case.name}-joints", f"{case.name}: joints, first run (Figure 9)")
    panels = []
    for name in (IK_BA.name, "BA", WHOLE.name):
        _, p = forward_batch(case.arm.chain, results.tables[case.name, name].q[:20].copy())
        panels.append((name, {"asked": case.p, "reached": p}))
    document.figure(
        paths_3d(panels, 10.0, 3.4, "m"),
        f"{case.name}-paths",
        f"{case.name}: paths of the first run",
    )
