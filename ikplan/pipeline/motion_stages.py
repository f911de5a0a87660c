"""From a joint route to its timed motion, with the corners that are faster to stop at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import BudgetExceeded, NoPlan
from ikplan.ik.solve import PoseSolver
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
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
    solver: PoseSolver

    def timed(self, problem: JointPathProblem, route: JointRoute) -> tuple[JointPath, Timing]:
        """Lay the joint path of a route and time it."""
        clock = problem.clock
        with clock.stage("planning"):
            path = JointPath.through(route.q, problem.limits, rest_at=route.rest)
        with clock.stage("timing"):
            segments = [
                LimitedSegment(x.field, x.first, x.last, self.limits_of[x.field])
                for x in route.segments
                if x.field in self.limits_of
            ]
            sampling = self.request.sampling
            timing = time_motion(path, self.robot, self.limits, sampling, segments, clock.check)
        return path, timing

    def faster(
        self, problem: JointPathProblem, route: JointRoute, path: JointPath, timing: Timing
    ) -> tuple[JointRoute, JointPath, Timing]:
        """Return the motion that stops at sharp corners, where that is faster than to round them.

        Within a small tolerance a sharp corner is passed so slowly that a stop may take no longer.
        """
        exact = replace(problem, rounding="slight")
        clock, solver = problem.clock, self.solver
        try:
            with clock.stage("planning"), clock.cutting(solver.cut, solver.search_evaluations):
                other = plan_joint_path(exact)
            other_path, other_timing = self.timed(exact, other)
        except (NoPlan, TrackingFailed) as error:
            if isinstance(error, BudgetExceeded):
                raise
            return route, path, timing
        if other_timing.timed.duration < timing.timed.duration:
            return other, other_path, other_timing
        return route, path, timing
