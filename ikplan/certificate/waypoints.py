"""Whether a motion meets the waypoints of its request."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import Tool
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedWaypoint

__all__ = ["Misses", "met_waypoints", "missed_waypoints", "waypoint_misses"]


_ROUNDING = 1e-9
"""What joint values asked for may be missed by through rounding [rad or m]."""


@dataclass(frozen=True, eq=False)
class Misses:
    """How far outside what is allowed the tool is at the waypoints.

    Attributes:
        distance: Distances, shape (n,) [m].
        angle: Angles, shape (n,) [rad]; 0 where no orientation is asked for.
        oriented: Whether an orientation is asked for, shape (n,).
        joints: Largest difference from joint values asked for, shape (n,) [rad or m]; 0: none are.
    """

    distance: Array
    angle: Array
    oriented: Flags
    joints: Array


def met_waypoints(
    claim: Claim, waypoints: Sequence[RequestedWaypoint], allowance: Allowance, tool: Tool
) -> tuple[RequestedWaypoint, ...]:
    """Return the waypoints, of each that has others the one that a trajectory misses least.

    Args:
        claim: The trajectory.
        waypoints: The waypoints of the request, one a row of ``claim.waypoint_q``.
        allowance: What is allowed at them.
        tool: Poses of the tool.
    """
    found = list(waypoints)
    for row, waypoint in enumerate(waypoints):
        if not waypoint.others:
            continue
        choices = (waypoint, *waypoint.others)
        many = len(choices)
        p, R = tool.p_waypoint[row : row + 1], tool.R_waypoint[row : row + 1]
        misses = _measured(
            claim.waypoint_q[row : row + 1].repeat(many, axis=0),
            choices,
            allowance,
            (p.repeat(many, axis=0), R.repeat(many, axis=0)),
        )
        # In the units of what is allowed, so that none hides the other.
        worst = np.maximum(
            np.maximum(misses.distance / allowance.position, misses.angle / allowance.orientation),
            misses.joints / _ROUNDING,
        )
        found[row] = choices[int(np.argmin(worst))]
    return tuple(found)


def waypoint_misses(
    claim: Claim, waypoints: Sequence[RequestedWaypoint], allowance: Allowance, tool: Tool
) -> Misses:
    """Measure the tool at the waypoints against what the request asks for there.

    Args:
        claim: The trajectory.
        waypoints: The waypoints of the request, one a row of ``claim.waypoint_q``.
        allowance: What is allowed at them.
        tool: Poses of the tool.
    """
    return _measured(claim.waypoint_q, waypoints, allowance, (tool.p_waypoint, tool.R_waypoint))


def _measured(
    q: Array,
    waypoints: Sequence[RequestedWaypoint],
    allowance: Allowance,
    poses: tuple[Array, Array],
) -> Misses:
    """Measure configurations and their poses of the tool against a waypoint each."""
    free = np.eye(3)
    oriented = np.array([w.R is not None for w in waypoints]) & (not allowance.positions_only)
    R = np.array([free if w.R is None else w.R for w in waypoints])
    p = np.array([w.p for w in waypoints])
    found = allowance.offsets(*poses, p, R, oriented)
    joints = [
        0.0 if w.q is None else float(np.abs(row - w.q).max())
        for w, row in zip(waypoints, q, strict=True)
    ]
    return Misses(found.distance, found.angle, oriented, np.array(joints))


def missed_waypoints(
    waypoints: Sequence[RequestedWaypoint], allowance: Allowance, misses: Misses
) -> list[str]:
    """Return which waypoints are missed by more than the tolerance, in words.

    A waypoint at a rounded corner is passed within the radius of its corner instead.
    """
    missed = []
    for k, waypoint in enumerate(waypoints):
        distance, angle = float(misses.distance[k]), float(misses.angle[k])
        if distance > allowance.position + waypoint.ball:
            missed.append(f"waypoint {k} is missed by {distance:.3g} m")
        if waypoint.ball == 0.0 and angle > allowance.orientation:
            missed.append(f"waypoint {k} is missed by {angle:.3g} rad")
        if misses.joints[k] > _ROUNDING:
            missed.append(f"the joint values of waypoint {k} are missed by {misses.joints[k]:.3g}")
    return missed
