"""The timing of one span of a path, from rest to rest."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import TimingFailed
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.engines.compiled_engine import CompiledEngine
from ikplan.timing.engines.engine import Check, Engine, EngineFailed, unlimited
from ikplan.timing.engines.toppra_engine import ToppraEngine
from ikplan.timing.grid import Grid, curvature_grid, regridded
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile

__all__ = [
    "COARSE_ROUNDS",
    "MAX_INTERVALS",
    "SpanTiming",
    "acceleration_weight",
    "divided",
    "refined",
    "time_span",
    "time_through",
    "within_limits",
]


# Kept below the limits, so that rounding in a sample cannot step over one.
_MARGIN = 2e-9
_COARSE_INTERVALS = 100
COARSE_ROUNDS = 8
_VERIFY = 4.0
MAX_INTERVALS = 40_000
_DIVISIONS = 3
_MOST_DIVIDED = 10_000
# toppra takes about ten microseconds an interval; beyond this the compiled engine takes over.
_MAX_TOPPRA_INTERVALS = 4_000
# A result this much slower than the compiled solution on the same grid is a numerical failure.
_WORSE = 1.001


@dataclass(frozen=True, eq=False)
class SpanTiming:
    """The timing of a span.

    Attributes:
        problem: Path derivatives and limits on the grid that was used.
        x: Squared path velocities at the nodes, shape (n + 1,), zero at both ends.
        dt: Durations of the intervals [s], shape (n,).
        loss: Estimated fraction of the duration that the grid costs.
        engine: Name of the engine that found it.
    """

    problem: SpanProblem
    x: Array
    dt: Array
    loss: float
    engine: str


def time_span(
    path: JointPath,
    first: int,
    last: int,
    profile: LimitProfile,
    constraints: Sequence[PathConstraint] = (),
    engine: Engine | None = None,
    tolerance: float = 0.003,
    steady: bool = True,
    check: Check = unlimited,
) -> SpanTiming:
    """Time the span between two knots as fast as the limits allow.

    The compiled engine finds the grid; the engine solves on it. Where it fails, or is slower than
    the compiled one, the compiled solution is taken, then finer grids are tried.

    Args:
        path: The path.
        first: First knot of the span.
        last: Last knot of the span.
        profile: Joint limits on every piece of the path.
        constraints: Limits other than those of single joints.
        engine: The engine; None: toppra, with the compiled engine to stand in.
        tolerance: Estimated fraction of the duration that the grid may cost.
        steady: Whether tool speeds that bind shall hardly vary, which takes fine grids.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The timing, within every limit.

    Raises:
        TimingFailed: No grid and no engine found a path speed.
    """
    failure: tuple[SpanProblem, int] | None = None
    engines: list[Engine] = [ToppraEngine(), CompiledEngine()] if engine is None else [engine]
    for problem in _problems(path, first, last, profile, constraints, tolerance, steady, check):
        found = []
        for candidate in engines:
            if isinstance(candidate, ToppraEngine) and len(problem.h) > _MAX_TOPPRA_INTERVALS:
                continue
            check()
            try:
                found.append(within_limits(problem, candidate))
            except EngineFailed as error:
                failure = (problem, error.stage)
        if found:
            worse = float(found[0].dt.sum()) > _WORSE * float(found[-1].dt.sum())
            return found[-1] if worse else found[0]
    assert failure is not None  # every grid ended in a return or a failure
    raise _failed(*failure)


def _problems(
    path: JointPath,
    first: int,
    last: int,
    profile: LimitProfile,
    constraints: Sequence[PathConstraint],
    tolerance: float,
    steady: bool,
    check: Check,
) -> Iterator[SpanProblem]:
    """Yield the problem on a grid that is good enough, then on finer ones."""
    weight = acceleration_weight(profile, first, last)
    grid = curvature_grid(path, (first, last), weight, _COARSE_INTERVALS)
    problem: SpanProblem | None = None
    # Where the compiled engine fails, the finer grids tell whether it is for good, and where.
    with contextlib.suppress(EngineFailed):
        coarse = SpanProblem.build(path, grid, profile, constraints, fine=False)
        problem = refined(coarse, tolerance, check)
        if constraints:
            problem = problem.on(problem.grid)
            problem = divided(problem, steady, check)
    problem = problem or SpanProblem.build(path, grid, profile, constraints)
    yield problem
    for _ in range(2):
        check()
        problem = problem.on(regridded(problem.grid, np.full(len(problem.h), 3.0)))
        yield problem


def acceleration_weight(profile: LimitProfile, first: int, last: int) -> Array:
    """How much each joint counts between two knots: by its least acceleration limit."""
    piece = slice(first, last)
    least = np.minimum(
        profile.acceleration[piece].min(axis=0), -profile.acceleration_lower[piece].max(axis=0)
    )
    return np.asarray(1.0 / least)


def time_through(spans: Sequence[SpanTiming]) -> SpanTiming:
    """Time spans that follow each other as one, on their grids, without the rests between them.

    Args:
        spans: The spans, in order, each by itself.

    Returns:
        The timing, within every limit.

    Raises:
        EngineFailed: The compiled engine found none.
    """
    if len(spans) == 1:
        return spans[0]
    problems = [span.problem for span in spans]
    first = problems[0]
    s = np.concatenate([first.grid.s[:1], *(problem.grid.s[1:] for problem in problems)])
    pieces = np.concatenate([problem.grid.pieces for problem in problems])
    constraints = dict.fromkeys(c for problem in problems for c in problem.constraints)
    problem = SpanProblem.build(first.path, Grid(s, pieces), first.profile, tuple(constraints))
    problem.others.know([each.others for each in problems])
    return within_limits(problem, CompiledEngine())


def refined(problem: SpanProblem, tolerance: float, check: Check) -> SpanProblem:
    """Return a problem on a grid on which the compiled solution is near its optimum."""
    for _ in range(COARSE_ROUNDS):
        check()
        x = problem.kept(problem.compiled_solution, 1.0)
        loss, total = problem.loss(x), float(problem.times(x).sum())
        n, fraction = len(loss), float(loss.sum()) / total
        if fraction <= tolerance:
            # Near a point where one joint turns round, a grid can be too coarse to pass at the
            # right speed and lose no time it knows of: a much finer one tells.
            finer = problem.on(regridded(problem.grid, np.full(n, _VERIFY)), fine=False)
            x = finer.kept(finer.compiled_solution, 1.0)
            best = float(finer.times(x).sum())
            if total <= (1.0 + 1.5 * tolerance) * best or n * _VERIFY > MAX_INTERVALS:
                return problem
            problem = finer
            continue
        if n >= MAX_INTERVALS:
            return problem
        # The loss falls with the first power of the interval's length; the least number of
        # nodes for a given sum of losses then goes with the root of each.
        root = np.sqrt(np.maximum(loss, 1e-6 * total / n))
        # Of spans that are timed together none may be left with fewer nodes than it began with.
        fewest = 0.33 if len(problem.rests) == 0 else 1.0
        counts = np.clip(root * (root.sum() / (0.9 * tolerance * total)), fewest, 16.0)
        counts *= min(1.0, MAX_INTERVALS / float(counts.sum()))
        problem = problem.on(regridded(problem.grid, counts), fine=False)
    return problem


def divided(problem: SpanProblem, steady: bool, check: Check) -> SpanProblem:
    """Return a problem on a grid so fine that constraints are nearly straight where they bind."""
    for _ in range(_DIVISIONS):
        check()
        x = problem.kept(problem.compiled_solution, 1.0)
        parts = problem.others.parts(x, steady)
        if parts.max() <= 1.5:
            break
        counts = np.maximum(parts * min(1.0, _MOST_DIVIDED / parts.sum()), 1.0)
        problem = problem.on(regridded(problem.grid, counts))
    return problem


def within_limits(problem: SpanProblem, engine: Engine) -> SpanTiming:
    """Slow an engine's solution by what it exceeds the limits."""
    x = problem.compiled_solution if isinstance(engine, CompiledEngine) else problem.solve(engine)
    x = problem.kept(x, 0.0, _MARGIN)
    dt = problem.times(x)
    return SpanTiming(
        problem, x, dt, float(problem.loss(x).sum() / dt.sum()), type(engine).__name__
    )


def _failed(problem: SpanProblem, stage: int) -> TimingFailed:
    """Describe a failure: the joint whose acceleration the path asks most of there."""
    profile, piece = problem.profile, problem.grid.pieces[stage]
    qss = problem.qss0[stage]
    ratio = np.maximum(qss / profile.acceleration[piece], qss / profile.acceleration_lower[piece])
    name = profile.joint_names[int(np.argmax(ratio))]
    where = float(problem.grid.s[stage] / problem.path.length)
    return TimingFailed(
        f"no path speed found at {where:.4f} of the path, where joint {name!r} needs the most of "
        "its acceleration limit",
        position=where,
        joint=name,
        limit="acceleration",
    )
