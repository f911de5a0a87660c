"""Figures of a motion that the tests measure by themselves: Pinocchio, numpy and plain geometry."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ikplan import Robot, load_robot

__all__ = [
    "asked_poses",
    "check_motion",
    "limit_ratios",
    "off_circle",
    "off_polyline",
    "waypoint_errors",
]

Array = NDArray[np.float64]

_ROUNDING = 1e-9


def check_motion(trajectory: Any, robot: Robot, *, ends: Sequence[ArrayLike] = ()) -> None:
    """Hold that samples are one motion from rest to rest within a robot's own limits.

    An acceleration of at most a changes the mean velocity of a step of length t by at most a t / 4
    from the mean of the velocities at its ends.

    Args:
        trajectory: What has ``time``, ``q``, ``dq`` and ``ddq``.
        robot: The robot.
        ends: First and last joint values, where they are known exactly.
    """
    time, q, dq, ddq = (np.asarray(getattr(trajectory, n)) for n in ("time", "q", "dq", "ddq"))
    assert q.shape == dq.shape == ddq.shape == (len(time), robot.dof)
    assert time[0] == 0.0
    dt = np.diff(time)[:, None]
    assert (dt > 0.0).all()
    assert not dq[0].any()
    assert not dq[-1].any()
    for value, row in zip(ends, (0, -1), strict=False):
        np.testing.assert_array_equal(q[row], value)
    assert max(limit_ratios(trajectory, robot)) <= 1.0 + _ROUNDING
    assert ((robot.lower <= q) & (q <= robot.upper)).all()
    a = robot.acceleration_limit * (1.0 + 1e-6)
    assert (np.abs(np.diff(dq, axis=0)) <= a * dt + _ROUNDING).all()
    moved = np.diff(q, axis=0) - 0.5 * (dq[1:] + dq[:-1]) * dt
    assert (np.abs(moved) <= 0.25 * a * dt**2 + _ROUNDING).all()


def limit_ratios(trajectory: Any, robot: Robot) -> tuple[float, float]:
    """Largest share of the robot's velocity and of its acceleration limits on the samples."""
    velocity = np.abs(np.asarray(trajectory.dq)) / robot.velocity_limit
    acceleration = np.abs(np.asarray(trajectory.ddq)) / robot.acceleration_limit
    return float(velocity.max()), float(acceleration.max())


def asked_poses(path: Mapping[str, Any]) -> list[tuple[pin.SE3, bool]]:
    """Pose in the base, and whether its orientation counts, of each waypoint of a path document."""
    frame = _se3(path.get("frame", {}))
    turns = path.get("orientation_free") is None
    return [
        (frame * _se3(waypoint), turns and waypoint.get("quaternion_xyzw") is not None)
        for waypoint in path["waypoints"]
    ]


def _se3(document: Mapping[str, Any]) -> pin.SE3:
    position, quaternion = document.get("position"), document.get("quaternion_xyzw")
    position = [0.0, 0.0, 0.0] if position is None else position
    quaternion = [0.0, 0.0, 0.0, 1.0] if quaternion is None else quaternion
    return pin.XYZQUATToSE3(np.array([*position, *quaternion]))


def waypoint_errors(plan: Any, path: Mapping[str, Any], robot: Robot | None = None) -> Array:
    """Distance [m] and rotation [rad] of each waypoint from the pose asked for, shape (n, 2).

    A rotation that does not count is 0.

    Args:
        plan: The plan.
        path: The path of its request, by waypoints.
        robot: The robot, with its tool; None: that of the catalogue, without one.
    """
    robot = robot or load_robot(plan.robot)
    errors = []
    for q, (want, turns) in zip(plan.waypoints.q, asked_poses(path), strict=True):
        off = want.actInv(robot.fk(q))
        angle = np.linalg.norm(pin.log3(off.rotation)) if turns else 0.0
        errors.append([np.linalg.norm(off.translation), angle])
    return np.array(errors)


def off_polyline(points: Array, corners: ArrayLike) -> Array:
    """Distance of points, shape (m, 3), from the lines joining corners, shape (k, 3) [m]."""
    corners = np.asarray(corners, dtype=np.float64)
    nearest = np.full(len(points), np.inf)
    for a, b in itertools.pairwise(corners):
        d = b - a
        share = np.clip((points - a) @ d / max(float(d @ d), 1e-300), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(points - a - share[:, None] * d, axis=1))
    return nearest


def off_circle(points: Array, centre: ArrayLike, radius: float) -> Array:
    """Distance of points, shape (m, 3), from a circle parallel to the xy plane [m]."""
    off = points - np.asarray(centre)
    distance: Array = np.hypot(np.hypot(off[:, 0], off[:, 1]) - radius, off[:, 2])
    return distance
