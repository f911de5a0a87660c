"""The report: a section an experiment, kept as Markdown, joined in order."""

from __future__ import annotations

from pathlib import Path

from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results
from benchmarks.papers.findings import CONTRADICTIONS, DEFAULTS, REPRODUCED
from benchmarks.papers.runner import _studies

__all__ = ["Sections"]


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
        experiment.report(_studies(experiment.name, thin), results, document)
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / f"{experiment.name}.md").write_text(document.text())

    def join(self, runs: int, thin: int) -> None:
        """Join all sections there are."""
        thinning = f" --thin {thin}" if thin > 1 else ""
        command = f"python -m benchmarks.papers --runs {runs}{thinning}"
        parts = [
            "# The experiments of three papers, run again\n",
            f"Made by `{command}` (`make papers` makes a reduced one in `out/papers`). Each "
            "section has the published figures beside ours. Rows, one a solve with its joint "
            "values, are in `out/papers` after a run.\n",
            REPRODUCED,
            CONTRADICTIONS,
            DEFAULTS,
            *(p.read_text() for p in sorted(self.folder.glob("E*.md"))),
        ]
        self.report.parent.mkdir(parents=True, exist_ok=True)
        self.report.write_text("\n".join(parts))
