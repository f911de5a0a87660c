"""The last stage of a plan and of a timing: certify the trajectory and put the plan together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ikplan._version import __version__
from ikplan.arrays import lengths_of, steps_of
from ikplan.certificate import Claim, RequestedSegment, certify
from ikplan.certificate.clearance.leaving import Leaving
from ikplan.certificate.regions import has_regions, prove_regions
from ikplan.certificate.requested import read_motion
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.poses import PostureReport
from ikplan.documents.timing_request import PathNearness, TimingRequest
from ikplan.documents.trajectory import EventResult, MoveReport, Stats, WaypointResults
from ikplan.ik.solve import pose_distance
from ikplan.kinematics.arm import arm_of
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.asked.events import EventFinder
from ikplan.pipeline.collisions import handed_out, prove_motion
from ikplan.pipeline.hints.limit_hints import default_hints, segment_hints
from ikplan.pipeline.hints.noise_hints import path_noise_hints
from ikplan.pipeline.hints.stop_hints import stop_hints
from ikplan.pipeline.timing_stage import Timing
from ikplan.planning import JointRoute
from ikplan.planning.posture import report_posture
from ikplan.plans.plan import Plan
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.time_budget import TimeBudget
from ikplan.timing.moving.moving_ends import MovingEnds

__all__ = ["assemble_plan", "joint_steps", "waypoint_results"]

Array = NDArray[np.float64]


def joint_steps(q_before: Array, q: Array) -> Array:
    """Return the joint motion to each configuration from the one before, shape (n,) [rad or m].

    Args:
        q_before: The configuration before the first, shape (dof,) [rad or m].
        q: Configurations, shape (n, dof) [rad or m].
    """
    steps = steps_of(np.vstack([q_before[None], q]))
    return lengths_of(steps)


def waypoint_results(
    robot: Robot,
    route: JointRoute,
    q: Array,
    q_time: Array,
    start_free: bool,
) -> WaypointResults:
    """Return the rows of the waypoints: one for each asked for.

    Args:
        robot: The robot, with the request's tool.
        route: The joint route.
        q: Configurations at the waypoints, shape (n, dof) [rad or m].
        q_time: When each configuration of the route is passed, shape (k,) [s].
        start_free: Whether the motion may begin anywhere.
    """
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


def _posture_report(
    request: PlanRequest | TimingRequest, robot: Robot, q: Array
) -> PostureReport | None:
    """How far samples, shape (m, dof), keep to the posture of a request."""
    return (
        report_posture(robot, request.ik.posture, q) if isinstance(request, PlanRequest) else None
    )


def _dwells(
    robot: Robot, path: PathRequest | None, q_start: Array | None, order: tuple[int, ...] | None
) -> tuple[tuple[int, float], ...]:
    """Rows of waypoints at which a path asks the motion to stand, and how long [s]."""
    segments = [] if path is None else path.segments or []
    if path is None or not any(segment.dwell for segment in segments):
        return ()
    rows = read_motion(robot, path, q_start, order).last_rows
    return tuple(
        (rows[f"path.segments[{k}]"], segment.dwell)
        for k, segment in enumerate(segments)
        if segment.dwell
    )


def _times(request: PlanRequest | TimingRequest) -> tuple[float | None, ...] | None:
    given = request.times if isinstance(request, TimingRequest) else None
    return None if given is None else tuple(given)


def _events(
    request: PlanRequest | TimingRequest,
    robot: Robot,
    path: PathRequest | None,
    q_start: Array | None,
    order: tuple[int, ...] | None,
    timing: Timing,
    waypoint_time: Array,
) -> list[EventResult]:
    """When the events of a request are."""
    if not isinstance(request, PlanRequest) or path is None or not request.events:
        return []
    finder = EventFinder(
        robot,
        timing.timed,
        read_motion(robot, path, q_start, order),
        len(path.waypoints or path.segments or ()),
        waypoint_time,
        path.segments is not None,
    )
    return [finder.found(event, f"events[{k}]") for k, event in enumerate(request.events)]


def assemble_plan(
    request: PlanRequest | TimingRequest,
    robot: Robot,
    limits: MotionLimits,
    waypoints: WaypointResults,
    timing: Timing,
    clock: TimeBudget,
    *,
    q_start: Array | None,
    path: PathRequest | None = None,
    segments: tuple[RequestedSegment, ...] = (),
    moves: Sequence[MoveReport] = (),
    model: CollisionModel | None = None,
    segment_times: Sequence[tuple[float, float]] | None = None,
    joint_waypoints: Array | None = None,
    tolerance: PathNearness | None = None,
    order: tuple[int, ...] | None = None,
    leaving: Leaving | None = None,
    hints: Sequence[str] = (),
    ends: MovingEnds | None = None,
    plan_id: str,
) -> Plan:
    """Certify a timed trajectory and return it as the plan of its request.

    Args:
        request: The request.
        robot: The robot, with the request's tool.
        limits: The limits of the whole motion.
        waypoints: The rows of the waypoints: where and when each is passed.
        timing: The timed trajectory.
        clock: The time budget.
        q_start: Start that was asked for, shape (dof,) [rad or m]; None: any.
        path: The path asked for; None: the waypoints are joint values.
        segments: Parts of a joint path with limits of their own.
        moves: Reports of the moves around obstacles.
        model: Bodies that must not touch; None: nothing is checked.
        segment_times: When each segment begins and ends, in the order passed [s], for attached
            bodies.
        joint_waypoints: Joint values that a timing asks for, shape (n, dof); None: a path is.
        tolerance: How far from the polyline through them the motion may be; None: not asked.
        order: Numbers of the parts of the path in the order passed; None: as it is written.
        leaving: Pairs that touch at the start, which is left, and until when they may.
        hints: What takes time and need not, in words.
        ends: Joint rates asked for at the ends; None: rest.
        plan_id: The id of the plan.

    Raises:
        BudgetExceeded: The time budget ran out.
        InCollision: Bodies come nearer than allowed.
        RegionLeft: The tool leaves the region of a move.
        CertificateViolated: The trajectory broke a promise: a bug.
    """
    samples = timing.samples
    with clock.stage("certificate"):
        certificate = certify(
            Claim(
                robot=robot,
                path=path,
                q_start=q_start,
                waypoint_q=waypoints.q,
                waypoint_time=waypoints.time,
                time=samples.time,
                q=samples.q,
                dq=samples.dq,
                ddq=samples.ddq,
                limits=limits,
                segments=segments,
                stop_time=timing.timed.stop_times,
                joint_waypoints=joint_waypoints,
                joint_tolerance=tolerance,
                order=order,
                start_velocity=None if ends is None else ends.start_velocity,
                end_velocity=None if ends is None else ends.end_velocity,
                duration=request.limits.duration,
                times=_times(request),
                dwells=_dwells(robot, path, q_start, order),
            )
        )
        if path is not None and has_regions(path):
            motion = read_motion(robot, path, q_start, order)
            curve = handed_out(timing)
            regions = prove_regions(robot, path, motion, waypoints.time, curve)
            certificate = certificate.model_copy(update={"regions": regions})
        if model is not None:
            clearance = prove_motion(robot, model, timing, segment_times, order, leaving)
            certificate = certificate.model_copy(update={"clearance": clearance})
    asked = request.path if isinstance(request, PlanRequest) else None
    told = [
        *hints,
        *stop_hints(certificate, path, asked),
        *path_noise_hints(path, np.array(waypoints.q), np.array(waypoints.time)),
        *default_hints(robot, request.limits),
        *segment_hints(robot, request.limits, limits, asked),
    ]
    return Plan(
        id=plan_id,
        version=__version__,
        robot=request.robot,
        joint_names=list(robot.joint_names),
        joint_units=["m" if slides else "rad" for slides in robot.prismatic],
        waypoints=waypoints,
        trajectory=timing.trajectory,
        certificate=certificate,
        timing=timing.report.model_copy(update={"hints": told}),
        motion=timing.motion,
        posture=_posture_report(request, robot, samples.q),
        events=_events(request, robot, path, q_start, order, timing, waypoints.time),
        controller=None if robot.controller is None else robot.controller.info(),
        stats=Stats(ik_evaluations=clock.evaluations, moves=list(moves), seconds=clock.seconds),
    )
