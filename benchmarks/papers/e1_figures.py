"""The figures of E1."""

from __future__ import annotations

import numpy as np

from benchmarks.papers.document import Document
from benchmarks.papers.e1_series import CLOUD, IK_BA, PAPER, REFERENCES, UNIFORM, WHOLE, per_run
from benchmarks.papers.experiment import Results, Study
from benchmarks.papers.plots import boxes, curves, legend_below, new_figure, paths_3d
from ikplan.kinematics.forward import forward_batch

__all__ = ["draw_boxes", "draw_paths"]


def draw_boxes(study: Study, results: Results, document: Document) -> None:
    """Draw box plots of error, motion and time, and both by point."""
    case = study.case
    tables = {
        s.name: results.tables[case.name, s.name]
        for s in [*PAPER, *REFERENCES, UNIFORM, CLOUD, WHOLE]
    }
    searched = {name: table for name, table in tables.items() if name != WHOLE.name}
    figure, axes = new_figure(12.0, 3.8, 3)
    errors = {n: per_run(t, "eps_p", 100.0) for n, t in searched.items()}
    boxes(axes[0], errors, "position error [cm]", log=True)
    motion = {n: per_run(t, "elongation_deg") for n, t in tables.items()}
    boxes(axes[1], motion, "joint variation [deg]")
    time = {n: per_run(t, "cpu_seconds", 1e3) for n, t in tables.items()}
    boxes(axes[2], time, "processor time [ms]")
    document.figure(
        figure,
        f"{case.name}-boxes",
        f"{case.name}: means over the path of each run (Figures 10-12 of the paper); the position "
        "error of ikplan is rounding",
    )
    figure, axes = new_figure(11.0, 4.0, 2)
    errors = {n: 100.0 * t.grid("eps_p").mean(axis=0) for n, t in searched.items()}
    curves(axes[0], errors, "point", "mean position error [cm]", log=True, first=1)
    motion = {n: t.grid("elongation_deg").mean(axis=0) for n, t in tables.items()}
    curves(axes[1], motion, "point", "mean joint variation [deg]", first=1)
    legend_below(figure, axes[1])
    document.figure(figure, f"{case.name}-points", f"{case.name}: by point (Figures 6-8)")


def draw_paths(study: Study, results: Results, document: Document) -> None:
    """Draw joints and paths of the first run."""
    case = study.case
    figure, axes = new_figure(12.0, 3.6, 3)
    for ax, name in zip(axes, (IK_BA.name, "DE", WHOLE.name), strict=True):
        q = np.degrees(results.tables[case.name, name].q[:20])
        lines = {f"q{k + 1}": q[:, k] for k in range(7)}
        curves(ax, lines, "point", f"{name} [deg]", first=1)
    legend_below(figure, axes[0])
    document.figure(figure, f"{case.name}-joints", f"{case.name}: joints, first run (Figure 9)")
    panels = []
    for name in (IK_BA.name, "PSO", WHOLE.name):
        _, p = forward_batch(case.arm.chain, results.tables[case.name, name].q[:20].copy())
        panels.append((name, {"asked": case.p, "reached": p}))
    document.figure(
        paths_3d(panels, 10.0, 3.4, "m"),
        f"{case.name}-paths",
        f"{case.name}: paths of the first run",
    )
