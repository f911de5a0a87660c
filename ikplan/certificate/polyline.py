"""How far a timed motion is from the polyline through the joint waypoints of its request."""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.arrays import Array, Indices, lengths_of
from ikplan.certificate.claim import Claim
from ikplan.documents.certificate import LimitPlace
from ikplan.documents.poses import Tolerance

__all__ = ["polyline_deviation"]


_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
_SEARCHES = 60
_SLACK = 1.0 + 1e-9
_ROUNDING = 1e-12
"""What joint values may be off by rounding [rad or m]."""


def polyline_deviation(claim: Claim, asked: Array) -> tuple[dict[str, Any], list[str]]:
    """Hold every sample to the legs about it, and the waypoints to those asked for.

    A sample between two waypoints is held to the leg between them or one of its neighbours,
    whichever is nearer in the joint that is farthest off, as a share of its tolerance.

    Args:
        claim: The trajectory.
        asked: The joint waypoints asked for, shape (n, dof), n >= 1 [rad or m].

    Returns:
        Fields of the certificate, and what is farther off than the tolerance, in words.
    """
    tolerance = claim.joint_tolerance
    weight = np.ones(asked.shape[1])
    if tolerance is not None and not isinstance(tolerance, Tolerance):
        weight = np.broadcast_to(np.array(tolerance), weight.shape)
    nearest = np.repeat(asked[:1], len(claim.q), axis=0)
    if len(asked) > 1:
        nearest = _nearest(claim, asked, weight)
    off = np.abs(claim.q - nearest)
    row, joint = np.unravel_index(int(np.argmax(off)), off.shape)
    R, p = claim.robot.poses(claim.q)
    R_line, p_line = claim.robot.poses(nearest)
    distance, angle = lengths_of(p - p_line), _angles(R, R_line)
    found = {
        "max_joint_deviation": float(off[row, joint]),
        "max_joint_deviation_at": LimitPlace(
            joint=claim.robot.joint_names[joint], time=float(claim.time[row])
        ),
        "max_path_deviation": float(distance.max()),
        "max_path_deviation_time": float(claim.time[np.argmax(distance)]),
        "max_orientation_deviation": float(angle.max()),
        "max_orientation_deviation_time": float(claim.time[np.argmax(angle)]),
    }
    if tolerance is None:
        return found, []
    wrong = []
    if len(claim.waypoint_q) != len(asked):
        return found, [f"{len(asked)} waypoints are asked for, not {len(claim.waypoint_q)}"]
    if isinstance(tolerance, Tolerance):
        R, p = claim.robot.poses(claim.waypoint_q)
        R_asked, p_asked = claim.robot.poses(asked)
        distance = np.append(distance, lengths_of(p - p_asked))
        angle = np.append(angle, _angles(R, R_asked))
        if distance.max() > tolerance.position * _SLACK:
            wrong.append(f"the tool leaves the polyline by {distance.max():.3g} m")
        if angle.max() > tolerance.orientation * _SLACK:
            wrong.append(f"the tool leaves the polyline by {angle.max():.3g} rad")
        return found, wrong
    most = weight * _SLACK + _ROUNDING
    if (off > most).any():
        wrong.append(f"the polyline of the waypoints is left by {off[row, joint]:.3g}")
    missed = np.abs(claim.waypoint_q - asked)
    for k in np.flatnonzero((missed > most).any(axis=1))[:3]:
        wrong.append(f"waypoint {k} is missed by {missed[k].max():.3g}")
    return found, wrong


def _nearest(claim: Claim, asked: Array, weight: Array) -> Array:
    """The place of the polyline that each sample is held to, shape (m, dof)."""
    leg = np.searchsorted(claim.waypoint_time, claim.time, "right") - 1
    best = np.full(len(claim.q), np.inf)
    nearest = np.empty_like(claim.q)
    for shift in (0, -1, 1):
        here = np.clip(leg + shift, 0, len(asked) - 2)
        share, far = _on_legs(claim.q / weight, asked / weight, here)
        better = far < best
        best[better] = far[better]
        place = asked[here] + share[:, None] * (asked[here + 1] - asked[here])
        nearest[better] = place[better]
    return nearest


def _on_legs(q: Array, rows: Array, leg: Indices) -> tuple[Array, Array]:
    """Shares of legs at which the joint farthest off is nearest, by golden sections."""
    a, b = rows[leg], rows[leg + 1]

    def far(share: Array) -> Array:
        return np.asarray(np.abs(q - a - share[:, None] * (b - a)).max(axis=1))

    low, high = np.zeros(len(q)), np.ones(len(q))
    for _ in range(_SEARCHES):
        first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        ahead = far(first) > far(second)
        low, high = np.where(ahead, first, low), np.where(ahead, high, second)
    shares = np.stack([0.5 * (low + high), np.zeros(len(q)), np.ones(len(q))])
    distances = np.stack([far(share) for share in shares])
    best = np.argmin(distances, axis=0)
    at = np.arange(len(q))
    return shares[best, at], distances[best, at]


def _angles(R: Array, S: Array) -> Array:
    """Angles between rotations, shape (m,) [rad]."""
    chord = np.sqrt(((R - S) ** 2).sum(axis=(1, 2)) / 8.0)
    return np.asarray(2.0 * np.arcsin(np.minimum(chord, 1.0)))
