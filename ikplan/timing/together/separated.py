"""Spans that were timed together, each by itself again."""

from __future__ import annotations

import itertools
from dataclasses import replace

from ikplan.timing.grid import Grid
from ikplan.timing.problem import SpanProblem
from ikplan.timing.span import SpanTiming

__all__ = ["separated"]


def separated(timing: SpanTiming) -> list[SpanTiming]:
    """Return the timings of the spans between rests; what is known of them is not found again.

    Args:
        timing: The timing of spans that were timed together.
    """
    whole = timing.problem
    slopes, compiled = whole.slopes[1:4], whole.compiled_solution
    spans = []
    for first, last in itertools.pairwise(whole.ends.tolist()):
        nodes, intervals = slice(first, last + 1), slice(first, last)
        grid = Grid(whole.grid.s[nodes], whole.grid.pieces[intervals])
        constraints = [c for c in whole.constraints if c.start < grid.s[-1] and c.end > grid.s[0]]
        problem = SpanProblem.build(whole.path, grid, whole.profile, constraints)
        problem = replace(problem, sparse=True)
        problem.__dict__["_derivatives"] = tuple(slope[intervals] for slope in slopes)
        problem.__dict__["compiled_solution"] = compiled[nodes]
        problem.others.know([whole.others])
        spans.append(
            SpanTiming(problem, timing.x[nodes], timing.dt[intervals], timing.loss, timing.engine)
        )
    whole.forget()
    return spans
