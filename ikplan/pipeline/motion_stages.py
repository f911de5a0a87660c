"""From a joint route to its timed motion, with the corners that are faster to stop at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from ikplan.documents.plan_request import PathRequest, PlanRequest
from ikplan.documents.scene import Scene
from ikplan.documents.segment import JointSegment, MoveSegment
from ikplan.documents.trajectory import OrderReport
from ikplan.errors import Disconnected, InCollision, TimingFailed, Unreachable
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.path import passed_rows
from ikplan.pipeline.asked.asked_motion import asked_of_plan
from ikplan.pipeline.asked.asked_timing import time_as_asked
from ikplan.pipeline.timing_stage import Motion, Timing, least_timing, move_along, reported
from ikplan.planning import JointPathProblem, JointRoute, orders_of, plan_joint_path
from ikplan.planning.joint_steps import clear_joint_path
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.robots import Robot
from ikplan.timing import TimedPath

__all__ = ["LaidRoute", "MotionStages", "TimedRoute", "without_blends"]

_FEW = 64
"""Of fewer segments, a path with blends is planned with exact corners too."""
_BOUND = 2e-3
"""How far above the least duration a timing without jerk limits may be, as a share."""
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


def without_blends(path: PathRequest) -> PathRequest | None:
    """Return a path with exact corners in the place of blends; None: it has no blends.

    A corner to a joint motion keeps its blend: within its ball the motion may stop as well. A path
    of many segments is left as it is, too dear to be planned twice.
    """
    segments = path.segments or []
    if len(path.waypoints or segments) > _FEW:
        return None
    after = [*segments[1:], None]
    exact = [
        segment.model_copy(update={"blend": 0.0})
        if not isinstance(segment, MoveSegment | JointSegment)
        and not isinstance(following, JointSegment)
        and segment.blend
        else segment
        for segment, following in zip(segments, after, strict=False)
    ]
    if not path.blend and all(a is b for a, b in zip(exact, segments, strict=True)):
        return None
    blend = 0.0 if path.blend else path.blend
    return path.model_copy(update={"segments": exact or None, "blend": blend})


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
        slowly that a stop may take no longer.
        """
        others: list[JointPathProblem] = []
        if route.sharp:
            others.append(replace(problem, rounding="slight"))
        if route.slight:
            others.append(replace(problem, rounding="none"))
        exact = without_blends(problem.path)
        if exact is not None:
            others.append(replace(problem, path=exact))
        routes = [(route, problem.path)]
        for other in others:
            try:
                routes.append((plan_joint_path(other), other.path))
            except (Unreachable, Disconnected, InCollision, TrackingFailed):
                continue
        routes += [(r.stopped, path) for r, path in routes if r.stopped is not None]
        return [
            LaidRoute(*clear_joint_path(r, problem.limits, problem.contact), path)
            for r, path in routes
        ]

    def fastest(self, problem: JointPathProblem, laid: Sequence[LaidRoute]) -> TimedRoute:
        """Time joint paths; the fastest, the first of equal ones.

        Raises:
            TimingFailed: None has a timing; that of the first.
        """
        # What a motion takes without jerk limits is quickly known, and with them it takes longer.
        known = [self._least(problem, one) for one in laid] if len(laid) > 1 else [None]
        least = [0.0 if timed is None else timed.duration for timed in known]
        best: tuple[float, int, Motion | Timing] | None = None
        failures: dict[int, TimingFailed] = {}
        for k in sorted(range(len(laid)), key=lambda k: (least[k], k)):
            if best is not None and (1.0 - _BOUND) * least[k] >= best[0]:
                continue
            try:
                motion = self._moved(problem, laid[k], known[k])
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

    def _least(self, problem: JointPathProblem, laid: LaidRoute) -> TimedPath | None:
        """The motion that no jerk limit slows; None: there is no timing."""
        segments, check = self._limited(laid.route), problem.clock.check
        try:
            return least_timing(laid.joint_path, self.robot, self.limits, segments, check)
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
        self, problem: JointPathProblem, laid: LaidRoute, known: TimedPath | None
    ) -> Motion | Timing:
        """Move along a joint path; the report of a motion that is only to be fast waits."""
        segments, check = self._limited(laid.route), problem.clock.check
        sampling, path = self.request.sampling, laid.joint_path
        asked = asked_of_plan(self.request, self.robot, laid.route)
        if asked is None or asked.plain:
            return move_along(path, self.robot, self.limits, sampling, segments, check, known)
        return time_as_asked(path, self.robot, self.limits, sampling, segments, asked, check)


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
