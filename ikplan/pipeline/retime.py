"""Timing without planning: a joint path in, a certified joint trajectory out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikplan.certificate import RequestedSegment
from ikplan.documents import parse
from ikplan.documents.poses import Tolerance
from ikplan.documents.timing_request import TimingRequest
from ikplan.documents.trajectory import WaypointResults
from ikplan.errors import BudgetExceeded, IkplanError, InvalidRequest, TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.pipeline.asked.asked_motion import AskedMotion, asked_ends
from ikplan.pipeline.asked.asked_timing import time_as_asked
from ikplan.pipeline.asked.waypoint_times import time_at
from ikplan.pipeline.assemble import assemble_plan, joint_steps
from ikplan.pipeline.collisions import requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.hints.noise_hints import joint_noise_hints
from ikplan.pipeline.identity import plan_id
from ikplan.pipeline.near_path import Nearness, NearPath, smooth_path
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.pipeline.timing_stage import Timing, joint_limits
from ikplan.planning import Progress, TimeBudget
from ikplan.planning.limit_repairs import limit_repairs, nearest_repairs, offered
from ikplan.planning.repair_kinds import merged_document
from ikplan.plans.plan import Plan
from ikplan.robots import Robot
from ikplan.robots.narrowing import narrowed

__all__ = ["make_timing", "time_path", "time_request"]

Array = NDArray[np.float64]


def time_path(
    robot: Robot,
    joint_waypoints: ArrayLike,
    *,
    rate_hz: float | None = None,
    velocity_scale: float = 1.0,
    acceleration_scale: float = 1.0,
    limits: Mapping[str, Any] | None = None,
    rest_at: Sequence[int] = (),
    segments: Sequence[Mapping[str, Any]] = (),
    tolerance: ArrayLike | Mapping[str, float] | None = None,
    start_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    end_velocity: ArrayLike | None = None,
    times: Sequence[float | None] | Array | None = None,
) -> Plan:
    """Move through joint waypoints as fast as the limits allow, or as asked for.

    Args:
        robot: The robot, with its tool.
        joint_waypoints: Joint values, waypoints or samples of a path, shape (n, dof), n >= 1
            [rad or m]. A cubic spline is laid through them.
        rate_hz: Samples per second [Hz]; None: one a cycle of the robot's controller, or 250.
        velocity_scale: Share of the robot's velocity limits.
        acceleration_scale: Share of the robot's acceleration limits.
        limits: More limits, as in a request: ``{"jerk": 100, "tool_speed": 0.25, ...}``; without
            ``jerk``, the maker's jerk limits hold where published, ``False``: none; with
            ``duration``, the motion takes that time [s].
        rest_at: Indices of waypoints where the motion stops and may turn a sharp corner.
        segments: Parts with limits of their own, as in a request:
            ``{"first": 2, "last": 5, "limits": {"tool_speed": 0.1}}``, by indices of waypoints.
        tolerance: How far the motion may be from the polyline through the waypoints, so that it
            takes a smooth path past their noise: of every joint [rad or m], one value each, shape
            (dof,), or ``{"position": 1e-3, "orientation": 1e-2}`` of the tool [m and rad]. None:
            a spline passes through the waypoints.
        start_velocity: Joint velocities at the start, shape (dof,) [rad/s or m/s], for a robot
            that moves already; None: at rest.
        start_acceleration: Joint accelerations there, shape (dof,); they count under jerk limits.
        end_velocity: Joint velocities at the end, shape (dof,) [rad/s or m/s]; None: at rest.
        times: When each waypoint is passed [s], None in the list: whenever it suits; None: as soon
            as the limits allow.

    Returns:
        The certified trajectory: ``.time``, ``.q``, ``.dq``, ``.ddq``, ``.certificate``, ...

    Raises:
        InvalidRequest: A limit, the rate or the waypoints are wrong: which, and why.
        TimingFailed: No timing under the limits.
        CertificateViolated: The finished trajectory broke a promise: a bug.
    """
    options = {
        "velocity_scale": velocity_scale,
        "acceleration_scale": acceleration_scale,
        **(limits or {}),
    }
    document: dict[str, Any] = {
        "robot": robot.name or "robot",
        "waypoints": joint_waypoints,
        "rest_at": list(rest_at),
        "limits": options,
        "segments": list(segments),
        "sampling": {"rate_hz": rate_hz},
        "budget_s": 3600,
    }
    if tolerance is not None:
        given = dict(tolerance) if isinstance(tolerance, Mapping) else np.asarray(tolerance)
        document["tolerance"] = given if isinstance(given, dict) else given.tolist()
    rates = {
        "start_velocity": start_velocity,
        "start_acceleration": start_acceleration,
        "end_velocity": end_velocity,
        "times": times,
    }
    document |= {
        key: v.tolist() if isinstance(v, np.ndarray) else list(v)  # type: ignore[arg-type]
        for key, v in rates.items()
        if v is not None
    }
    return time_request(document, robot=robot)


def time_request(
    request: Mapping[str, Any] | TimingRequest,
    *,
    robot: Robot | None = None,
    progress: Progress | None = None,
) -> Plan:
    """Time the joint path of a request.

    Args:
        request: The request document.
        robot: The robot, for one that is not in the catalogue; None: load it by name. Its tool
            stands unless the request has one.
        progress: Is called with the name of each stage as it begins: ``progress("timing", 0, 0)``.

    Returns:
        The certified trajectory. The same request gives the same id and the same trajectory.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        TimingFailed: No timing under the limits.
        BudgetExceeded: ``budget_s`` ran out.
        CertificateViolated: The finished trajectory broke a promise: a bug.
    """
    return make_timing(with_meshes(parse(TimingRequest, request)), robot, progress)


def make_timing(
    request: TimingRequest,
    robot: Robot | None = None,
    progress: Progress | None = None,
    *,
    known_id: str | None = None,
    repairs: bool = True,
) -> Plan:
    """Time a request that is parsed already, see :func:`time_request`.

    Args:
        request: The request.
        robot: As in :func:`time_request`.
        progress: As in :func:`time_request`.
        known_id: The id of the plan, where it is known already: it is not computed again.
        repairs: Whether a refusal offers repairs.
    """
    asked_robot, robot = robot, resolve_robot(request, robot)
    known_id = known_id or plan_id(request, robot)
    clock = RequestBudget(request.budget_s, progress)
    try:
        return _made(request, robot, clock, known_id)
    except TimingFailed as error:
        if error.nearest:
            error.repairs = nearest_repairs(error)
        elif repairs:

            def survives(change: dict[str, Any]) -> bool:
                return _survives(request, asked_robot, change, clock)

            error.repairs = offered(limit_repairs(error, request.limits), survives)
        raise


def _survives(
    request: TimingRequest, robot: Robot | None, change: dict[str, Any], clock: RequestBudget
) -> bool:
    """Whether a request with a change is timed and certified.

    Raises:
        BudgetExceeded: The time budget of the request ran out.
    """
    clock.check()
    document = merged_document(request.model_dump(mode="json", exclude_unset=True), change)
    document["budget_s"] = max(clock.left, 1e-3)
    try:
        make_timing(parse(TimingRequest, document), robot, repairs=False)
    except BudgetExceeded:
        raise
    except IkplanError:
        return False
    return True


def _made(request: TimingRequest, robot: Robot, clock: RequestBudget, known_id: str) -> Plan:
    """Time a request with its robot."""
    robot = narrowed(robot, request.limits.joints)
    limits = MotionLimits.of(robot, request.limits)
    asked = _rows(request.waypoints, robot)
    segments = _limited_segments(request, robot, limits)
    requested = tuple(
        RequestedSegment(f"segments[{k}]", part.first, part.last, part.limits)
        for k, part in enumerate(request.segments)
    )
    helped_by("time", limits=(limits, *(s.limits for s in segments)))
    nearness = _nearness(request, robot)
    free = nearness is None
    ends = asked_ends(request, robot)
    asked_motion = AskedMotion(ends, (free, free), request.limits.duration)
    if nearness is None:
        with clock.stage("planning"):
            path = JointPath.through(asked, joint_limits(robot, limits), rest_at=request.rest_at)
            # Waypoints too close to tell apart are passed as one.
            waypoints = path.q_knots[path.knot_of_waypoint]
            if request.times is not None:
                waypoints = asked.copy()
        with clock.stage("timing"):
            timing = (
                time_as_asked(
                    path, robot, limits, request.sampling, segments, asked_motion, clock.check
                )
                if request.times is None
                else time_at(
                    asked,
                    request.times,
                    robot,
                    limits,
                    request.sampling,
                    segments,
                    request.rest_at,
                    asked_motion,
                    clock.check,
                )
            )
        times = timing.timed.times
        hints = joint_noise_hints(robot, asked, times)
    else:
        near, timing = _near_motion(
            request, robot, limits, asked, nearness, segments, asked_motion, clock
        )
        waypoints = near.path(near.s)
        waypoints[0], waypoints[-1] = asked[0], asked[-1]
        times = timing.timed.times_anywhere(near.s)
        times[-1] = timing.timed.duration
        hints = []
    distances = [
        float(np.linalg.norm(robot.fk(wanted).translation - robot.fk(passed).translation))
        for wanted, passed in zip(asked, waypoints, strict=True)
    ]
    results = WaypointResults(
        q=waypoints,
        time=times,
        position_error=np.array(distances),
        orientation_error=[None] * len(waypoints),
        elongation=joint_steps(waypoints[0], waypoints),
    )
    return assemble_plan(
        request,
        robot,
        limits,
        results,
        timing,
        clock,
        q_start=waypoints[0],
        ends=ends,
        segments=requested,
        joint_waypoints=asked,
        tolerance=request.tolerance,
        hints=hints,
        model=requested_model(
            robot, request.scene, request.fixed_joints, request.tool, always=False
        ),
        plan_id=known_id,
    )


def _nearness(request: TimingRequest, robot: Robot) -> Nearness | None:
    """What the tolerance of a request says; None: there is none."""
    tolerance = request.tolerance
    if tolerance is None:
        return None
    if isinstance(tolerance, Tolerance):
        return Nearness(None, tolerance)
    if isinstance(tolerance, list) and len(tolerance) != robot.dof:
        raise InvalidRequest(
            f"tolerance: {robot.dof} values wanted ({', '.join(robot.joint_names)}), "
            f"got {len(tolerance)}",
            field="tolerance",
            allowed=f"{robot.dof} numbers, one number, or position and orientation of the tool",
        )
    return Nearness(np.broadcast_to(np.array(tolerance), (robot.dof,)).copy(), None)


def _near_motion(
    request: TimingRequest,
    robot: Robot,
    limits: MotionLimits,
    asked: Array,
    nearness: Nearness,
    segments: Sequence[LimitedSegment],
    asked_motion: AskedMotion,
    clock: TimeBudget,
) -> tuple[NearPath, Timing]:
    """Time a smooth path near the waypoints; where there are sharp corners, the faster of two.

    One rounds them within the tolerance, the other stops at them.
    """
    bounds = joint_limits(robot, limits)
    if len(asked) and request.rest_at and max(request.rest_at) >= len(asked):
        raise InvalidRequest(
            f"rest_at: there is no waypoint {max(request.rest_at)}",
            field="rest_at",
            allowed=f"0 to {len(asked) - 1}",
        )
    bounds.check_positions(asked, "waypoints")
    rows = sorted({row for part in segments for row in (part.first, part.last)})
    own = [
        replace(part, first=rows.index(part.first), last=rows.index(part.last)) for part in segments
    ]
    best: tuple[NearPath, Timing] | None = None
    for stop_at_sharp in (False, True):
        with clock.stage("planning"):
            near = smooth_path(
                asked,
                robot,
                bounds,
                nearness,
                rest_at=request.rest_at,
                rows=rows,
                stop_at_sharp=stop_at_sharp,
            )
        with clock.stage("timing"):
            timing = time_as_asked(
                near.path, robot, limits, request.sampling, own, asked_motion, clock.check
            )
        if best is None or timing.timed.duration < best[1].timed.duration:
            best = near, timing
        if not near.sharp:
            break
    assert best is not None
    return best


def _limited_segments(
    request: TimingRequest, robot: Robot, limits: MotionLimits
) -> list[LimitedSegment]:
    """The parts of the path with limits of their own."""
    found, count = [], len(request.waypoints)
    for k, part in enumerate(request.segments):
        if part.last >= count:
            raise InvalidRequest(
                f"segments[{k}].last: there is no waypoint {part.last}",
                field=f"segments[{k}].last",
                allowed=f"1 to {count - 1}",
            )
        own = limits.within(robot, part.limits, f"segments[{k}].limits")
        found.append(LimitedSegment(f"segments[{k}]", part.first, part.last, own))
    return found


def _rows(waypoints: list[list[float]], robot: Robot) -> Array:
    """The waypoints as an array of shape (n, dof)."""
    for i, row in enumerate(waypoints):
        if len(row) != robot.dof:
            raise InvalidRequest(
                f"waypoints[{i}]: {robot.dof} values expected ({', '.join(robot.joint_names)}), "
                f"got {len(row)}",
                field=f"waypoints[{i}]",
                allowed=f"{robot.dof} numbers",
            )
    return np.array(waypoints, dtype=np.float64)
