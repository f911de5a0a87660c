"""plan(): the stages in the order they run."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.clearance.leaving import Leaving
from ikplan.certificate.regions import RegionLeft
from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.errors import (
    BudgetExceeded,
    Disconnected,
    IkplanError,
    InCollision,
    TimingFailed,
    Unreachable,
)
from ikplan.ik.arguments import check_start
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.asked.asked_motion import asked_ends
from ikplan.pipeline.asked.least_time import in_least_time
from ikplan.pipeline.assemble import assemble_plan, waypoint_results
from ikplan.pipeline.collisions import keep_clear, requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.identity import plan_id
from ikplan.pipeline.motion_stages import MotionStages, TimedRoute
from ikplan.pipeline.poses import pose_solver
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.pipeline.timing_stage import joint_limits
from ikplan.planning import (
    JointPathProblem,
    Progress,
)
from ikplan.planning.limit_repairs import nearest_repairs
from ikplan.planning.moves.leave import leaving_contact
from ikplan.planning.posture import motion_cost, preferred_configuration, softened
from ikplan.planning.repair_kinds import merged_document
from ikplan.planning.segment_times import segment_times
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
_EVENT_CLOSENESS = 5e-7
"""How near the tool stays to its path where events are at places on it [m]."""
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
    helped_by("plan", request.ik.method, (limits, *limits_of.values()))
    clock = RequestBudget(request.budget_s, progress)
    start_free = request.start == "free"
    asked = None if request.start == "free" else request.start
    q_start = check_start(robot, robot.home if asked is None else asked)
    posture = None if request.ik.posture is None else motion_cost(robot, request.ik.posture)
    if start_free:
        q_start = preferred_configuration(robot, request.ik.posture)

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
        posture=posture,
        closeness=_EVENT_CLOSENESS if _has_places(request) else np.inf,
    )
    stages = MotionStages(request, robot, limits, limits_of)
    try:
        if isinstance(request.scene, Scene) and request.scene.leave_contact:
            problem = leaving_contact(problem, contact)
        return _within_soft_limits(stages, problem, model, known_id) or _ordered(
            stages, problem, model, known_id
        )
    except (Unreachable, Disconnected, InCollision, TimingFailed) as error:
        if isinstance(error, TimingFailed) and error.nearest:
            error.repairs = nearest_repairs(error)
        elif repairs and request.repairs != 0:
            # The verdict stands, whether or not there is time left for repairs.
            with contextlib.suppress(BudgetExceeded):
                error.repairs = _repairs(request, asked_robot, problem, error)
        raise


def _has_places(request: PlanRequest) -> bool:
    """Whether events of a request are at places of the tool."""
    return any(event.distance is not None for event in request.events)


def _repairs(
    request: PlanRequest,
    robot: Robot | None,
    problem: JointPathProblem,
    error: Unreachable | Disconnected | InCollision | TimingFailed,
) -> list[dict[str, Any]]:
    """Changes of a request with which it is planned, timed and certified.

    Raises:
        BudgetExceeded: The time budget of the request ran out.
    """
    from ikplan.planning.repairs import find_repairs  # for refusals

    clock, solver = problem.clock, problem.solver
    clearance = request.scene.clearance if isinstance(request.scene, Scene) else 0.0
    with clock.stage("planning"), clock.cutting(solver.cut, solver.search_evaluations):
        return find_repairs(
            problem,
            error,
            lambda change: _survives(request, robot, change, clock),
            clearance,
            request.limits,
            request.repairs,
        )


def _within_soft_limits(
    stages: MotionStages, problem: JointPathProblem, model: CollisionModel | None, known_id: str
) -> Plan | None:
    """The plan within the soft limits of the request; None: it has none, or no plan within."""
    robot = softened(problem.robot, stages.request)
    if robot is None:
        return None
    with problem.clock.stage("ik"):
        solver = pose_solver(robot, problem.options, _EXACT, _EXACT)
    soft = replace(
        problem,
        robot=robot,
        solver=solver,
        limits=joint_limits(robot, stages.limits),
        explain=False,
    )
    try:
        return _ordered(stages, soft, model, known_id)
    except (Unreachable, Disconnected, InCollision, TimingFailed, TrackingFailed):
        return None


def _ordered(
    stages: MotionStages, problem: JointPathProblem, model: CollisionModel | None, known_id: str
) -> Plan:
    """The plan of a path in the order asked for."""
    said: dict[str, Any] = {}
    if stages.request.path.order == "given":
        motion = stages.timed(problem)
    else:
        problem, motion, said["order"] = stages.in_best_order(problem)
    if stages.request.ik.objective == "time":
        problem, motion, said["objective"] = in_least_time(stages, problem, motion)
    plan = _corrected(stages, problem, motion, model, known_id)
    return plan.model_copy(update=said) if said else plan


def _corrected(
    stages: MotionStages,
    problem: JointPathProblem,
    motion: TimedRoute,
    model: CollisionModel | None,
    known_id: str,
) -> Plan:
    """Certify a timed route; moves on which the proof fails are rounded anew.

    Raises:
        InCollision: The proof fails all the same.
    """
    margins: dict[str, float] = {}
    for repair in range(_MOVE_REPAIRS + 1):
        certified = _certified(stages, problem, motion, model, known_id)
        if isinstance(certified, Plan):
            return certified
        name, violation = certified
        if repair == _MOVE_REPAIRS:
            raise violation
        margins = {**margins, name: max(4.0 * margins.get(name, 0.0), CONTACT_MARGIN)}
        motion = stages.timed(replace(problem, move_margins=margins))
    raise AssertionError("the loop returns or raises")


def _certified(
    stages: MotionStages,
    problem: JointPathProblem,
    motion: TimedRoute,
    model: CollisionModel | None,
    known_id: str,
) -> Plan | tuple[str, InCollision | Disconnected]:
    """Certify a timed route; where a proof fails on a move, its name and the verdict.

    Raises:
        InCollision: The proof fails elsewhere.
    """
    request, robot = stages.request, stages.robot
    route, path, timing, followed = motion
    # Configurations too close to tell apart are passed as one.
    passed = path.q_knots[path.knot_of_waypoint]
    waypoint_q = passed[[w.index for w in route.waypoints]]
    times = timing.timed.times
    try:
        return assemble_plan(
            request,
            robot,
            stages.limits,
            waypoint_results(robot, route, waypoint_q, times, problem.start_free),
            timing,
            problem.clock,
            q_start=None if problem.start_free else _begin(problem),
            path=followed,
            moves=[move.report for move in route.moves],
            model=model,
            segment_times=segment_times(route, times, problem.order),
            order=problem.order,
            leaving=_leaving(problem, motion),
            ends=asked_ends(request, robot),
            plan_id=known_id,
        )
    except RegionLeft as left:
        return left.field, Disconnected(
            f"{left.field}: at {left.time:.3f} s of the finished motion the tool leaves the region "
            "it is to stay in, or it cannot be told that it does not; no other way was found",
            waypoints=[],
            jump=0.0,
            reason="the tool leaves the region of the move",
            q=left.q.tolist(),
        )
    except InCollision as violation:
        for move in route.moves:
            begin, end = float(times[move.first]), float(times[move.last])
            if violation.time is not None and begin <= violation.time <= end:
                return move.report.field, violation
        raise


def _begin(problem: JointPathProblem) -> NDArray[np.float64]:
    return problem.q_start if problem.left_from is None else problem.left_from


def _leaving(problem: JointPathProblem, motion: TimedRoute) -> Leaving | None:
    """What the motion leaves at the start; it has to be left by the next sample after it rests."""
    if problem.left_from is None or problem.left is None:
        return None
    rests = float(motion.timing.timed.times[1])
    samples = motion.timing.samples.time
    until = float(samples[min(int(np.searchsorted(samples, rests)), len(samples) - 1)])
    return Leaving(tuple(int(row) for row in problem.left), until)


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


def _segment_limits(
    robot: Robot, request: PlanRequest, limits: MotionLimits
) -> dict[str, MotionLimits]:
    """What the motion has to keep on each segment that has limits of its own, by field."""
    found: dict[str, MotionLimits] = {}
    # What is asked for alike is one object, so that what follows from it is found once.
    known: dict[str, MotionLimits] = {}
    for k, segment in enumerate(request.path.segments or ()):
        if segment.limits is None:
            continue
        field, asked = f"path.segments[{k}]", segment.limits.model_dump_json()
        if asked not in known:
            known[asked] = limits.within(robot, segment.limits, f"{field}.limits")
        found[field] = known[asked]
    return found
