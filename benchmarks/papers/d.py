"""D: readings of the papers' text."""

from __future__ import annotations

from benchmarks.papers.deviations import studies
from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study

__all__ = ["EXPERIMENT"]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""


EXPERIMENT = Experiment("D", "Readings of the papers' text, and what each does", studies, report)
