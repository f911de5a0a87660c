"""From a joint route to its timed motion, with the corners that are faster to stop at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import Disconnected, InCollision, TimingFailed, Unreachable
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.path import Rounding
from ikplan.pipeline.timing_stage import Timing, time_motion
from ikplan.planning import JointPathProblem, JointRoute, plan_joint_path
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.robots import Robot

__all__ = ["MotionStages"]


@dataclass(frozen=True, eq=False)
class MotionStages:
    """What the stages after the first planning of a request share."""

    request: PlanRequest
    robot: Robot
    limits: MotionLimits
    limits_of: Mapping[str, MotionLimits]

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
        limits = problem.limits
        return [(r, JointPath.through(r.q, limits, rest_at=r.rest)) for r in routes]

    def fastest(
        self, problem: JointPathProblem, laid: Sequence[tuple[JointRoute, JointPath]]
    ) -> tuple[JointRoute, JointPath, Timing]:
        """Time joint paths; the fastest, the first of equal ones.

        Raises:
            TimingFailed: None has a timing; that of the first.
        """
        best: tuple[JointRoute, JointPath, Timing] | None = None
        failures: list[TimingFailed] = []
        for route, path in laid:
            try:
                timing = self._timed(problem, route, path)
            except TimingFailed as failure:
                failures.append(failure)
                continue
            if best is None or timing.timed.duration < best[2].timed.duration:
                best = route, path, timing
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
        return time_motion(path, self.robot, self.limits, sampling, segments, check)
