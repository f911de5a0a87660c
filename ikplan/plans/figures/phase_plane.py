"""The phase plane of a trajectory: its speed along the joint path, and what limits allow there."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.limits.motion_limits import MotionLimits

__all__ = ["path_speed", "path_speed_bound"]


# Below this share of the highest speed, the direction and bend of a path cannot be told from the
# velocities and accelerations of the motion along it.
_SLOW = 1e-3


def path_speed(time: Array, q: Array, dq: Array) -> tuple[Array, Array]:
    """Way made along the joint path and speed, by the 2-norm of the joints.

    Args:
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).

    Returns:
        Lengths and speeds, each of shape (m,).
    """
    speed = np.linalg.norm(dq, axis=1)
    # The chords are shorter than the path; the mean speeds are not.
    chords = np.linalg.norm(np.diff(q, axis=0), axis=1)
    steps = np.maximum(chords, 0.5 * (speed[1:] + speed[:-1]) * np.diff(time))
    return np.concatenate([[0.0], np.cumsum(steps)]), speed


def path_speed_bound(dq: Array, ddq: Array, limits: MotionLimits) -> Array:
    """Highest speed along the path at which some path acceleration keeps the joint limits.

    With e the direction of the path and k its curvature vector (ddq = e u + k v^2), velocities
    allow v <= max(dq_j) / e_j, and accelerations, for every pair of joints, the speeds at which
    the ranges of u that both allow overlap (the maximum velocity curve of Bobrow, Dubowsky and
    Gibson, 1985).

    Args:
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).
        limits: The limits of joint velocities and accelerations.

    Returns:
        Speeds, shape (m,); nan where the motion is too slow to tell the path.
    """
    speed = np.linalg.norm(dq, axis=1)
    bound = np.full(len(dq), np.nan)
    moving = speed > _SLOW * speed.max(initial=0.0)
    if not moving.any():
        return bound
    v = speed[moving, None]
    e = dq[moving] / v
    k = (ddq[moving] - e * np.sum(e * ddq[moving], axis=1, keepdims=True)) / v**2
    a_up, a_down = limits.acceleration, -limits.acceleration_lower
    with np.errstate(divide="ignore", invalid="ignore"):
        of_velocity = np.where(e > 0.0, limits.velocity / e, limits.velocity_lower / e)
        # e_j u + k_j x lies in [-a_down, a_up]: u between two lines over x = v^2.
        forward = e > 0.0
        highest = np.where(forward, a_up, a_down) / np.abs(e)
        lowest = np.where(forward, a_down, a_up) / np.abs(e)
        slope = k / e
        room = highest[:, :, None] + lowest[:, None, :]
        drift = slope[:, :, None] - slope[:, None, :]
        pairs = np.where(drift > 0.0, room / drift, np.inf)
    of_velocity[e == 0.0] = np.inf
    # A joint that stands still bounds by its bend alone, as pairs with it cannot.
    alone = np.where(e == 0.0, np.where(k > 0.0, a_up, a_down) / np.maximum(np.abs(k), 1e-300),
                     np.inf)  # fmt: skip
    usable = np.isfinite(pairs)
    x = np.minimum(np.where(usable, pairs, np.inf).min(axis=(1, 2)), alone.min(axis=1))
    bound[moving] = np.minimum(of_velocity.min(axis=1), np.sqrt(x))
    return bound
