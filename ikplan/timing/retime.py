"""Retiming: joint waypoints in, a timed and sampled trajectory out, without planning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikplan.errors import InvalidRequest
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits
from ikplan.timing.constraints.constraints import PathConstraint
from ikplan.timing.profile import SegmentJointLimits
from ikplan.timing.sampling import Samples, check_rate, on_grid, sample
from ikplan.timing.time_joint_path import time_joint_path
from ikplan.timing.timed_path import TimedPath

__all__ = ["Retimed", "retime"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Retimed:
    """A joint trajectory through given waypoints.

    Attributes:
        timed: The motion, which can be evaluated at any time.
        samples: The motion at the controller's period.
    """

    timed: TimedPath
    samples: Samples

    @property
    def time(self) -> Array:
        """Times of the samples [s], shape (m,), strictly increasing from 0."""
        return self.samples.time

    @property
    def q(self) -> Array:
        """Joint positions, shape (m, dof) [rad or m]."""
        return self.samples.q

    @property
    def dq(self) -> Array:
        """Joint velocities, shape (m, dof) [rad/s or m/s]."""
        return self.samples.dq

    @property
    def ddq(self) -> Array:
        """Joint accelerations, shape (m, dof) [rad/s^2 or m/s^2]."""
        return self.samples.ddq


def retime(
    joint_waypoints: ArrayLike,
    limits: JointLimits,
    *,
    rate_hz: float = 250.0,
    rest_at: Sequence[int] = (),
    segments: Sequence[SegmentJointLimits] = (),
    constraints: Sequence[PathConstraint] = (),
) -> Retimed:
    """Lay a joint spline through waypoints and move along it as fast as the limits allow.

    Args:
        joint_waypoints: Joint positions, shape (n, dof), n >= 1 [rad or m].
        limits: Joint limits.
        rate_hz: Samples per second [Hz].
        rest_at: Indices of waypoints where the motion stops and the path may have a corner.
        segments: Joint limits of ranges of the path; the strictest holds.
        constraints: Limits other than those of single joints: of the tool, of torques.

    Returns:
        The trajectory, from rest to rest.

    Raises:
        InvalidRequest: The waypoints have the wrong shape, are not finite or leave the position
            limits (names the row and the joint), or the rate is out of range.
        TimingFailed: No timing was found.
    """
    check_rate(rate_hz)
    try:
        q = np.array(joint_waypoints, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(
            f"joint_waypoints must be rows of {limits.dof} numbers each: {error}",
            field="joint_waypoints",
            allowed=f"rows of {limits.dof} numbers",
        ) from error
    limits.check_positions(q, "joint_waypoints")
    path = JointPath.through(q, limits, rest_at=rest_at)
    timed = time_joint_path(path, limits, segments=segments, constraints=constraints)
    timed = on_grid(timed, rate_hz)
    return Retimed(timed, sample(timed, rate_hz))
