"""What a plan does over time beside its samples, by the certificate's own means."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import Tool, match_legs, timed_legs
from ikplan.certificate.limits import joint_torques
from ikplan.certificate.requested import read_motion
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.documents.trajectory import PlanSeries
from ikplan.ik.arguments import check_start
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.collisions import requested_model, with_meshes
from ikplan.pipeline.resolve import resolve_robot
from ikplan.plans.clearance_samples import clearance_over_time
from ikplan.plans.plan import Plan
from ikplan.robots import Robot

__all__ = ["plan_series"]


def plan_series(request: PlanRequest, plan: Plan, *, robot: Robot | None = None) -> PlanSeries:
    """Measure a plan over time: torques, deviation from its path, distances between bodies.

    Args:
        request: The request that the plan answers.
        plan: The plan.
        robot: The robot, for one that is not in the catalogue; None: load it by name.

    Returns:
        The measures; distances are those at samples, not the proof between them.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
    """
    request = with_meshes(request)
    robot = resolve_robot(request, robot)
    limits = MotionLimits.of(robot, request.limits)
    samples = plan.trajectory
    deviation, turn = _deviations(_claim(request, plan, robot, limits))
    model = requested_model(robot, request.scene, request.fixed_joints, request.tool, always=True)
    clearance_time, clearance = np.zeros(0), np.zeros(0)
    if model is not None and len(model.pairs):
        clearance_time, clearance = clearance_over_time(plan, robot, model)
    torque = None
    if robot.info().inertias_sourced:
        torque = joint_torques(
            robot,
            samples.q,
            samples.dq,
            samples.ddq,
            limits.payload_mass,
            limits.payload_position,
        )
    highest = robot.effort_limit if limits.torque is None else limits.torque
    return PlanSeries(
        time=samples.time,
        torque=torque,
        torque_limit=[float(v) if 0.0 < v < np.inf else None for v in highest],
        deviation=_known(deviation),
        deviation_limit=request.path.tolerance.position,
        turn=_known(turn),
        turn_limit=request.path.tolerance.orientation,
        clearance_time=clearance_time,
        clearance=_known(clearance),
        clearance_limit=request.scene.clearance if isinstance(request.scene, Scene) else 0.0,
    )


def _claim(request: PlanRequest, plan: Plan, robot: Robot, limits: MotionLimits) -> Claim:
    asked = None if request.start == "free" else request.start
    samples = plan.trajectory
    return Claim(
        robot=robot,
        path=request.path,
        q_start=(
            None
            if request.start == "free"
            else check_start(robot, robot.home if asked is None else asked)
        ),
        waypoint_q=plan.waypoints.q,
        waypoint_time=plan.waypoints.time,
        time=samples.time,
        q=samples.q,
        dq=samples.dq,
        ddq=samples.ddq,
        limits=limits,
        order=None if plan.order is None else tuple(plan.order.parts),
    )


def _deviations(claim: Claim) -> tuple[Array, Array]:
    """Distance and angle off the path at each sample, NaN where there is none, shape (m,)."""
    distance, angle = np.full((2, len(claim.time)), np.nan)
    assert claim.path is not None
    motion = read_motion(claim.robot, claim.path, claim.q_start, claim.order)
    tool = Tool.of(claim, samples=bool(motion.legs))
    for part in match_legs(claim, timed_legs(claim, motion), tool):
        distance[part.sample] = part.distance
        angle[part.sample] = np.where(part.oriented, part.angle, np.nan)
    return distance, angle


def _known(values: Array) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]
