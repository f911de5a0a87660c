"""E1: the helix, [S] section 5.2."""

from __future__ import annotations

from benchmarks.papers.document import Document
from benchmarks.papers.e1_claims import claims, misses
from benchmarks.papers.e1_figures import draw_boxes, draw_paths
from benchmarks.papers.e1_series import (
    CONTROLS,
    GREEDY,
    OWN,
    PAPER,
    REFERENCES,
    UNIFORM,
    WHOLE,
    WRIST,
)
from benchmarks.papers.e1_tables import analysis, beside_published, overview, ranking, split
from benchmarks.papers.experiment import Experiment, Results, Study
from benchmarks.papers.helix import helix_cases

__all__ = ["EXPERIMENT"]

CLOSELY = ("E1a", "E1b", "E1c")
"""The cases that are looked at closely."""


def studies(_thin: int) -> list[Study]:
    """Return the five cases."""
    built = helix_cases()
    return [
        Study(built["E1a"], [*PAPER, *CONTROLS, *OWN]),
        Study(built["E1b"], [*PAPER, *CONTROLS, WRIST, *OWN]),
        Study(built["E1c"], [*PAPER, *CONTROLS, *OWN]),
        Study(built["E1d"], [*PAPER, *REFERENCES, UNIFORM, WHOLE, GREEDY]),
        Study(built["E1b-bent"], [*PAPER, *REFERENCES, UNIFORM, *OWN]),
    ]


def report(studies: list[Study], results: Results, document: Document) -> None:
    """Write the section."""
    document.say(
        "N = 50, T = 200, so 10,050 evaluations each (ABC 10,025 and its scouts): the comparison "
        "is at equal evaluations. Every series tracks the path from home, each point from the "
        "solution before. ABC stands in for K-ABC, whose equations are not openly available: "
        "K-ABC itself is not reproduced. `IK-BA` has the noise of circulating bat code, 0.1 N(0, "
        "1); the planner's default is the uniform noise. `PSO` has the constants of Table 1 "
        "permuted, `as printed` those printed. CMA-ES and L-SHADE are in no paper. `cloud`: the "
        "first population is normally distributed around the start with 10 deg, of which the "
        "start itself is one. Where the wrist is decoupled the orientation is met by "
        "construction (theta is the rounding). `x least motion`: summed elongation over that of "
        "the last line, the shortest path found by many restarts; below 1 only where the points "
        "are not met. MO-PSO returns an archive, of which the candidate nearest to the point is "
        "reported, `knee`: the one nearest to the ideal."
    )
    by_name = {study.case.name: study for study in studies}
    for name, study in by_name.items():
        document.heading(f"{name}: {study.case.title}", 3)
        if not study.case.reachable.all():
            split(study, results, document)
            continue
        overview(study, results, document)
        if name not in CLOSELY:
            continue
        misses(study, results, document)
        if results.runs >= 3:
            ranking(study, results, document)
        with document.details("Table 3 beside ours, analysis of variance, IK-BA against each"):
            beside_published(study, results, document)
            if results.runs >= 3:
                analysis(study, results, document)
        draw_boxes(study, results, document)
        if name == "E1b":
            draw_paths(study, results, document)
    claims(by_name, results, document)


EXPERIMENT = Experiment("E1", "Helix, KUKA iiwa 14 [S, section 5.2]", studies, report)
