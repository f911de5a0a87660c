"""S1: what IK-BA is for, by the distance of the start."""

from __future__ import annotations

from benchmarks.papers.document import Document
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.sweep_cases import COUNT, DISTANCES
from benchmarks.papers.sweeps import RUNS, distances, report_sweep

__all__ = ["EXPERIMENT"]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    del studies
    document.say(
        f"iiwa 14, {COUNT} positions, the start up to so many degrees a joint from a solution, N "
        f"= 50, T = 200, about 10,000 evaluations, at most {RUNS} runs (the planner one): the "
        "targets are what the tests are over. The search begins at the start configuration in all "
        "but `CMA-ES, cold`: in `cloud` the first population is normally distributed around it "
        "with 10 deg, in `warm` it is one individual, as in IK-BA."
    )
    report_sweep("S1", "start within, deg a joint", DISTANCES, results, document)


EXPERIMENT = Experiment("S1", "Sweep: distance of the start, iiwa 14", distances, report)
