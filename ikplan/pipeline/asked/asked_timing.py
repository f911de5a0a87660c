"""The timing stage for motions with more asked for than to be fast."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ikplan.documents.limits import SamplingOptions
from ikplan.documents.trajectory import Trajectory
from ikplan.errors import TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits.motion_limits import LimitedSegment, MotionLimits
from ikplan.pipeline.asked.asked_motion import AskedMotion
from ikplan.pipeline.asked.moving_search import MovingSearch
from ikplan.pipeline.timing_stage import (
    Timing,
    joint_limits,
    motion_polynomials,
    prepared,
    report_of,
    sampling_rate,
    time_motion,
)
from ikplan.robots import Robot
from ikplan.timing import PathConstraint, TimedPath, periods, sample_at_nodes, time_joint_path
from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.sampled_lasting import sampled_lasting
from ikplan.timing.sampling import check_rate
from ikplan.timing.unrounded import ROUNDED, ending_at

__all__ = ["time_as_asked", "timed_as_asked"]

_ABOVE = 1.0 + 1e-10
"""By how much a duration that is offered is above the least one."""


def time_as_asked(
    path: JointPath,
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    segments: Sequence[LimitedSegment] = (),
    asked: AskedMotion | None = None,
    check: Check = unlimited,
) -> Timing:
    """Move along a joint path as a request asks for, and sample the motion.

    Args:
        path: The path.
        robot: The robot, with its tool.
        limits: What the motion has to keep.
        sampling: Samples wanted.
        segments: Segments between waypoints of the path with limits of their own.
        asked: What is asked for; None: to be fast.
        check: Is called now and then, and may end the stage by an error of its own.

    Returns:
        The motion.

    Raises:
        InvalidRequest: The motion is too long for the rate, or a joint moves whose limit is 0.
        TimingFailed: No timing under the limits, or none as asked for: then with the nearest.
    """
    if asked is None or asked.plain:
        return time_motion(path, robot, limits, sampling, segments, check)
    knots = [int(path.knot_of_waypoint[index]) for index, _ in asked.dwells]
    if knots:
        path = path.stopping_at(knots)  # type: ignore[arg-type]
    if asked.ends is not None:
        search = MovingSearch(path, robot, limits, segments, asked.bends, check)
        moved = search.found(asked.ends)
        return timed_as_asked(
            moved.motion.lasting,
            moved.motion.duration,
            moved.constraints,
            robot,
            limits,
            sampling,
            asked,
            check,
        )
    path, joint_segments, constraints = prepared(path, robot, limits, segments)
    free = time_joint_path(
        path,
        joint_limits(robot, limits),
        segments=joint_segments,
        constraints=constraints,
        check=check,
    )

    free = _unrounded(free, robot, sampling, asked)

    def lasting(duration: float) -> TimedPath:
        return free.lasting(duration) if free.duration > 0.0 else free

    return timed_as_asked(
        lasting, free.duration, constraints, robot, limits, sampling, asked, check
    )


def _unrounded(
    free: TimedPath, robot: Robot, sampling: SamplingOptions, asked: AskedMotion
) -> TimedPath:
    """Return a motion that is no longer than asked for, or than whole periods, by rounding."""
    rate_hz, _ = sampling_rate(robot, sampling)
    check_rate(rate_hz)
    stands = sum(seconds for _, seconds in asked.dwells)
    wanted = asked.duration
    if wanted is None:
        wanted = periods((free.duration + stands) * (1.0 - ROUNDED), rate_hz) / rate_hz
    return ending_at(free, wanted - stands) or free


def timed_as_asked(
    lasting: Callable[[float], TimedPath],
    least: float,
    constraints: Sequence[PathConstraint],
    robot: Robot,
    limits: MotionLimits,
    sampling: SamplingOptions,
    asked: AskedMotion,
    check: Check,
) -> Timing:
    """Sample a motion that can last as long as asked for, with its dwells, and report on it.

    Args:
        lasting: Returns the motion that takes a given time, without dwells [s].
        least: Its least duration [s].
        constraints: Limits other than those of single joints.
        robot: The robot.
        limits: What the motion has to keep.
        sampling: Samples wanted.
        asked: What is asked for.
        check: Is called now and then, and may end the stage by an error of its own.

    Raises:
        InvalidRequest: The rate is out of range.
        TimingFailed: The motion takes longer than asked for.
    """
    rate_hz, rate_source = sampling_rate(robot, sampling)
    stands = sum(seconds for _, seconds in asked.dwells)

    def with_dwells(duration: float) -> TimedPath:
        timed = lasting(duration - stands)
        at = timed.path.s_waypoints
        return timed.standing([(float(at[index]), seconds) for index, seconds in asked.dwells])

    at_nodes = sampling.form == "knots"
    try:
        timed, samples, least = sampled_lasting(
            with_dwells,
            least + stands,
            rate_hz,
            constraints,
            duration=asked.duration,
            nodes=at_nodes,
            check=check,
        )
    except TimingFailed as error:
        if error.nearest and asked.duration is not None:
            _, _, known = sampled_lasting(
                with_dwells, least + stands, rate_hz, constraints, aligned=False, check=check
            )
            error.nearest = {"limits": {"duration": known * _ABOVE}}
        raise
    shown = sample_at_nodes(timed) if at_nodes else samples
    moving = asked.ends is not None
    return Timing(
        timed=timed,
        samples=samples,
        trajectory=Trajectory(time=shown.time, q=shown.q, dq=shown.dq, ddq=shown.ddq),
        motion=motion_polynomials(timed) if sampling.form == "polynomial" else None,
        report=report_of(
            lasting(least - stands),
            check,
            duration=timed.duration,
            rate_hz=rate_hz,
            widened=not moving and asked.duration is None,
            rate_source=rate_source,
            grid_factor=timed.duration / least if least > 0.0 else 1.0,
            jerk_source=limits.jerk_source,
            zero_end_acceleration=not samples.ddq[[0, -1]].any(),
        ),
    )
