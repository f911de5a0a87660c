"""From a joint route to its timed motion, with the corners that are faster to stop at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.documents.trajectory import OrderReport
from ikplan.errors import Disconnected, InCollision, TimingFailed, Unreachable
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.path import Rounding, passed_rows
from ikplan.pipeline.asked.asked_motion import asked_of_plan
from ikplan.pipeline.asked.asked_timing import time_as_asked
from ikplan.pipeline.corner_stops.corner_times import (
    CornerTimes,
    gaining_stops,
    least_stops,
    stops_may_gain,
)
from ikplan.pipeline.corner_stops.exact_corners import stopping_at, stops_allowed, without_blends
from ikplan.pipeline.timing_stage import Motion, Timing, least_timing, move_along, reported
from ikplan.planning import JointPathProblem, JointRoute, plan_joint_path
from ikplan.planning.joint_steps import clear_joint_path
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.robots import Robot
from ikplan.timing import TimedPath
from ikplan.timing.engines.engine import EngineFailed
from ikplan.timing.limit_jerk import NotShorter
from ikplan.timing.time_joint_path import passing_jumps

__all__ = ["LaidRoute", "MotionStages", "TimedRoute"]

_FEW = 64
"""Of so many segments or fewer, a path with blends is planned with exact corners too; of more,
where a corner may be faster to stop at."""
_BOUND = 5e-3
"""How far above the least duration a timing without jerk limits may be, as a share."""
_OTHERS: tuple[Rounding, ...] = ("slight", "none", "smooth")
"""Other ways to round corners, in the order in which they are planned."""
_NoMotion = (Unreachable, Disconnected, InCollision, TimingFailed, TrackingFailed)


class LaidRoute(NamedTuple):
    """A route with its joint path.

    Attributes:
        route: The route.
        joint_path: The joint path through it.
        path: The path that it follows: that of the request, or the same with exact corners.
    """

    route: JointRoute
    joint_path: JointPath
    path: PathRequest


class TimedRoute(NamedTuple):
    """A route, its joint path, its timing, and the path that it follows."""

    route: JointRoute
    joint_path: JointPath
    timing: Timing
    path: PathRequest

    @property
    def duration(self) -> float:
        """Time of the motion [s]."""
        return float(self.timing.timed.duration)


@dataclass(frozen=True, eq=False)
class MotionStages:
    """What the stages after the first planning of a request share."""

    request: PlanRequest
    robot: Robot
    limits: MotionLimits
    limits_of: Mapping[str, MotionLimits]

    def timed(self, problem: JointPathProblem) -> TimedRoute:
        """Plan the route of a path and time it.

        Raises:
            InvalidRequest: The path makes no sense.
            Unreachable: A waypoint, or a place on a tool path, has no solution.
            Disconnected: No continuous motion follows a tool path.
            InCollision: All that was found for a part is in contact, or no way was found.
            TrackingFailed: The same, where ``problem.explain`` is false.
            TimingFailed: There is no timing.
            BudgetExceeded: The time budget ran out.
        """
        clock, solver = problem.clock, problem.solver
        with clock.stage("planning"), clock.cutting(solver.cut, solver.search_evaluations):
            laid = self.laid(problem, plan_joint_path(problem))
        with clock.stage("timing"):
            return self.fastest(problem, laid)

    def in_best_order(
        self, problem: JointPathProblem
    ) -> tuple[JointPathProblem, TimedRoute, OrderReport]:
        """Plan and time a path in the fastest order found, and say what that gains.

        The given order is planned as well. Another one is taken where it takes less time and
        moves the joints no farther.

        Args:
            problem: The path, in the given order.

        Raises:
            InvalidRequest: The path makes no sense, or OR-tools is not installed.
            Unreachable: A waypoint, or a place on a tool path, has no solution.
            Disconnected: No continuous motion follows a tool path.
            InCollision: All that was found for a part is in contact, or no way was found.
            TrackingFailed: The same, where ``problem.explain`` is false.
            TimingFailed: There is no timing.
            BudgetExceeded: The time budget ran out.
        """
        from ikplan.planning.order.free_order import orders_of  # for few plans

        scene, path = self.request.scene, problem.path
        attached = scene.attached if isinstance(scene, Scene) else ()
        count = len(path.waypoints or path.segments or ())
        written = replace(problem, order=tuple(range(count)))
        with problem.clock.stage("planning"):
            tried = list(orders_of(problem, attached))
        found: list[tuple[JointPathProblem, TimedRoute]] = []
        failures: list[Exception] = []
        for one in [written, *tried]:
            if one is not written and one.order == written.order:
                continue
            try:
                found.append((one, self.timed(one)))
            except _NoMotion as failure:
                failures.append(failure)
        if not found:
            raise failures[0]
        given = found[0][1] if found[0][0] is written else None
        if given is not None:
            found = [row for row in found if row[1].route.length <= given.route.length]
        best, motion = min(found, key=lambda row: row[1].duration)
        return best, motion, _order_report(best, motion, given)

    def laid(self, problem: JointPathProblem, route: JointRoute) -> list[LaidRoute]:
        """Lay the joint path of a route, and of those that stop at more of its corners.

        Within a small tolerance, or a blend that asks much of the joints, a corner is passed so
        slowly that a stop may take no longer. Of a path of many segments, only where it is timed
        is it known whether one may.
        """
        others: list[JointPathProblem] = []
        for rounding in _OTHERS:
            if rounding in route.other_roundings:
                others.append(replace(problem, rounding=rounding))
        exact = without_blends(problem.path) if _few(problem.path) else None
        if exact is not None:
            others.append(replace(problem, path=exact))
        routes = [(route, problem.path)]
        for other in others:
            with suppress(Unreachable, Disconnected, InCollision, TrackingFailed):
                routes.append((plan_joint_path(other), other.path))
        routes += [(r.stopped, path) for r, path in routes if r.stopped is not None]
        return [_laid(problem, r, path) for r, path in routes]

    def fastest(self, problem: JointPathProblem, laid: Sequence[LaidRoute]) -> TimedRoute:
        """Time joint paths; the fastest, the first of equal ones.

        Raises:
            TimingFailed: None has a timing; that of the first.
        """
        laid, many = list(laid), not _few(problem.path) and bool(stops_allowed(problem.path))
        # What a motion takes without jerk limits is quickly known, and with them it takes longer.
        timed = many or len(laid) > 1
        known = [self._least(problem, one) if timed else None for one in laid]
        if many:
            self._add_stopping(problem, laid, known)
        least = [0.0 if timed is None else timed.duration for timed in known]
        best: tuple[float, int, Motion | Timing] | None = None
        failures: dict[int, TimingFailed] = {}
        for k in sorted(range(len(laid)), key=lambda k: (least[k], k)):
            if best is not None and (1.0 - _BOUND) * least[k] >= best[0]:
                continue
            most = np.inf if best is None else best[0]
            try:
                motion = self._moved(problem, laid[k], known[k], most)
            except NotShorter:
                continue
            except TimingFailed as failure:
                failures[k] = failure
                continue
            duration = motion.timed.duration
            if best is None or (duration, k) < best[:2]:
                best = duration, k, motion
        if best is None:
            raise failures[min(failures)]
        route, joint_path, path = laid[best[1]]
        motion = best[2]
        timing = reported(motion, problem.clock.check) if isinstance(motion, Motion) else motion
        return TimedRoute(route, joint_path, timing, path)

    def _add_stopping(
        self, problem: JointPathProblem, laid: list[LaidRoute], known: list[TimedPath | None]
    ) -> None:
        """Add the path with exact corners and the one that stops where that gains.

        Both are planned only where they may be faster: a corner of the first route takes longer
        than a stop there takes at least, or longer than it does on another route.
        """
        if known[0] is None:
            return
        route, first = laid[0].route, _passing(laid[0], known[0])
        rounded = CornerTimes.of(route, first)
        allowed = np.isin(rounded.rows, sorted(stops_allowed(problem.path)))
        least = least_stops(route, first, self.robot, self.limits, self._limited(route))
        others = _times(laid, known)
        stopped = rounded.stopped.copy()
        for other in others:
            stopped |= np.isin(rounded.rows, other.rows[other.stopped])
        open_ = allowed & ~stopped
        if stops_may_gain(rounded.spent[open_], least[open_], first.duration):
            path = without_blends(problem.path) or problem.path
            self._add(replace(problem, path=path, rounding="none"), path, laid, known)
            others = _times(laid, known)
        stops = gaining_stops(rounded, others) & stops_allowed(problem.path)
        made = {frozenset(other.rows[other.stopped].tolist()) for other in others}
        if stops and stops | set(rounded.rows[rounded.stopped].tolist()) not in made:
            path = stopping_at(problem.path, stops, start_free=problem.start_free)
            self._add(replace(problem, stops=stops), path, laid, known)

    def _add(
        self,
        problem: JointPathProblem,
        path: PathRequest,
        laid: list[LaidRoute],
        known: list[TimedPath | None],
    ) -> None:
        """Plan, lay and time one more joint path, where there is one."""
        clock, solver = problem.clock, problem.solver
        with (
            suppress(Unreachable, Disconnected, InCollision, TrackingFailed),
            clock.stage("planning"),
            clock.cutting(solver.cut, solver.search_evaluations),
        ):
            laid.append(_laid(problem, plan_joint_path(problem), path))
            known.append(self._least(problem, laid[-1]))

    def _least(self, problem: JointPathProblem, laid: LaidRoute) -> TimedPath | None:
        """The motion that no jerk limit slows; None: there is no timing."""
        limits, segments = self.limits, self._limited(laid.route)
        if not asked_of_plan(self.request, self.robot, laid.route).plain:
            # A motion that begins or ends moving need not rest where one under jerk limits has to.
            limits = replace(limits, jerk=None)
            segments = [replace(x, limits=replace(x.limits, jerk=None)) for x in segments]
        try:
            return least_timing(laid.joint_path, self.robot, limits, segments, problem.clock.check)
        except TimingFailed:
            return None

    def _limited(self, route: JointRoute) -> list[LimitedSegment]:
        """The segments of a route that have limits of their own."""
        return [
            LimitedSegment(x.field, x.first, x.last, self.limits_of[x.field])
            for x in route.segments
            if x.field in self.limits_of
        ]

    def _moved(
        self, problem: JointPathProblem, laid: LaidRoute, known: TimedPath | None, most: float
    ) -> Motion | Timing:
        """Move along a joint path; the report of a motion that is only to be fast waits.

        Raises:
            NotShorter: A motion that is only to be fast takes longer than ``most``.
            TimingFailed: There is no timing.
        """
        segments, check = self._limited(laid.route), problem.clock.check
        sampling, path = self.request.sampling, laid.joint_path
        asked = asked_of_plan(self.request, self.robot, laid.route)
        if asked.plain:
            return move_along(path, self.robot, self.limits, sampling, segments, check, known, most)
        return time_as_asked(path, self.robot, self.limits, sampling, segments, asked, check)


def _few(path: PathRequest) -> bool:
    """Whether a path is of so few parts that other corners are tried without a reason."""
    return len(path.waypoints or path.segments or ()) <= _FEW


def _laid(problem: JointPathProblem, route: JointRoute, path: PathRequest) -> LaidRoute:
    return LaidRoute(*clear_joint_path(route, problem.limits, problem.contact), path)


def _times(laid: Sequence[LaidRoute], known: Sequence[TimedPath | None]) -> list[CornerTimes]:
    """Times of all routes but the first."""
    return [
        CornerTimes.of(one.route, _passing(one, timed))
        for one, timed in zip(laid[1:], known[1:], strict=True)
        if timed is not None
    ]


def _passing(laid: LaidRoute, timed: TimedPath) -> TimedPath:
    """Return the motion that rests only where the path does: it says what corners cost."""
    path = laid.joint_path
    try:
        return passing_jumps(timed, path.s_knots[list(path.rest_knots)])
    except EngineFailed:
        return timed


def _order_report(
    problem: JointPathProblem, motion: TimedRoute, given: TimedRoute | None
) -> OrderReport:
    """What the result says of the order found, beside the given one where that has a plan."""
    assert problem.order is not None
    gain = None
    if given is not None:
        gain = 1.0 - motion.duration / given.duration if given.duration > 0.0 else 0.0
    return OrderReport(
        parts=list(problem.order),
        waypoints=passed_rows(problem.path, problem.order),
        duration=motion.duration,
        given_duration=None if given is None else given.duration,
        gain=gain,
        length=motion.route.length,
        given_length=None if given is None else given.route.length,
    )
