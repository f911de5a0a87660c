"""S1."""

from __future__ import annotations

from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.sweeps import distances

__all__ = ["EXPERIMENT"]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""


EXPERIMENT = Experiment("S1", "Distance of the start", distances, report)
