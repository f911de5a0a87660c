"""The timing of many short spans, each from rest to rest, as one problem."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ikplan.arrays import Array
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.grid import Grid, curvature_grid, regridded
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile
from ikplan.timing.span import (
    COARSE_ROUNDS,
    MAX_INTERVALS,
    SpanTiming,
    acceleration_weight,
    divided,
    refined,
    within_limits,
)
from ikplan.timing.together.switch_points import switch_points

__all__ = ["time_together"]


_FEW_INTERVALS = 16
"""Intervals of each span to begin with: most spans only speed up and slow down."""
_FEW_CONSTRAINED = 32
"""The same under limits other than those of single joints."""
_SHARE_OF_LOSS = 0.04
"""What the grid may cost, as a share of what the first one does: where that is much, so small a
share of it is already less than a span's own grid costs."""
_SHARE_CONSTRAINED = 0.05
_SWITCH_SHARE = 0.1
"""Part of the loss of its span that makes an interval worth to be divided where it switches."""
_DOUBTFUL = 1.5
"""How much more than allowed a grid may cost by what the last refinement brought."""


def time_together(
    path: JointPath,
    knots: Sequence[int],
    profile: LimitProfile,
    constraints: Sequence[PathConstraint] = (),
    tolerance: float = 5e-5,
    steady: bool = True,
    check: Check = unlimited,
    share: float = _SHARE_OF_LOSS,
) -> SpanTiming:
    """Time many short spans as one problem, by the compiled engine.

    Args:
        path: The path.
        knots: The knots where the motion rests, in order: the ends of the spans.
        profile: Joint limits on every piece of the path.
        constraints: Limits other than those of single joints.
        tolerance: As for time_span, of all spans; less, since their grids begin coarser.
        steady: As for time_span.
        check: As for time_span.
        share: What the grid may cost where that is more, as a share of what the first one does;
            under limits of the joints alone.

    Returns:
        The timing of all spans, within every limit.

    Raises:
        EngineFailed: The compiled engine found none.
    """
    few = _FEW_CONSTRAINED if constraints else _FEW_INTERVALS
    weight = acceleration_weight(profile, knots[0], knots[-1])
    grid = curvature_grid(path, knots, weight, few)
    rests = path.s_knots[list(knots[1:-1])]
    coarse = SpanProblem.build(path, grid, profile, constraints, fine=False, rests=rests)
    x = coarse.kept(coarse.compiled_solution, 1.0)
    lost = float(coarse.loss(x).sum() / coarse.times(x).sum())
    if constraints:
        problem = refined(coarse, max(1e-4, _SHARE_CONSTRAINED * lost), check)
        problem = divided(problem.on(problem.grid), steady, check)
    else:
        problem = _refined(coarse, max(tolerance, share * lost), check)
    timing = within_limits(problem, CompiledEngine())
    problem.forget()
    return timing


def _refined(problem: SpanProblem, tolerance: float, check: Check) -> SpanProblem:
    """Return a problem on a grid on which the compiled solution is near its optimum.

    Where a span switches from speeding up to slowing down it gets a node, so that the grid need
    not be fine there. What a refinement has brought tells what is left: on a grid of k times the
    nodes about a share 1 / (k - 1) of it, since the loss falls with the first power of the length
    of the intervals.
    """
    kept = problem.path.s_knots
    before: tuple[int, float] | None = None
    for _ in range(COARSE_ROUNDS):
        check()
        x = problem.kept(problem.compiled_solution, 1.0)
        loss, total = problem.loss(x), float(problem.times(x).sum())
        least = 0.1 * tolerance * total / (len(problem.rests) + 1)
        switches = switch_points(problem.grid.s, x, loss, problem.ends, _SWITCH_SHARE, least)
        if len(switches):
            problem = problem.on(_with_nodes(problem.grid, switches), fine=False)
            kept = np.sort(np.append(kept, switches))
            x = problem.kept(problem.compiled_solution, 1.0)
            loss, total = problem.loss(x), float(problem.times(x).sum())
        n, fraction = len(loss), float(loss.sum()) / total
        if n >= MAX_INTERVALS:
            return problem
        if fraction <= tolerance:
            if before is not None:
                gained = (before[1] - total) / (n / before[0] - 1.0)
                if n > 1.5 * before[0] and gained <= _DOUBTFUL * tolerance * total:
                    return problem
            counts = np.full(n, 2.0)
        else:
            # The least number of nodes for a given sum of losses goes with the root of each.
            root = np.sqrt(np.maximum(loss, 1e-6 * total / n))
            counts = np.clip(root * (root.sum() / (0.9 * tolerance * total)), 1.0, 16.0)
            counts *= min(1.0, MAX_INTERVALS / float(counts.sum()))
        before = n, total
        problem = problem.on(regridded(problem.grid, counts, kept), fine=False)
    return problem


def _with_nodes(grid: Grid, places: Array) -> Grid:
    """Return a grid with further nodes."""
    at = np.searchsorted(grid.s, places)
    return Grid(np.insert(grid.s, at, places), np.insert(grid.pieces, at, grid.pieces[at - 1]))
