"""From a joint route to its timed motion, with the corners that are faster to stop at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.documents.trajectory import OrderReport
from ikplan.errors import Disconnected, InCollision, TimingFailed, Unreachable
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.path import Rounding, passed_rows
from ikplan.pipeline.timing_stage import Timing, time_motion
from ikplan.planning import JointPathProblem, JointRoute, orders_of, plan_joint_path
from ikplan.planning.joint_steps import clear_joint_path
from ikplan.planning.tracking.tracked_path import TrackingFailed

__all__ = ["MotionStages", "TimedRoute"]

_NoMotion = (Unreachable, Disconnected, InCollision, TimingFailed, TrackingFailed)


class TimedRoute(NamedTuple):
    """A route, its joint path and its timing."""

    route: JointRoute
    path: JointPath
    timing: Timing

    @property
    def duration(self) -> float:
        """Time of the motion [s]."""
        return float(self.timing.timed.duration)


@dataclass(frozen=True, eq=False)
class MotionStages:
    """What the stages after the first planning of a request share."""

    request: PlanRequest
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

    def laid(
        self, problem: JointPathProblem, route: JointRoute
    ) -> list[tuple[JointRoute, JointPath]]:
        """Lay the joint path of a route, and of those that stop at more of its corners.

        Within a small tolerance a sharp corner is passed so slowly that a stop may take no longer.
        """
        others: list[Rounding] = []
        if route.sharp:
            others.append("slight")
        if route.slight:
            others.append("none")
        routes = [route]
        for rounding in others:
            other = replace(problem, rounding=rounding)
            try:
                routes.append(plan_joint_path(other))
            except (Unreachable, Disconnected, InCollision, TrackingFailed):
                continue
        return [clear_joint_path(r, problem.limits, problem.contact) for r in routes]

    def fastest(
        self, problem: JointPathProblem, laid: Sequence[tuple[JointRoute, JointPath]]
    ) -> TimedRoute:
        """Time joint paths; the fastest, the first of equal ones.

        Raises:
            TimingFailed: None has a timing; that of the first.
        """
        best: TimedRoute | None = None
        failures: list[TimingFailed] = []
        for route, path in laid:
            try:
                timing = self._timed(problem, route, path)
            except TimingFailed as failure:
                failures.append(failure)
                continue
            if best is None or timing.timed.duration < best.duration:
                best = TimedRoute(route, path, timing)
        if best is None:
            raise failures[0]
        return best

    def _timed(self, problem: JointPathProblem, route: JointRoute, path: JointPath) -> Timing:
        segments = [
            LimitedSegment(x.field, x.first, x.last, self.limits_of[x.field])
            for x in route.segments
            if x.field in self.limits_of
        ]
        sampling, check = self.request.sampling, problem.clock.check
        return time_motion(path, problem.robot, self.limits, sampling, segments, check)


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
