"""The posture that a request prefers: read against the robot, planned for, and reported."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.poses import Posture, PostureReport
from ikplan.documents.segment import JointSegment, JointTarget, MoveSegment
from ikplan.errors import InvalidRequest
from ikplan.ik.arguments import check_start
from ikplan.planning.ladder.motion_cost import MotionCost, plain_cost
from ikplan.robots import Robot

__all__ = [
    "motion_cost",
    "preferred_configuration",
    "report_posture",
    "softened",
    "within_soft_limits",
]

_KEPT = 1e-9
"""How far past a soft limit rounding may bring a sample [rad or m]."""


def motion_cost(robot: Robot, posture: Posture | None) -> MotionCost:
    """Return what motions cost under the posture that a request prefers.

    Raises:
        InvalidRequest: A list of the posture does not have one value a joint, the preferred
            configuration is outside the position limits, or a soft range has no inside.
    """
    cost = plain_cost(robot.dof)
    if posture is None:
        return cost
    if posture.weights is not None:
        cost = cost._replace(weights=_values(robot, posture.weights, "weights"))
    lower, upper = soft_limits(robot, posture)
    if posture.q is not None:
        lower = upper = check_start(robot, posture.q, "ik.posture.q")
    if np.isfinite(lower).any() or np.isfinite(upper).any():
        cost = cost._replace(lower=lower, upper=upper, pull=posture.pull)
    return cost


def preferred_configuration(robot: Robot, posture: Posture | None) -> Array:
    """Return where a motion from a free start would rather be, shape (dof,) [rad or m]."""
    if posture is not None and posture.q is not None:
        return check_start(robot, posture.q, "ik.posture.q")
    home = check_start(robot, robot.home)
    if posture is None:
        return home
    lower, upper = soft_limits(robot, posture)
    return np.clip(home, np.maximum(lower, robot.lower), np.minimum(upper, robot.upper))


def soft_limits(robot: Robot, posture: Posture) -> tuple[Array, Array]:
    """Return the soft limits, shape (dof,) each, infinite where there are none [rad or m].

    Raises:
        InvalidRequest: They do not have one value a joint, or a range has no inside.
    """
    lower, upper = np.full(robot.dof, -np.inf), np.full(robot.dof, np.inf)
    if posture.lower is not None:
        lower = _values(robot, posture.lower, "lower")
    if posture.upper is not None:
        upper = _values(robot, posture.upper, "upper")
    inside = np.minimum(upper, robot.upper) - np.maximum(lower, robot.lower)
    for k in np.flatnonzero(~(inside > 0.0)):
        raise InvalidRequest(
            f"ik.posture: the soft limits of {robot.joint_names[k]} have no inside within its "
            f"limits {robot.lower[k]:.6g} to {robot.upper[k]:.6g}",
            field="ik.posture.lower" if posture.lower is not None else "ik.posture.upper",
            allowed=[float(robot.lower[k]), float(robot.upper[k])],
        )
    return lower, upper


def softened(robot: Robot, request: PlanRequest) -> Robot | None:
    """Return the robot within the soft limits of a request, or None where there are none.

    Joint values that the request gives are inside; a joint without limits has no soft ones.
    """
    posture = request.ik.posture
    if posture is None or (posture.lower is None and posture.upper is None):
        return None
    return within_soft_limits(robot, posture, _given_values(robot, request))


def within_soft_limits(robot: Robot, posture: Posture, given: Sequence[Array] = ()) -> Robot:
    """Return the robot within the soft limits of a posture, widened to hold given values.

    Args:
        robot: The robot.
        posture: The posture.
        given: Configurations that count as inside, shape (dof,) each [rad or m].

    Raises:
        InvalidRequest: The soft limits do not have one value a joint, or a range has no inside.
    """
    lower, upper = soft_limits(robot, posture)
    for q in given:
        lower, upper = np.minimum(lower, q), np.maximum(upper, q)
    specs = tuple(
        joint
        if joint.kind == "continuous"
        else replace(joint, lower=max(joint.lower, float(low)), upper=min(joint.upper, float(high)))
        for joint, low, high in zip(robot.description.joints, lower, upper, strict=True)
    )
    return Robot(replace(robot.description, joints=specs))


def _given_values(robot: Robot, request: PlanRequest) -> list[Array]:
    """Configurations that a request gives: its start, and ends of joint motions and moves.

    Raises:
        InvalidRequest: One of them has the wrong length, or is outside the position limits.
    """
    given = []
    if request.start != "free":
        start = robot.home if request.start is None else request.start
        given.append(check_start(robot, start))
    for k, segment in enumerate(request.path.segments or ()):
        if not isinstance(segment, JointSegment | MoveSegment):
            continue
        field = f"path.segments[{k}]"
        if segment.q is not None:
            given.append(check_start(robot, segment.q, f"{field}.q"))
        targets = (segment.any or ()) if isinstance(segment, MoveSegment) else ()
        for n, target in enumerate(targets):
            if isinstance(target, JointTarget):
                given.append(check_start(robot, target.q, f"{field}.any[{n}].q"))
    return given


def report_posture(robot: Robot, posture: Posture | None, q: Array) -> PostureReport | None:
    """Return how far samples, shape (m, dof), keep to a posture; None: none is preferred."""
    if posture is None:
        return None
    distance = None
    if posture.q is not None:
        weights = motion_cost(robot, posture).weights
        distance = float(lengths_of(weights * (q - np.array(posture.q))).mean())
    lower, upper = soft_limits(robot, posture)
    past = np.maximum(lower - q, q - upper).max(axis=0)
    given = posture.lower is not None or posture.upper is not None
    return PostureReport(
        mean_distance=distance,
        soft_limits_kept=bool((past <= _KEPT).all()) if given else None,
        outside={robot.joint_names[k]: float(past[k]) for k in np.flatnonzero(past > _KEPT)},
    )


def _values(robot: Robot, values: list[float], name: str) -> Array:
    field = f"ik.posture.{name}"
    if len(values) != robot.dof:
        raise InvalidRequest(
            f"{field}: {robot.name} has {robot.dof} joints ({', '.join(robot.joint_names)}), "
            f"got {len(values)} values",
            field=field,
            allowed=f"{robot.dof} numbers",
        )
    return np.array(values, dtype=np.float64)
