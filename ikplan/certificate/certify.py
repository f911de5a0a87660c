"""The certificate: an independent check of a finished trajectory.

Everything here is computed from the finished samples, the request and the robot's Pinocchio model.
No kernel, path or timing code of the planner is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.certificate.elongation import elongation_lower_bound
from ikplan.certificate.limits import RATIO_SLACK, further_limits
from ikplan.certificate.offsets import offset
from ikplan.certificate.paths import Followed, TimedSpan, follow_checks
from ikplan.certificate.stretches import LimitWindow, stretch_checks
from ikplan.documents.limits import LimitOptions
from ikplan.errors import CertificateViolated
from ikplan.motion_limits import MotionLimits
from ikplan.request import PathRequest
from ikplan.result import Certificate, LimitPlace
from ikplan.robots import Robot

__all__ = ["Claim", "certify"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Claim:
    """A trajectory and what is promised of it.

    Attributes:
        robot: The robot, with its tool.
        path: The path asked for; None: the waypoints are joint values.
        wanted: Position, shape (3,) [m], and rotation, shape (3, 3), None: any, asked for at each
            waypoint in the base, where the path has segments; plain waypoints are read from it.
        rounded: Waypoints at corners that the path rounds, which it need not meet.
        spans: The tool paths to be followed.
        windows: Limits that hold at times only.
        q_start: Start that was asked for, shape (dof,); None: any.
        waypoint_q: Joint values at the waypoints, shape (n, dof) [rad or m].
        waypoint_time: When each waypoint is passed, shape (n,) [s].
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof) [rad/s or m/s].
        ddq: Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2].
        velocity_scale: Share of the robot's velocity limits that may be used.
        acceleration_scale: Share of the robot's acceleration limits that may be used.
        limits: The limits to keep, which then stand instead of those shares; None: the shares.
    """

    robot: Robot
    path: PathRequest | None
    q_start: Array | None
    waypoint_q: Array
    waypoint_time: Array
    time: Array
    q: Array
    dq: Array
    ddq: Array
    velocity_scale: float = 1.0
    acceleration_scale: float = 1.0
    limits: MotionLimits | None = None
    wanted: tuple[tuple[Array, Any], ...] = ()
    rounded: frozenset[int] = frozenset()
    spans: tuple[TimedSpan, ...] = ()
    windows: tuple[LimitWindow, ...] = ()

    @property
    def promised(self) -> MotionLimits:
        """The limits that were promised."""
        scales = LimitOptions(
            velocity_scale=self.velocity_scale, acceleration_scale=self.acceleration_scale
        )
        return self.limits or MotionLimits.of(self.robot, scales)


def certify(claim: Claim) -> Certificate:
    """Check a trajectory and return its certificate.

    Raises:
        CertificateViolated: A promise is broken; carries the certificate and which.
    """
    robot = claim.robot
    _check_numbers(claim)
    violations = _continuity(claim)
    poses = _wanted_poses(claim)
    errors = _waypoint_errors(claim, poses)
    position_error = max((distance for distance, _ in errors), default=None)
    orientation_error = max((turn for _, turn in errors if turn is not None), default=None)
    followed = Followed()
    if claim.path is not None:
        violations += _misses(claim, errors)
        followed = follow_checks(robot, claim.path, list(claim.spans), claim.time, claim.q)
        violations += _strays(claim.path, followed)
    half = 0.5 * (robot.upper - robot.lower)
    finite = np.isfinite(half)
    middle = np.zeros_like(half)
    middle[finite] = 0.5 * (robot.upper[finite] + robot.lower[finite])
    position = _worst(claim, np.abs(claim.q - middle) / half, finite)
    limits = claim.promised
    velocity = _worst(
        claim, np.maximum(claim.dq / limits.velocity, claim.dq / limits.velocity_lower)
    )
    acceleration = _worst(
        claim, np.maximum(claim.ddq / limits.acceleration, claim.ddq / limits.acceleration_lower)
    )
    for kind, (ratio, place) in (
        ("position", position),
        ("velocity", velocity),
        ("acceleration", acceleration),
    ):
        if ratio > 1.0 + RATIO_SLACK:
            violations.append(
                f"the {kind} limit of {place.joint} is exceeded at {place.time:.4f} s"
            )
    further, exceeded = further_limits(robot, limits, claim.time, claim.q, claim.dq, claim.ddq)
    violations += exceeded
    segments, exceeded = stretch_checks(
        robot, claim.windows, claim.time, claim.q, claim.dq, claim.ddq
    )
    violations += exceeded
    elongation = _elongations(claim)
    singular_value, singular_time = _least_singular_value(claim)
    shortest = float(elongation.sum())
    if claim.path is not None:
        shortest = elongation_lower_bound(robot, claim.q_start, poses, errors)
    certificate = Certificate(
        valid=not violations,
        max_position_error=position_error,
        max_orientation_error=orientation_error,
        max_path_deviation=followed.distance,
        max_path_deviation_time=followed.distance_time,
        max_orientation_deviation=followed.angle,
        max_orientation_deviation_time=followed.angle_time,
        position_limit_ratio=position[0],
        position_limit_at=position[1] if finite.any() else None,
        velocity_limit_ratio=velocity[0],
        velocity_limit_at=velocity[1],
        acceleration_limit_ratio=acceleration[0],
        acceleration_limit_at=acceleration[1],
        **further,
        segments=segments,
        min_singular_value=singular_value,
        min_singular_value_time=singular_time,
        elongation_sum=float(elongation.sum()),
        elongation_lower_bound=shortest,
    )
    if violations:
        raise CertificateViolated(
            f"the finished trajectory broke a promise: {'; '.join(violations)}",
            certificate=certificate.model_dump(),
            violations=violations,
        )
    return certificate


def _elongations(claim: Claim) -> Array:
    """Joint distance of each waypoint from the one before, or the start, shape (n,)."""
    begin = claim.waypoint_q[:1] if claim.q_start is None else claim.q_start[None]
    return np.asarray(np.linalg.norm(np.diff(np.vstack([begin, claim.waypoint_q]), axis=0), axis=1))


def _wanted_poses(claim: Claim) -> list[tuple[Array, Any]]:
    """Position [m] and rotation (None: any) wanted at each waypoint, in the base."""
    if claim.path is None:
        return []
    if claim.path.segments is not None:
        return list(claim.wanted)
    frame = claim.path.frame
    T_base_path = pin.XYZQUATToSE3(np.array([*frame.position, *frame.quaternion_xyzw]))
    poses = []
    for waypoint in claim.path.waypoints or ():
        quaternion = waypoint.quaternion_xyzw
        T = T_base_path * pin.XYZQUATToSE3(
            np.array([*waypoint.position, *(quaternion or (0.0, 0.0, 0.0, 1.0))])
        )
        poses.append((T.translation.copy(), T.rotation.copy() if quaternion else None))
    return poses


def _waypoint_errors(
    claim: Claim, poses: list[tuple[Array, Any]]
) -> list[tuple[float, float | None]]:
    """Distance [m] and rotation (None: any) [rad] of each waypoint from what was asked for."""
    errors: list[tuple[float, float | None]] = []
    for q, (position, rotation) in zip(claim.waypoint_q, poses, strict=bool(poses)):
        if claim.path is not None:
            T = claim.robot.fk(q)
            errors.append(offset(claim.path, T.translation, T.rotation, position, rotation))
    return errors


def _misses(claim: Claim, errors: list[tuple[float, float | None]]) -> list[str]:
    """Which waypoints are missed by more than the tolerance."""
    if claim.path is None:
        return []
    tolerance, missed = claim.path.tolerance, []
    for k, (distance, angle) in enumerate(errors):
        if k in claim.rounded:
            continue
        if distance > tolerance.position:
            missed.append(f"waypoint {k} is missed by {distance:.3g} m")
        if (angle or 0.0) > tolerance.orientation:
            missed.append(f"waypoint {k} is missed by {angle:.3g} rad")
    return missed


def _strays(path: PathRequest, followed: Followed) -> list[str]:
    """Whether the tool leaves its path by more than the tolerance."""
    strays = []
    if (followed.distance or 0.0) > path.tolerance.position:
        strays.append(f"the path is left by {followed.distance:.3g} m")
    if (followed.angle or 0.0) > path.tolerance.orientation:
        strays.append(f"the path is left by {followed.angle:.3g} rad")
    return strays


def _worst(claim: Claim, ratios: Array, counted: Any = None) -> tuple[float, LimitPlace]:
    """The largest ratio with its joint and time."""
    if counted is not None:
        ratios = np.where(counted, ratios, 0.0)
    row, joint = np.unravel_index(int(np.argmax(ratios)), ratios.shape)
    place = LimitPlace(joint=claim.robot.joint_names[joint], time=float(claim.time[row]))
    return float(ratios[row, joint]), place


def _check_numbers(claim: Claim) -> None:
    """Refuse what is not finite before it slips through every comparison.

    Raises:
        CertificateViolated: Names the arrays.
    """
    names = ("waypoint_q", "waypoint_time", "time", "q", "dq", "ddq")
    bad = [name for name in names if not np.isfinite(getattr(claim, name)).all()]
    if bad:
        violation = f"not every number is finite in {', '.join(bad)}"
        raise CertificateViolated(
            f"the finished trajectory broke a promise: {violation}",
            certificate={},
            violations=[violation],
        )


def _continuity(claim: Claim) -> list[str]:
    """What is wrong with the samples as one motion: ends, order of time, jumps.

    A joint whose acceleration never exceeds a moves, in a time t, at most a t^2 / 2 away from
    where its velocity would bring it: a sample or a waypoint farther off is a hidden jump.
    """
    wrong = []
    steps, end = np.diff(claim.time), claim.time[-1]
    if claim.time[0] != 0.0 or (steps <= 0.0).any():
        wrong.append("sample times do not increase strictly from 0")
    if claim.dq[0].any() or claim.dq[-1].any():
        wrong.append("the motion does not begin and end at rest")
    if claim.q_start is not None and not np.array_equal(claim.q[0], claim.q_start):
        wrong.append("the first sample is not the start asked for")
    if not np.array_equal(claim.q[-1], claim.waypoint_q[-1]):
        wrong.append("the last sample is not the last waypoint")
    limits = claim.promised
    a = np.maximum(limits.acceleration, -limits.acceleration_lower) * (1.0 + 1e-6)
    rounding = 1e-9
    dt = steps[:, None]
    if (np.abs(np.diff(claim.dq, axis=0)) > a * dt + rounding).any():
        wrong.append("velocities jump between samples")
    if (np.abs(np.diff(claim.q, axis=0) - claim.dq[:-1] * dt) > 0.5 * a * dt**2 + rounding).any():
        wrong.append("positions jump between samples")
    passed = claim.waypoint_time
    if (np.diff(passed) < 0.0).any() or passed[0] < 0.0 or abs(passed[-1] - end) > 1e-9 * end:
        wrong.append("waypoint times do not increase to the end of the motion")
    # Seen from the sample before and from the sample after.
    at = np.clip(np.searchsorted(claim.time, passed, side="right") - 1, 0, None)
    for k in (at, np.minimum(at + 1, len(claim.time) - 1)):
        away = (passed - claim.time[k])[:, None]
        reached = np.abs(claim.waypoint_q - claim.q[k] - claim.dq[k] * away)
        if (reached > 0.5 * a * away**2 + rounding).any():
            wrong.append("a waypoint is not passed at its time")
            break
    return wrong


def _least_singular_value(claim: Claim) -> tuple[float, float]:
    """Smallest singular value of the tool Jacobian over the samples, and its time [s].

    Examined on 128 samples spread evenly, then on every sample around the smallest of them. Rows
    are the tool's linear and angular velocity, or the linear alone where no orientation counts.
    """
    oriented = claim.path is None or any(w.quaternion_xyzw for w in claim.path.waypoints or ())
    rows = slice(0, 6 if oriented and claim.robot.dof >= 6 else 3)
    count = len(claim.time)
    stride = max(1, count // 128)

    def values(indices: list[int]) -> Array:
        J = claim.robot.jacobians(claim.q[indices])[:, rows]
        gram = J @ J.transpose(0, 2, 1) if J.shape[1] <= J.shape[2] else J.transpose(0, 2, 1) @ J
        return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(gram)[:, 0], 0.0)))

    coarse = [*range(0, count, stride), count - 1]
    centre = coarse[int(np.argmin(values(coarse)))]
    fine = list(range(max(0, centre - stride), min(count, centre + stride + 1)))
    found = values(fine)
    k = int(np.argmin(found))
    return float(found[k]), float(claim.time[fine[k]])
