"""S2: what IK-BA is for, by the number of joints."""

from __future__ import annotations

from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.sweep_cases import COUNT, DIMENSIONS, START
from benchmarks.papers.sweeps import RUNS, dimensions, report_sweep

__all__ = ["EXPERIMENT"]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    del studies
    document.say(
        "Arms of 1 m with joints by turns about z and y, all links equally long, limits of 2 rad; "
        f"{COUNT} positions, the start up to {START:g} deg a joint from a solution, N = 50, T = "
        f"200, at most {RUNS} runs (the planner one): the targets are what the tests are over."
    )
    report_sweep("S2", "number of joints", DIMENSIONS, results, document)


EXPERIMENT = Experiment("S2", "Sweep: number of joints, serial arms", dimensions, report)
