"""plan(): the stages in the order they run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan._version import __version__
from ikplan.certificate import Claim, certify
from ikplan.documents import parse
from ikplan.documents.plan_request import IkOptions, IkRequest, PlanRequest
from ikplan.documents.pose_results import IkSolution
from ikplan.documents.trajectory import Stats, WaypointResults
from ikplan.errors import Disconnected, Unreachable
from ikplan.ik.arguments import check_start
from ikplan.ik.solve import PoseSolver, pose_distance, solve_pose
from ikplan.joint_path import JointPath
from ikplan.kinematics.arm import arm_of
from ikplan.limits.motion_limits import LimitedStretch, MotionLimits
from ikplan.path import rotation_of
from ikplan.pipeline.identity import plan_id, with_tool
from ikplan.pipeline.timing_stage import joint_limits, time_motion, warm_up_timing
from ikplan.pipeline.warm_up import warm_up, warm_up_ik
from ikplan.planning import (
    JointPathProblem,
    Progress,
    Route,
    TimeBudget,
    find_repairs,
    plan_joint_path,
)
from ikplan.plans.plan import Plan
from ikplan.robots import Robot, catalogue_robot
from ikplan.robots.narrowing import narrowed

__all__ = ["plan", "solve_ik_request"]

_EXACT = 1e-9
"""What counts as a solution of a waypoint, whatever the path tolerates [m and rad]."""


def plan(
    request: Mapping[str, Any] | PlanRequest,
    *,
    robot: Robot | None = None,
    progress: Progress | None = None,
) -> Plan:
    """Plan a certified joint trajectory for a tool path.

    Args:
        request: The request document.
        robot: The robot, for one that is not in the catalogue; None: load it by name. Its tool
            stands unless the request has one.
        progress: Is called with the stage and how many of how many waypoints are done, from
            this thread: ``progress("ik", 3, 12)``.

    Returns:
        The plan. The same request gives the same id and the same plan.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        Unreachable: A waypoint has no solution.
        TimingFailed: No timing under the limits.
        BudgetExceeded: ``budget_s`` ran out.
        CertificateViolated: The finished plan broke a promise: a bug.
    """
    request = parse(PlanRequest, request)
    warm_up(request.ik.method)
    robot = robot or catalogue_robot(request.robot)
    robot = with_tool(robot, request.tool)
    id_of_plan = plan_id(request, robot)
    robot = narrowed(robot, request.limits.joints)
    limits = MotionLimits.of(robot, request.limits)
    limits_of = _segment_limits(robot, request, limits)
    warm_up_timing(any(x.jerk is not None for x in (limits, *limits_of.values())))
    clock = TimeBudget(request.budget_s, progress)
    start_free = request.start == "free"
    asked = None if request.start == "free" else request.start
    q_start = check_start(robot, robot.home if asked is None else asked)

    solver = _pose_solver(robot, request.ik, _EXACT, _EXACT)
    with clock.stage("ik"), clock.cutting(solver.cut, solver.search_evaluations):
        arm_limits = joint_limits(robot, limits)
        problem = JointPathProblem(
            robot,
            solver,
            request.path,
            request.ik,
            q_start,
            start_free,
            arm_limits,
            clock,
        )
        try:
            route = plan_joint_path(problem)
        except (Unreachable, Disconnected) as error:
            error.repairs = find_repairs(problem, error)
            raise
    with clock.stage("planning"):
        path = JointPath.through(route.knots, arm_limits, rest_at=route.rest)
        # Knots too close to tell apart are passed as one.
        passed = path.q_knots[path.knot_of_waypoint]
        waypoint_q = passed[[w.knot for w in route.wanted]]
    with clock.stage("timing"):
        stretches = [
            LimitedStretch(x.field, x.first, x.last, limits_of[x.field])
            for x in route.stretches
            if x.field in limits_of
        ]
        timing = time_motion(path, robot, limits, request.sampling, stretches, clock.check)
        knot_time = timing.timed.times
    with clock.stage("certificate"):
        certificate = certify(
            Claim(
                robot,
                request.path,
                None if start_free else q_start,
                waypoint_q,
                knot_time[[w.knot for w in route.wanted]],
                timing.samples.time,
                timing.samples.q,
                timing.samples.dq,
                timing.samples.ddq,
                limits,
            )
        )
    return Plan(
        id=id_of_plan,
        version=__version__,
        robot=request.robot,
        joint_names=list(robot.joint_names),
        joint_units=["m" if slides else "rad" for slides in robot.prismatic],
        waypoints=_waypoint_results(robot, route, waypoint_q, knot_time, start_free),
        trajectory=timing.trajectory,
        certificate=certificate,
        timing=timing.report,
        motion=timing.motion,
        controller=None if robot.controller is None else robot.controller.info(),
        stats=Stats(ik_evaluations=route.evaluations, seconds=clock.seconds),
    )


def _segment_limits(
    robot: Robot, request: PlanRequest, limits: MotionLimits
) -> dict[str, MotionLimits]:
    """What the motion has to keep on each segment that has limits of its own, by field."""
    fields = ((f"path.segments[{k}]", s) for k, s in enumerate(request.path.segments or ()))
    return {
        field: limits.within(robot, segment.limits, f"{field}.limits")
        for field, segment in fields
        if segment.limits is not None
    }


def _waypoint_results(
    robot: Robot,
    route: Route,
    q: NDArray[np.float64],
    knot_time: NDArray[np.float64],
    start_free: bool,
) -> WaypointResults:
    """The rows of the waypoints: one for each asked for."""
    arm = arm_of(robot)
    errors = [pose_distance(arm, w.target, q_w) for w, q_w in zip(route.wanted, q, strict=True)]
    steps = np.diff(np.vstack([q[:1] if start_free else route.knots[:1], q]), axis=0)
    return WaypointResults(
        q=q,
        time=knot_time[[w.knot for w in route.wanted]],
        position_error=np.array([distance for distance, _ in errors]),
        orientation_error=[
            angle if w.target.oriented else None
            for w, (_, angle) in zip(route.wanted, errors, strict=True)
        ],
        elongation=np.linalg.norm(steps, axis=1),
    )


def _pose_solver(
    robot: Robot, ik: IkOptions, tolerance_position: float, tolerance_orientation: float
) -> PoseSolver:
    return PoseSolver(
        arm_of(robot),
        ik.method,
        ik.seed,
        ik.population,
        ik.iterations,
        ik.params,
        ik.refine,
        tolerance_position=tolerance_position,
        tolerance_orientation=tolerance_orientation,
    )


def solve_ik_request(
    request: Mapping[str, Any] | IkRequest,
    *,
    robot: Robot | None = None,
    progress: Progress | None = None,
) -> IkSolution:
    """Solve the single pose of an IK request, see :func:`ikplan.solve_ik`; robot as in plan.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        Unreachable: No solution within tolerance.
        BudgetExceeded: ``budget_s`` ran out.
    """
    request = parse(IkRequest, request)
    warm_up_ik(request.ik.method)
    clock = TimeBudget(request.budget_s, progress)
    robot = robot or catalogue_robot(request.robot)
    robot = with_tool(robot, request.tool)
    pose: Any = np.array(request.position)
    if request.quaternion_xyzw is not None:
        pose = pin.SE3(rotation_of(request.quaternion_xyzw), pose)
    tolerance = request.tolerance
    solver = _pose_solver(robot, request.ik, tolerance.position, tolerance.orientation)
    with clock.stage("ik"), clock.cutting(solver.cut, solver.search_evaluations):
        return solve_pose(robot, solver, pose, request.start)
