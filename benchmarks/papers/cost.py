"""What a search costs, against a call of Pinocchio's forward kinematics."""

from __future__ import annotations

from pathlib import Path

from benchmarks.papers.document import Document
from benchmarks.speed.solvers import EVALUATIONS, rows

__all__ = ["cost_section"]


def cost_section(effort: float) -> str:
    """Measure every search, and return the section.

    Args:
        effort: Share of the repeats, in (0, 1].
    """
    document = Document(Path(), "figures")
    document.heading("Cost of the searches")
    document.say(
        f"{EVALUATIONS:,} evaluations of the iiwa's position objective, N = 50, in calls of "
        "`pinocchio.framesForwardKinematics` from Python in the same process; `python -m "
        "benchmarks.speed searches` prints them."
    )
    costs = rows(max(3, round(15 * effort)))
    lines = [[c.name, 1e3 * c.seconds, c.ratio, c.limit, c.ratio <= c.limit] for c in costs]
    document.table(
        ["search", "ms", "x one FK call", "at most", "kept"],
        [[*line[:4], "yes" if line[4] else "no"] for line in lines],
    )
    return document.text()
