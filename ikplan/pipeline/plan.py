"""plan(): the stages in the order they run."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest, Scene
from ikplan.documents.trajectory import WaypointResults
from ikplan.errors import BudgetExceeded, Disconnected, IkplanError, InCollision, Unreachable
from ikplan.ik.arguments import check_start
from ikplan.ik.solve import pose_distance
from ikplan.kinematics.arm import arm_of
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.assemble import assemble_plan, joint_steps
from ikplan.pipeline.clearance_objective import keep_clear
from ikplan.pipeline.collisions import requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.identity import plan_id
from ikplan.pipeline.motion_stages import MotionStages
from ikplan.pipeline.poses import pose_solver
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.pipeline.timing_stage import joint_limits
from ikplan.planning import (
    JointPathProblem,
    JointRoute,
    Progress,
    find_repairs,
    plan_joint_path,
)
from ikplan.planning.repair_kinds import merged_document
from ikplan.planning.segment_number import segment_number
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.plans.plan import Plan
from ikplan.robots import Robot
from ikplan.robots.narrowing import narrowed
from ikplan.scene.body import CollisionModel
from ikplan.time_budget import TimeBudget

__all__ = ["make_plan", "plan"]

CONTACT_MARGIN = 1e-4
"""Gap that the planner keeps on top of the clearance [m]: the spline through its configurations
leaves the straight motions that it checks by a little, and the proof has the last word."""
_MOVE_REPAIRS = 3
"""How often a move on which that proof fails is rounded anew, with a gap that grows."""
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
            this thread: ``progress("ik", 3, 12)``. The stages are "ik" (candidates and seeds of
            waypoints, within the planning), "planning", "timing" and "certificate".

    Returns:
        The plan. The same request gives the same id and the same plan.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        Unreachable: A waypoint has no solution.
        Disconnected: No continuous motion joins two waypoints.
        InCollision: The arm would touch itself, its tool or an obstacle.
        TimingFailed: No timing under the limits.
        BudgetExceeded: ``budget_s`` ran out.
        CertificateViolated: The finished plan broke a promise: a bug.
    """
    return make_plan(with_meshes(parse(PlanRequest, request)), robot, progress)


def make_plan(
    request: PlanRequest,
    robot: Robot | None = None,
    progress: Progress | None = None,
    *,
    known_id: str | None = None,
    repairs: bool = True,
) -> Plan:
    """Plan a request that is parsed already, see :func:`plan`.

    Args:
        request: The request.
        robot: As in :func:`plan`.
        progress: As in :func:`plan`.
        known_id: The id of the plan, where it is known already: it is not computed again.
        repairs: Whether a refusal explains itself and offers repairs.
    """
    asked_robot, robot = robot, resolve_robot(request, robot)
    known_id = known_id or plan_id(request, robot)
    robot = narrowed(robot, request.limits.joints)
    limits = MotionLimits.of(robot, request.limits)
    limits_of = _segment_limits(robot, request, limits)
    jerk = any(x.jerk is not None for x in (limits, *limits_of.values()))
    helped_by("plan", request.ik.method, jerk=jerk)
    clock = RequestBudget(request.budget_s, progress)
    start_free = request.start == "free"
    asked = None if request.start == "free" else request.start
    q_start = check_start(robot, robot.home if asked is None else asked)

    with clock.stage("ik"):
        solver = pose_solver(robot, request.ik, _EXACT, _EXACT)
    model = requested_model(robot, request.scene, request.fixed_joints, request.tool, always=True)
    contact = None
    if request.ik.objective == "clearance":
        contact = keep_clear(robot, solver, model, CONTACT_MARGIN)
    elif model is not None and len(model.pairs):
        contact = CollisionChecker(robot, model, CONTACT_MARGIN)
    problem = JointPathProblem(
        robot,
        solver,
        request.path,
        request.ik,
        q_start,
        start_free,
        joint_limits(robot, limits),
        clock,
        explain=repairs,
        contact=contact,
    )
    try:
        return _corrected(request, problem, limits, limits_of, model, known_id)
    except (Unreachable, Disconnected, InCollision) as error:
        if repairs:
            # The verdict stands, whether or not there is time left for repairs.
            with contextlib.suppress(BudgetExceeded):
                error.repairs = _repairs(request, asked_robot, problem, error)
        raise


def _repairs(
    request: PlanRequest,
    robot: Robot | None,
    problem: JointPathProblem,
    error: Unreachable | Disconnected | InCollision,
) -> list[dict[str, Any]]:
    """Changes of a request with which it is planned, timed and certified.

    Raises:
        BudgetExceeded: The time budget of the request ran out.
    """
    clock, solver = problem.clock, problem.solver
    clearance = request.scene.clearance if isinstance(request.scene, Scene) else 0.0
    with clock.stage("planning"), clock.cutting(solver.cut, solver.search_evaluations):
        return find_repairs(
            problem, error, lambda change: _survives(request, robot, change, clock), clearance
        )


