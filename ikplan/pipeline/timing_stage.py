"""The timing stage: a joint path and its limits to a timed, sampled motion and why it takes so."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ikplan.documents.limits import SamplingOptions
from ikplan.documents.timing_report import BindingLimit, MotionPolynomials, TimingReport, WiderLimit
from ikplan.documents.trajectory import Trajectory
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.pipeline.still_joints import refuse_moving
from ikplan.robots import Robot
from ikplan.timing import (
    PathConstraint,
    Samples,
    SegmentJointLimits,
    TimedPath,
    ToolLimits,
    TorqueLimits,
    binding,
    periods,
    sample_at_nodes,
    sampled_within_limits,
    what_ifs,
)
from ikplan.timing.braking import turning_points
from ikplan.timing.constraints.models import inverse_dynamics, tool_motion
from ikplan.timing.constraints.tangential_limit import TangentialLimit
from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.limit_jerk import limit_jerk
from ikplan.timing.time_joint_path import time_before_jerk

__all__ = [
    "Motion",
    "Timing",
    "joint_limits",
    "least_timing",
    "motion_polynomials",
    "move_along",
    "prepared",
    "report_of",
    "reported",
    "sampling_rate",
    "time_motion",
]

DEFAULT_RATE_HZ = 250.0
"""Samples per second where neither the request nor a controller says [Hz]."""

# How many of the limits that bind are asked what they cost, and how much of the time they must.
_ASKED = 3
_ASKED_OF_SLOW = 1  # where timing again takes long: limits of jerks, torques and the tool
_LEAST_SHARE = 0.05
_WIDER = 1.1


@dataclass(frozen=True, eq=False)
class Motion:
    """A timed and sampled joint path, nothing said yet of why it takes as long as it does.

    Attributes:
        free: The motion before it is slowed to end at a sample.
        timed: The motion.
        samples: Samples at the controller's period, those of the trajectory among them.
        sampling: The samples asked for.
        rate_hz: Samples per second [Hz].
        rate_source: Who says so.
        jerk_source: Who limits jerks; None: nobody.
    """

    free: TimedPath
    timed: TimedPath
    samples: Samples
    sampling: SamplingOptions
    rate_hz: float
    rate_source: str
    jerk_source: str | None


@dataclass(frozen=True, eq=False)
class Timing:
    """A timed joint path.

    Attributes:
        timed: The motion.
        samples: Samples at the controller's period, and where the trajectory has others, those
            too: what the certificate looks at.
        trajectory: Samples in the form asked for.
        motion: The motion as polynomials, if they were asked for.
        report: Why it takes as long as it does.
    """

    timed: TimedPath
    samples: Samples
    trajectory: Trajectory
    motion: MotionPolynomials | None
    report: TimingReport


@functools.lru_cache(maxsize=64)
def joint_limits(robot: Robot, limits: MotionLimits) -> JointLimits:
    """Return what bounds the joints of a motion; of the same objects, the same."""
    return JointLimits(
        lower=robot.lower,
        upper=robot.upper,
        velocity=limits.velocity,
        velocity_lower=limits.velocity_lower,
        acceleration=limits.acceleration,
        acceleration_lower=limits.acceleration_lower,
        jerk=limits.jerk,
        deceleration=limits.deceleration,
        joint_names=tuple(robot.joint_names),
    )


def sampling_rate(robot: Robot, sampling: SamplingOptions) -> tuple[float, str]:
    """Return how many samples a second a trajectory has [Hz], and who says so.

    Args:
        robot: The robot.
        sampling: Samples asked for.

    Returns:
        The rate, and "request", "controller" (one sample a cycle) or "default".
    """
    if sampling.rate_hz is not None:
        return sampling.rate_hz, "request"
    if robot.controller is not None:
        return 1.0 / robot.controller.cycle, "controller"
    return DEFAULT_RATE_HZ, "default"


def time_motion(
    path: JointPath,
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    segments: Sequence[LimitedSegment] = (),
    check: Check = unlimited,
) -> Timing:
    """Move along a joint path as fast as the limits allow, and sample the motion.

    Args:
        path: The path.
        robot: The robot, with its tool.
        limits: What the motion has to keep.
        sampling: Samples wanted.
        segments: Segments between waypoints of the path with limits of their own.
        check: Is called now and then, and may end the stage by an error of its own.

    Returns:
        The motion.

    Raises:
        InvalidRequest: The motion is too long for the rate, or a joint moves whose limit is 0.
        TimingFailed: No timing under the limits: where, which joint, which limit.
    """
    return reported(move_along(path, robot, limits, sampling, segments, check), check)


def move_along(
    path: JointPath,
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    segments: Sequence[LimitedSegment] = (),
    check: Check = unlimited,
    known: TimedPath | None = None,
    most: float = np.inf,
) -> Motion:
    """Move along a joint path as :func:`time_motion` does, without the report.

    Args:
        path: The path.
        robot: The robot, with its tool.
        limits: What the motion has to keep.
        sampling: Samples wanted.
        segments: Segments between waypoints of the path with limits of their own.
        check: Is called now and then, and may end the stage by an error of its own.
        known: What :func:`least_timing` has found.
        most: What a jerk-limited motion may take [s].

    Raises:
        InvalidRequest: The motion is too long for the rate, or a joint moves whose limit is 0.
        TimingFailed: No timing under the limits: where, which joint, which limit.
        NotShorter: The motion takes longer than ``most``.
    """
    path, joint_segments, constraints = prepared(path, robot, limits, segments)
    if known is None:
        known = _before_jerk(path, robot, limits, joint_segments, constraints, check)
    if any(x.jerk is not None for x in (limits, *(s.limits for s in segments))):
        known = limit_jerk(known, check, most)
    rate_hz, rate_source = sampling_rate(robot, sampling)
    at_nodes = sampling.form == "knots"
    timed, samples = sampled_within_limits(known, rate_hz, constraints, at_nodes, check)
    return Motion(known, timed, samples, sampling, rate_hz, rate_source, limits.jerk_source)


def reported(motion: Motion, check: Check = unlimited) -> Timing:
    """Return a motion in the form asked for, and why it takes as long as it does.

    Args:
        motion: The motion.
        check: Is called now and then, and may end the stage by an error of its own.
    """
    free, timed, samples = motion.free, motion.timed, motion.samples
    shown = sample_at_nodes(timed) if motion.sampling.form == "knots" else samples
    return Timing(
        timed=timed,
        samples=samples,
        trajectory=Trajectory(time=shown.time, q=shown.q, dq=shown.dq, ddq=shown.ddq),
        motion=motion_polynomials(timed) if motion.sampling.form == "polynomial" else None,
        report=report_of(
            free,
            check,
            duration=timed.duration,
            rate_hz=motion.rate_hz,
            rate_source=motion.rate_source,
            grid_factor=max(timed.duration / free.duration, 1.0) if free.duration > 0.0 else 1.0,
            jerk_source=motion.jerk_source,
            zero_end_acceleration=not samples.ddq[[0, -1]].any(),
        ),
    )


def _runs(
    ranges: Sequence[tuple[float, float, MotionLimits]],
) -> list[tuple[float, float, MotionLimits]]:
    """Join ranges, begin, end and limits, that meet and limit the tool alike.

    Segments on both sides of a rounded corner overlap.
    """
    runs: list[tuple[float, float, MotionLimits]] = []
    for start, end, limits in ranges:
        if runs and start <= runs[-1][1] and _alike(runs[-1][2], limits):
            start, before, _ = runs.pop()
            end = max(before, end)
        runs.append((start, end, limits))
    return runs


def _alike(a: MotionLimits, b: MotionLimits) -> bool:
    """Whether two limits ask the same of the tool and of the torques."""
    rates = [(*x.tool_speed, *x.tool_acceleration) for x in (a, b)]
    return rates[0] == rates[1] and (b.torque is a.torque) and not _more_torque(b, a)


def least_timing(
    path: JointPath,
    robot: Robot,
    limits: MotionLimits,
    segments: Sequence[LimitedSegment] = (),
    check: Check = unlimited,
) -> TimedPath:
    """Return the motion that no jerk limit slows; arguments as above.

    With jerk limits it is the one that theirs is found from, and rests where that has to.

    Raises:
        InvalidRequest: A joint moves whose limit is 0.
        TimingFailed: No timing under the limits.
    """
    path, joint_segments, constraints = prepared(path, robot, limits, segments)
    return _before_jerk(path, robot, limits, joint_segments, constraints, check)


def _before_jerk(
    path: JointPath,
    robot: Robot,
    limits: MotionLimits,
    segments: Sequence[SegmentJointLimits],
    constraints: Sequence[PathConstraint],
    check: Check,
) -> TimedPath:
    bounds = joint_limits(robot, limits)
    return time_before_jerk(path, bounds, segments=segments, constraints=constraints, check=check)


def prepared(
    path: JointPath, robot: Robot, limits: MotionLimits, segments: Sequence[LimitedSegment]
) -> tuple[JointPath, list[SegmentJointLimits], list[PathConstraint]]:
    """Return a path with the knots that its limits need, and limits of ranges, tool and torques."""
    refuse_moving(robot, path, limits, 0.0, path.length)
    if any(x.deceleration is not None for x in (limits, *(s.limits for s in segments))):
        path = path.with_knots(turning_points(path))
    constraints = _constraints(robot, limits)
    joint_segments, ranges = [], list[tuple[float, float, MotionLimits]]()
    for segment in segments:
        start, end = (float(s) for s in path.s_waypoints[[segment.first, segment.last]])
        if start < end:
            refuse_moving(robot, path, segment.limits, start, end)
            joint_segments.append(
                SegmentJointLimits(start, end, joint_limits(robot, segment.limits))
            )
            ranges.append((start, end, segment.limits))
    for start, end, own in _runs(ranges):
        constraints += _constraints(robot, own, limits, start, end)
    return path, joint_segments, constraints


def _constraints(
    robot: Robot,
    limits: MotionLimits,
    known: MotionLimits | None = None,
    start: float = 0.0,
    end: float = np.inf,
) -> list[PathConstraint]:
    """Return the limits on the tool and on the torques in a range; not those ``known`` has too."""
    constraints: list[PathConstraint] = []
    rates = (*limits.tool_speed, *limits.tool_acceleration)
    same = known is not None and rates == (*known.tool_speed, *known.tool_acceleration)
    if np.isfinite(rates).any() and not same:
        v, w, dv, dw = (value if np.isfinite(value) else None for value in rates)
        constraints.append(ToolLimits(tool_motion(robot), v, w, dv, dw, start, end))
    tangential = limits.tool_tangential
    if np.isfinite(tangential) and (known is None or tangential < known.tool_tangential):
        constraints.append(TangentialLimit(tool_motion(robot), tangential, start, end))
    if limits.torque is not None and (known is None or _more_torque(limits, known)):
        payload = None
        if limits.payload_mass > 0.0:
            payload = pin.Inertia(limits.payload_mass, limits.payload_position, np.zeros((3, 3)))
        dynamics = inverse_dynamics(robot, payload)
        names = tuple(robot.joint_names)
        constraints.append(TorqueLimits(dynamics, limits.torque, names, start, end))
    return constraints


def _more_torque(limits: MotionLimits, known: MotionLimits) -> bool:
    """Whether limits ask more of the torques than others that hold as well."""
    load = (limits.payload_mass, *limits.payload_position)
    return limits.torque is not known.torque or load != (
        known.payload_mass,
        *known.payload_position,
    )


def report_of(
    timed: TimedPath,
    check: Check,
    *,
    duration: float,
    rate_hz: float,
    widened: bool = True,
    **said: Any,
) -> TimingReport:
    """Say why a motion takes as long as it does.

    Args:
        timed: The motion, before it is slowed to end at a sample.
        check: As for :func:`time_motion`.
        duration: Its duration after that [s].
        rate_hz: Samples per second [Hz].
        widened: Whether to tell what wider limits would bring.
        said: What else the report says.
    """
    found = binding(timed)
    shares = found.summary()
    slow = timed.jerk_limited or any(span.problem.constraints for span in timed.spans)
    most = (_ASKED_OF_SLOW if slow else _ASKED) if widened else 0
    asked = [s for s in shares if s.share >= _LEAST_SHARE][:most]
    wider = what_ifs(timed, [(s.limit, s.joint) for s in asked], _WIDER, check)
    # A motion that ends in time, but for rounding, does so with wider limits too.
    rounded = min(duration / timed.duration, 1.0) if timed.duration > 0.0 else 1.0
    return TimingReport(
        duration=duration,
        unlimited_duration=timed.unlimited_duration if timed.jerk_limited else duration,
        rate_hz=rate_hz,
        **said,
        binding=[BindingLimit(limit=s.limit, joint=s.joint, share=s.share) for s in shares],
        summary=found.sentence(),
        what_if=[
            WiderLimit(
                limit=w.limit,
                joint=w.joint,
                factor=w.factor,
                duration=periods(w.duration * rounded, rate_hz) / rate_hz,
            )
            for w in wider
        ],
    )


def motion_polynomials(timed: TimedPath) -> MotionPolynomials:
    """Return a motion as the document of its polynomials."""
    path = timed.path
    return MotionPolynomials(
        s_knots=path.s_knots,
        q_knots=path.q_knots,
        tangents_start=path.tangents_start,
        tangents_end=path.tangents_end,
        node_time=timed.node_times,
        node_s=timed.s,
        node_sdot=timed.sdot,
        node_sddot=timed.sddot,
        pieces=[] if timed.jerk_limited else [int(p) for p in timed.pieces],
    )
