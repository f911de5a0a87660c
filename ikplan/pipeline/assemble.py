"""The last stage of a plan and of a timing: certify the trajectory and put the plan together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ikplan._version import __version__
from ikplan.certificate import Claim, RequestedSegment, certify
from ikplan.certificate.clearance.leaving import Leaving
from ikplan.certificate.regions import has_regions, prove_regions
from ikplan.certificate.requested import read_motion
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.timing_request import PathNearness, TimingRequest
from ikplan.documents.trajectory import MoveReport, Stats, WaypointResults
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.collisions import handed_out, prove_motion
from ikplan.pipeline.hints import stop_hints
from ikplan.pipeline.timing_stage import Timing
from ikplan.plans.plan import Plan
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.time_budget import TimeBudget

__all__ = ["assemble_plan", "joint_steps"]

Array = NDArray[np.float64]


def joint_steps(q_before: Array, q: Array) -> Array:
    """Return the joint motion to each configuration from the one before, shape (n,) [rad or m].

    Args:
        q_before: The configuration before the first, shape (dof,) [rad or m].
        q: Configurations, shape (n, dof) [rad or m].
    """
    steps = np.diff(np.vstack([q_before[None], q]), axis=0)
    return np.asarray(np.linalg.norm(steps, axis=1))


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
    return Plan(
        id=plan_id,
        version=__version__,
        robot=request.robot,
        joint_names=list(robot.joint_names),
        joint_units=["m" if slides else "rad" for slides in robot.prismatic],
        waypoints=waypoints,
        trajectory=timing.trajectory,
        certificate=certificate,
        timing=timing.report.model_copy(update={"hints": [*hints, *stop_hints(certificate, path)]}),
        motion=timing.motion,
        controller=None if robot.controller is None else robot.controller.info(),
        stats=Stats(ik_evaluations=clock.evaluations, moves=list(moves), seconds=clock.seconds),
    )
