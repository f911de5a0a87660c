"""Jerk-limited timing: closed forms, and motions played as fast as the limits allow."""

from __future__ import annotations

from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.jerk.smoothed import Smoothed
from ikplan.timing.jerk.smoothing import JointSlowdown, Smoothing
from ikplan.timing.jerk.straight import straight_motion
from ikplan.timing.jerk.warp import fastest
from ikplan.timing.jerk.window_search import build_up, smoothed, smoothed_alike
from ikplan.timing.jerk.within_limits import ROUNDING, within_limits
from ikplan.timing.problem import SpanProblem

__all__ = ["Smoothed", "smooth_span", "smooth_span_alike"]

# The motion to begin with: its window, as a multiple of the time in which the jerk limits build
# up the acceleration limits, and for how many rounds it is slowed where it exceeds limits.
_FIRST_WINDOW, _FIRST_ROUNDS = 1.2, 2
# Jerk limits hardly matter where the motion takes so many times as long as that.
_WEAK = 100.0
# Other ways of smoothing are tried on spans of at most so many intervals: what they bring falls
# with the length of a motion, and what they cost grows.
_SEARCHED = 3_000


def smooth_span(problem: SpanProblem, check: Check = unlimited) -> Smoothed:
    """Time a span within jerk limits, on the same geometric path.

    A straight line of the joint space has a closed form. Else the time-optimal path speed is
    smoothed by a moving average over time, slowed where it exceeds limits, and then played along
    its own course as fast as the limits allow (see fastest): a local optimum, on a grid. Where
    jerk limits hardly matter, several ways of smoothing are tried as well, and the best is kept.

    Args:
        problem: The span, with continuous curvature where jerks are limited, and its limits.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    slowdown = _slowdown(problem)
    straight = _straight(problem, slowdown)
    if straight is not None and straight[1]:
        return straight[0]
    found = [] if straight is None else [straight[0]]
    x = problem.compiled_solution / max(problem.largest_ratio(problem.compiled_solution), 1e-300)
    duration = float(problem.times(x).sum())
    _, swing = build_up(problem, duration)
    search = Smoothing(problem, x, min(_FIRST_WINDOW * swing, duration), slowdown)
    search.run(_FIRST_ROUNDS, check)
    assert search.best is not None  # the first round has made one
    motion = fastest(problem, search.best, swing, slowdown, check)
    found.append(Smoothed(within_limits(problem, motion, slowdown), None, None))
    if duration > _WEAK * swing and len(problem.h) <= _SEARCHED:
        found.append(smoothed(problem, slowdown, check))
    return min(found, key=lambda each: each.duration)


def _straight(problem: SpanProblem, slowdown: JointSlowdown) -> tuple[Smoothed, bool] | None:
    """Return the closed form, and whether it is optimal; None: there is none."""
    motion = straight_motion(problem)
    if motion is None:
        return None
    slower = within_limits(problem, motion, slowdown, ROUNDING)
    factor = float(slower.time[-1] / motion.time[-1])
    return Smoothed(slower, None, None), factor <= 1.0 + 10.0 * ROUNDING


def smooth_span_alike(problem: SpanProblem, known: Smoothed, check: Check = unlimited) -> Smoothed:
    """Time a span within jerk limits in the way that was best for nearly the same limits.

    Args:
        problem: The span and its limits.
        known: What was best for a problem that is much like this one.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The motion, within every limit.

    Raises:
        EngineFailed: There is no timing even without jerk limits.
    """
    slowdown = _slowdown(problem)
    if known.window is not None:
        return smoothed_alike(problem, known, slowdown, check)
    straight = _straight(problem, slowdown)
    if straight is not None and straight[1]:
        return straight[0]
    _, swing = build_up(problem, known.duration)
    motion = fastest(problem, known.motion, swing, slowdown, check, rounds=(1, 2), led=True)
    return Smoothed(within_limits(problem, motion, slowdown), None, None)


def _slowdown(problem: SpanProblem) -> JointSlowdown:
    return JointSlowdown(problem.path, problem.profile, problem.path.third_derivatives)
