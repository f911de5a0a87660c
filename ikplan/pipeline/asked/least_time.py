"""Least time as the objective: routes of several metrics, and the one whose motion is fastest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.trajectory import ObjectiveReport
from ikplan.errors import Disconnected, InCollision, TimingFailed, Unreachable
from ikplan.pipeline.motion_stages import MotionStages, TimedRoute
from ikplan.planning import JointPathProblem, JointRoute
from ikplan.planning.tracking.tracked_path import TrackingFailed

__all__ = ["in_least_time"]

_ROUNDS = 2
"""How often the metric is changed by what the fastest route asks of the joints."""
_EVEN = 0.05
"""Least share of the load of the joint with most that a joint counts with."""
_ROUNDING = 1e-9
_NoMotion = (Unreachable, Disconnected, InCollision, TimingFailed, TrackingFailed)


def in_least_time(
    stages: MotionStages, problem: JointPathProblem, given: TimedRoute
) -> tuple[JointPathProblem, TimedRoute, ObjectiveReport]:
    """Plan for the shortest motion time: branches, free axes and turns.

    A step takes as long as the joint that has most to do for its limits: the metric is the largest
    of the joints' motions, each over its limit. The searches minimise weighted 2-norms, so that
    routes are planned for weights of one over the velocity limits and one over the acceleration
    limits, and then for weights that grow with the load of each joint on the fastest route found
    (iteratively reweighted, as for norms above 2). All are timed, the route of least joint motion
    too, and the fastest is taken: never a slower one than that.

    Args:
        stages: The stages of the request.
        problem: The path.
        given: The motion of least joint motion.

    Returns:
        The problem of the fastest motion, the motion, and what it gains.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    best, motion = problem, given
    tried: list[Array] = [problem.cost.weights]

    def attempt(weights: Array) -> None:
        nonlocal best, motion
        # What counts is the proportion of the weights; their size is that of the plain ones.
        weights = weights / float(np.exp(np.log(weights).mean()))
        if any(np.allclose(weights, other, rtol=1e-3) for other in tried):
            return
        tried.append(weights)
        cost = problem.cost._replace(weights=weights * problem.cost.weights)
        one = replace(problem, posture=cost, explain=False)
        try:
            found = stages.timed(one)
        except _NoMotion:
            return
        if found.duration < motion.duration * (1.0 - _ROUNDING):
            best, motion = replace(one, explain=problem.explain), found

    for weights in _limit_weights(stages):
        attempt(weights)
    velocity = _slowest(stages)
    for _ in range(_ROUNDS):
        before = motion
        attempt(np.maximum(_load(motion.route, velocity), _EVEN) / velocity)
        if motion is before:
            break
    return best, motion, _report(motion, given)


def _slowest(stages: MotionStages) -> Array:
    limits = stages.limits
    return np.asarray(np.minimum(limits.velocity, -limits.velocity_lower))


def _limit_weights(stages: MotionStages) -> Iterator[Array]:
    """Yield weights of the joints by their limits."""
    limits = stages.limits
    yield 1.0 / np.maximum(_slowest(stages), 1e-9)
    yield 1.0 / np.maximum(np.minimum(limits.acceleration, -limits.acceleration_lower), 1e-9)


def _load(route: JointRoute, velocity: Array) -> Array:
    """How much of the time each joint needs, as a share of that of the joint that needs most."""
    need = np.abs(np.diff(route.q, axis=0)) / np.maximum(velocity, 1e-9)
    # A joint that binds in a step counts with the step, others with what they need of it.
    most = need.max(axis=1, keepdims=True)
    share = np.divide(need, most, out=np.zeros_like(need), where=most > 0.0)
    load = (share**2 * most).sum(axis=0)
    return np.asarray(load / max(float(load.max()), 1e-300))


def _report(motion: TimedRoute, given: TimedRoute) -> ObjectiveReport:
    return ObjectiveReport(
        objective="time",
        duration=motion.duration,
        length=motion.route.length,
        least_motion_duration=given.duration,
        least_motion_length=given.route.length,
        gain=1.0 - motion.duration / given.duration if given.duration > 0.0 else 0.0,
    )
