"""A comparison as files: rows, table, figure, and the runs as COCO's tools read them."""

from __future__ import annotations

import json
import re
from pathlib import Path

from ikplan._version import __version__
from ikplan.arena.compared_runs import ComparedRuns
from ikplan.arena.figures import draw_comparison
from ikplan.arena.tables import comparison_table
from ikplan.plans.figures.style import METADATA, style

__all__ = ["save_coco", "save_comparison"]

_PRECISION = 1e-9
"""The smallest value that is looked for [m]."""
_HEAD = (
    "% f evaluations | g evaluations | best noise-free fitness - Fopt (0.000000000000e+00) + sum "
    "g_i+ | measured fitness | best measured fitness or single-digit g-values\n"
)
"""Column heads by which COCO's tools know the format, one before each run."""


def save_comparison(found: ComparedRuns, folder: Path) -> list[Path]:
    """Write every file of a comparison, see :meth:`ikplan.Comparison.save`.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows, table, image = folder / "rows.csv", folder / "table.md", folder / "comparison.png"
    rows.write_text(found.to_csv())
    table.write_text(comparison_table(found))
    with style():
        draw_comparison(found).savefig(image, dpi=150, metadata=METADATA[".png"])
    return [rows, table, image, *save_coco(found, folder / "coco")]


def save_coco(found: ComparedRuns, folder: Path) -> list[Path]:
    """Write the runs in COCO's format, a folder a solver: cocopp and IOHanalyzer read it.

    The robot is function 1 in as many dimensions as it has joints, and every target with every seed
    an instance. The smallest value is taken to be 0.

    Raises:
        OSError: A file cannot be written.
    """
    written = []
    for name, targets in found.runs.items():
        place = folder / re.sub(r"[^\w.-]+", "_", name)
        data = place / "data_f1"
        data.mkdir(parents=True, exist_ok=True)
        runs = [run for row in targets for run in row]
        lines, ends = [], []
        for k, run in enumerate(runs, start=1):
            lines.append(_HEAD)
            for count, value in zip(run.steps, run.values, strict=True):
                lines.append(f"{count} 0 {value:.9e} {value:.9e} {value:.9e}\n")
            if run.steps[-1] < run.evaluations:
                last = run.values[-1]
                lines.append(f"{run.evaluations} 0 {last:.9e} {last:.9e} {last:.9e}\n")
            ends.append(f"{k}:{run.evaluations}|{run.value:.1e}")
        stem = f"bbobexp_f1_DIM{found.dof}"
        for suffix in (".dat", ".tdat"):
            (data / f"{stem}{suffix}").write_text("".join(lines))
        info = place / "bbobexp_f1.info"
        info.write_text(
            f"suite = 'bbob', funcId = 1, DIM = {found.dof}, Precision = {_PRECISION:.3e}, "
            f"algId = {json.dumps(name)[1:-1]!r}, coco_version = '', logger = 'bbob', "
            f"data_format = 'bbob-new2'\n% {found.robot}, ikplan {__version__}\n"
            f"data_f1/{stem}.dat, {', '.join(ends)}\n"
        )
        written.append(info)
    return written