def _corrected(
    request: PlanRequest,
    problem: JointPathProblem,
    limits: MotionLimits,
    limits_of: Mapping[str, MotionLimits],
    model: CollisionModel | None,
    known_id: str,
) -> Plan:
    """Plan, time and certify; moves on which the proof fails are rounded anew.

    Raises:
        InCollision: The proof fails all the same.
    """
    margins: dict[str, float] = {}
    for repair in range(_MOVE_REPAIRS + 1):
        motion = _motion(
            request, replace(problem, move_margins=margins), limits, limits_of, model, known_id
        )
        if isinstance(motion, Plan):
            return motion
        name, violation = motion
        if repair == _MOVE_REPAIRS:
            raise violation
        margins = {**margins, name: max(4.0 * margins.get(name, 0.0), CONTACT_MARGIN)}
    raise AssertionError("the loop returns or raises")


def _motion(
    request: PlanRequest,
    problem: JointPathProblem,
    limits: MotionLimits,
    limits_of: Mapping[str, MotionLimits],
    model: CollisionModel | None,
    known_id: str,
) -> Plan | tuple[str, InCollision]:
    """Plan, time and certify; where the proof fails on a move, its name and the violation.

    Raises:
        InCollision: The proof fails elsewhere.
    """
    robot, clock, solver = problem.robot, problem.clock, problem.solver
    with clock.stage("planning"), clock.cutting(solver.cut, solver.search_evaluations):
        route = plan_joint_path(problem)
        stages = MotionStages(request, limits, limits_of)
        laid = stages.laid(problem, route)
    with clock.stage("timing"):
        route, path, timing = stages.fastest(problem, laid)
    # Configurations too close to tell apart are passed as one.
    passed = path.q_knots[path.knot_of_waypoint]
    waypoint_q = passed[[w.index for w in route.waypoints]]
    times = timing.timed.times
    try:
        return assemble_plan(
            request,
            robot,
            limits,
            _waypoint_results(robot, route, waypoint_q, times, problem.start_free),
            timing,
            clock,
            q_start=None if problem.start_free else problem.q_start,
            path=request.path,
            moves=[move.report for move in route.moves],
            model=model,
            segment_times=_segment_times(route, times),
            plan_id=known_id,
        )
    except InCollision as violation:
        for move in route.moves:
            begin, end = float(times[move.first]), float(times[move.last])
            if violation.time is not None and begin <= violation.time <= end:
                return move.report.field, violation
        raise


def _survives(
    request: PlanRequest, robot: Robot | None, change: Mapping[str, Any], clock: TimeBudget
) -> bool:
    """Whether a request with a change is planned, timed, sampled and certified.

    Raises:
        BudgetExceeded: The time budget of the request ran out.
    """
    clock.check()
    document = merged_document(request.model_dump(mode="json", exclude_unset=True), change)
    document["budget_s"] = max(clock.left, 1e-3)
    try:
        make_plan(parse(PlanRequest, document), robot, repairs=False)
    except BudgetExceeded:
        raise
    except (IkplanError, TrackingFailed):
        return False
    return True


def _segment_times(
    route: JointRoute, times: NDArray[np.float64]
) -> list[tuple[float, float]] | None:
    """When each segment of the request begins and ends [s]; None: the path has no segments."""
    found: dict[int, tuple[float, float]] = {}
    for part in route.segments:
        number = segment_number(part.field)
        if number is not None:
            begin, end = float(times[part.first]), float(times[part.last])
            known = found.get(number, (begin, end))
            found[number] = min(begin, known[0]), max(end, known[1])
    if not found:
        ends = [float(times[w.index]) for w in route.waypoints]
        return list(zip([0.0, *ends], ends, strict=False)) or None
    last = begun = 0.0
    rows = []
    for number in range(max(found) + 1):
        begin, end = found.get(number, (last, last))
        # One that leads nowhere, at a rounded corner, is passed after the next one has begun.
        begun = max(begun, begin)
        rows.append((begun, max(begun, end)))
        last = rows[-1][1]
    return rows


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
    route: JointRoute,
    q: NDArray[np.float64],
    q_time: NDArray[np.float64],
    start_free: bool,
) -> WaypointResults:
    """The rows of the waypoints: one for each asked for."""
    arm = arm_of(robot)
    errors = [pose_distance(arm, w.target, q_w) for w, q_w in zip(route.waypoints, q, strict=True)]
    return WaypointResults(
        q=q,
        time=q_time[[w.index for w in route.waypoints]],
        position_error=np.array([distance for distance, _ in errors]),
        orientation_error=[
            angle if w.target.oriented else None
            for w, (_, angle) in zip(route.waypoints, errors, strict=True)
        ],
        elongation=joint_steps(q[0] if start_free else route.q[0], q),
    )
