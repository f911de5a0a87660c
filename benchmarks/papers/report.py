"""The report: a section an experiment, kept as Markdown, joined in order."""

from __future__ import annotations

import platform
from pathlib import Path

import numba
import numpy as np
import pinocchio as pin

from benchmarks.papers.claims import read_claims, write_claims
from benchmarks.papers.cost import cost_section
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results
from benchmarks.papers.runner import find_experiment, studies_of

__all__ = ["Sections"]

READING = (
    "[S] Slim et al., Robotics 2023, 12, 38 (IK-BA). [K] Kanagaraj et al., MENDEL 2022, 28(1), "
    "41-54 (BAT, GSA, PSO, WOA). [L] Li, Luo, Qiao, Machines 2023, 11(6), 648 (BODE-CS). "
    "Two rows of every comparison are in no paper: `ikplan`, the project's own planner (IK-BA "
    "seeds, refinement, least joint motion), and the true optimum where it can be computed: the "
    "least joint motion found by many restarts on the iiwa and the MH5, the closed form of the "
    "Dobot and of the EOD arm."
)
RUNS = 20
"""Runs that the experiments ask for."""
FEW = (
    "**Fewer runs than the 20 asked for: {}.** With R runs no test paired by run gives a p below "
    "2 / 2^R before Holm's correction; tests paired by target do not suffer. The commands above "
    "with `--runs 20` make what is missing and keep what is there."
)
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

    def write(self, experiment: Experiment, results: Results, runs: int, thin: int) -> None:
        """Write the section of an experiment."""
        document = Document(self.report.parent / "figures", "figures")
        document.heading(f"{experiment.name}: {experiment.title}")
        targets = f", every {thin}th target" if thin > 1 else ""
        document.say(f"Runs: {runs}{targets}.")
        experiment.report(studies_of(experiment.name, thin), results, document)
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / f"{experiment.name}.md").write_text(document.text())
        write_claims(self.folder / f"{experiment.name}.json", document.claims)
        options = f"--runs {runs}" + (f" --thin {thin}" if thin > 1 else "")
        (self.folder / f"{experiment.name}.options").write_text(options)

    def join(self, effort: float = 1.0) -> None:
        """Join all sections there are.

        Args:
            effort: Share of the repeats in the table of costs, in (0, 1].
        """
        sections = sorted(self.folder.glob("E*.md"))
        parts = [
            self._head([p.stem for p in sections]),
            self._summary(),
            *((TEXT / f"{n}.md").read_text() for n in ("found", "contradictions", "defaults")),
            *(p.read_text() for p in sections),
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
        document.say(
            f"Made by {', '.join(commands)}; `make papers` makes a reduced one in `out/papers`. "
            "One solve is one row, with its joint values, in `out/papers` after a run; every table "
            "is made of these.",
            *([FEW.format(", ".join(few))] if few else []),
            READING,
            f"Times: {_processor()}, Python {platform.python_version()}, numba "
            f"{numba.__version__}, NumPy {np.__version__}, Pinocchio {pin.__version__}; processor "
            "time of one thread after a warm-up. Compare their ratios only.",
        )
        document.lines += [f"- {n}: {find_experiment(n).title}" for n in names]
        return document.text()

    def _summary(self) -> str:
        document = Document(self.report.parent, "figures")
        document.heading("Summary: claims, published and ours")
        claims = [c for p in sorted(self.folder.glob("E*.json")) for c in read_claims(p)]
        document.say(
            "Reproduced: within a factor of 1.5 of the published figure, otherwise by what factor "
            "it is off; for an order, the same order. The sections have the spread and the tests "
            "behind each line."
        )
        rows = [[c.subject, c.published, c.ours, c.verdict] for c in claims]
        document.table(["claim", "published", "ours", "verdict"], rows, words=True)
        return document.text()


def _processor() -> str:
    """Name of the processor."""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
