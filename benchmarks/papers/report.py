"""The report: a section an experiment, kept as Markdown, joined in order."""

from __future__ import annotations

import platform
from pathlib import Path

import numba
import numpy as np
import pinocchio as pin

from benchmarks.papers.claims import write_claims
from benchmarks.papers.cost import cost_section
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results
from benchmarks.papers.runner import find_experiment, studies_of
from benchmarks.papers.summary import read_seeds, summary

__all__ = ["Sections"]

READING = (
    "[S] Slim et al., Robotics 2023, 12, 38 (IK-BA). [K] Kanagaraj et al., MENDEL 2022, 28(1), "
    "41-54 (BAT, GSA, PSO, WOA). [L] Li, Luo, Qiao, Machines 2023, 11(6), 648 (BODE-CS). Four "
    "rows of every comparison are in no paper: CMA-ES (with restarts) and L-SHADE, at the same "
    "budget of evaluations; `ikplan`, the project's own planner (IK-BA seeds, refinement, least "
    "joint motion); and the true optimum where it can be computed: the least joint motion found "
    "by many restarts on the iiwa and the MH5, the closed form of the Dobot and of the EOD arm."
)
RUNS = 20
"""Runs that the experiments ask for."""
FEW = (
    "**Fewer runs than the 20 asked for: {}.** The commands above with `--runs 20` make what is "
    "missing and keep what is there."
)
ABSENT = (
    "**Not made yet, so without a section here: {}.** `python -m benchmarks.papers --runs 20 "
    "--report benchmarks/papers/REPORT.md` makes them."
)
ORDER = ("E1", "E2", "E3", "E4", "E5", "E6", "E7", "E8", "E9", "D", "S1", "S2")
TEXT = Path(__file__).parent / "text"
"""What people have to say about the full run."""


class Sections:
    """The sections of a report.

    Args:
        report: The Markdown to be written; figures go beside it, into ``figures``.
        folder: Where sections are kept, so that experiments can be run one by one.
    """

    def __init__(self, report: Path, folder: Path) -> None:
        self.report = report
        self.folder = folder

    def write(
        self, experiment: Experiment, results: Results, runs: int, thin: int, seed: int = 0
    ) -> None:
        """Write the section of an experiment; of another seed than 0 only its claims."""
        folder = self.folder / f"seed-{seed}" if seed else self.folder
        document = Document(
            folder / "figures" if seed else self.report.parent / "figures", "figures"
        )
        document.heading(f"{experiment.name}: {experiment.title}")
        studies = studies_of(experiment.name, thin)
        whole = studies_of(experiment.name, 1)
        fewer = any(a.case.count < b.case.count for a, b in zip(studies, whole, strict=True))
        targets = f", every {thin}th target" if fewer else ""
        most = max(series.max_runs for study in studies for series in study.series)
        seconds = sum(float(table["cpu_seconds"].sum()) for table in results.tables.values())
        document.say(
            f"Runs: {min(runs, most)}{targets}. The solves took {seconds / 60.0:.1f} minutes of "
            "processor time."
        )
        experiment.report(studies, results, document)
        folder.mkdir(parents=True, exist_ok=True)
        write_claims(folder / f"{experiment.name}.json", document.claims)
        options = f"--runs {runs}" + (f" --thin {thin}" if thin > 1 else "")
        (folder / f"{experiment.name}.options").write_text(options)
        (folder / f"{experiment.name}.seconds").write_text(f"{seconds:.1f}")
        if not seed:
            (folder / f"{experiment.name}.md").write_text(document.text())

    def join(self, effort: float = 1.0) -> None:
        """Join all sections there are.

        Args:
            effort: Share of the repeats in the table of costs, in (0, 1].
        """
        names = [name for name in ORDER if (self.folder / f"{name}.md").exists()]
        parts = [
            self._head(names),
            summary(read_seeds(self.folder), names),
            *((TEXT / f"{n}.md").read_text() for n in ("found", "contradictions", "defaults")),
            *((self.folder / f"{name}.md").read_text() for name in names),
            cost_section(effort),
        ]
        self.report.parent.mkdir(parents=True, exist_ok=True)
        self.report.write_text("\n".join(parts))

    def _head(self, names: list[str]) -> str:
        document = Document(self.report.parent, "figures")
        document.heading("The experiments of three papers, run again", 1)
        by_options: dict[str, list[str]] = {}
        few: list[str] = []
        for name in names:
            options = (self.folder / f"{name}.options").read_text()
            by_options.setdefault(options, []).append(name)
            runs = int(options.split()[1])
            if runs < RUNS:
                few.append(f"{name} {runs}")
        commands = [
            f"`python -m benchmarks.papers {' '.join(found)} {options} --report "
            "benchmarks/papers/REPORT.md`"
            for options, found in by_options.items()
        ]
        made = ", ".join(commands)
        absent = [name for name in ORDER if name not in names]
        # The rows of E6 are those of E4 and E5.
        seconds = sum(
            float((self.folder / f"{name}.seconds").read_text()) for name in names if name != "E6"
        )
        document.say(
            f"Tables and figures made by {made}; `make papers` makes a reduced one in "
            "`out/papers`, in about 5 minutes. The solves behind this report took "
            f"{seconds / 60.0:.0f} minutes of one processor. One solve is one row, with its joint "
            "values, in `out/papers` after a run; every table is made of these. "
            "`python -m benchmarks.papers.archive write` writes `archive/manifest.json`, the "
            "SHA-256 of the rows of every series, times left out, and `python -m "
            "benchmarks.papers.archive verify` holds rows made anew to it. `--seed 1` makes rows "
            "and verdicts with other random numbers, to which a report written after that is held, "
            "and the committed one by `python -m benchmarks.papers.archive hold`.",
            *([FEW.format(", ".join(few))] if few else []),
            *([ABSENT.format(", ".join(absent))] if absent else []),
            READING,
            f"Times: {_processor()}, Python {platform.python_version()}, numba "
            f"{numba.__version__}, NumPy {np.__version__}, Pinocchio {pin.__version__}; processor "
            "time of one thread after a warm-up. Compare their ratios only.",
        )
        document.lines += [f"- {n}: {find_experiment(n).title}" for n in names]
        return document.text()


def _processor() -> str:
    """Name of the processor."""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
