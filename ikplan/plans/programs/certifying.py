"""The check of a program: its motion, as the controller makes it, beside the plan's.

Largest speeds and accelerations are exact, those of the polynomials. Distances are looked at each
2 ms at least; what they may be between two looks is bounded by their second differences and added.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from ikplan.arrays import Array
from ikplan.plans.playback import evaluate
from ikplan.plans.programs.certificate import ProgramCertificate, ProgramInterpolation
from ikplan.plans.programs.interpolation import interpolate
from ikplan.plans.programs.reference import LEVER, lags, looks

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot
from ikplan.robots.definition.assumptions import is_assumed

__all__ = ["Distances", "certify", "distances", "limits_of"]

_ROUNDS = 5


def limits_of(plan: PlanDocument, robot: Robot) -> tuple[Array, Array]:
    """Return the joint limits that a plan was made for, shape (dof,) each.

    The robot's, and where the request scales them, scaled so too: by the plan's own share of the
    robot's limits over the share of its own limits that its certificate names. Only accelerations
    that are a default of the robot may have been exceeded at the request's wish.
    """
    said = robot.description.assumptions
    assumed = [is_assumed(said, "acceleration", name) for name in robot.joint_names]
    firm = [False] * robot.dof
    found = []
    for rate, limit, ratio, free in (
        (plan.dq, robot.velocity_limit, plan.certificate.velocity_limit_ratio, firm),
        (plan.ddq, robot.acceleration_limit, plan.certificate.acceleration_limit_ratio, assumed),
    ):
        share = float((np.abs(rate) / limit).max())
        scale = share / ratio if ratio > 0.0 and share > 0.0 else 1.0
        found.append(np.asarray(limit * np.where(free, scale, min(scale, 1.0))))
    return found[0], found[1]


def certify(
    plan: PlanDocument,
    robot: Robot,
    kind: ProgramInterpolation,
    passed: Array,
    due: Array,
    points: Array,
    tolerance: float,
) -> ProgramCertificate:
    """Measure a program against its plan.

    Args:
        plan: The plan.
        robot: Its robot.
        kind: What the controller does between points.
        passed: When the plan is at each point, shape (n,) [s].
        due: When the program is, shape (n,) [s].
        points: The points as the program has them, shape (n, dof) [rad or m].
        tolerance: The tolerance that the program was made for [m].
    """
    motion = interpolate(kind, due, points)
    time = looks(float(due[-1]))
    played = motion.at(time)
    off = distances(plan, robot, played, np.interp(time, due, passed))
    speeds, accelerations = motion.peaks()
    velocity_limit, acceleration_limit = limits_of(plan, robot)
    return ProgramCertificate(
        interpolation=kind,
        points=len(due),
        duration=float(due[-1]),
        time_factor=max(float(due[-1]) / plan.duration, 1.0),
        tolerance=tolerance,
        max_path_deviation=off.path,
        max_orientation_deviation=off.orientation,
        max_joint_deviation=off.joints,
        max_time_shift=off.shift,
        velocity_limit_ratio=float((speeds / velocity_limit).max()),
        acceleration_limit_ratio=float((accelerations / acceleration_limit).max()),
    )


@dataclass(frozen=True)
class Distances:
    """How far a motion is from a plan.

    Attributes:
        path: Largest distance of the tool from the plan's path [m].
        orientation: Largest rotation from the plan's, where it is nearest [rad].
        joints: Largest distance of a joint there [rad or m].
        shift: How early or late a place of the path is passed at most [s].
    """

    path: float
    orientation: float
    joints: float
    shift: float


def distances(plan: PlanDocument, robot: Robot, played: Array, expected: Array) -> Distances:
    """Measure a motion against a plan.

    Args:
        plan: The plan.
        robot: Its robot.
        played: Joint values of the motion at even times, shape (m, dof) [rad or m].
        expected: When the plan is expected there, shape (m,) [s].
    """
    poses = robot.poses(played)
    at = expected
    best = np.full(len(at), np.inf)
    error, joints, shift = np.zeros((len(at), 6)), np.zeros(len(at)), np.zeros(len(at))
    # Wherever it is looked for, the distance from a place of the path bounds that from the path.
    for _ in range(_ROUNDS):
        q, dq, _acceleration = evaluate(plan, at)
        found = _error(*robot.poses(q), *poses)
        size = np.square(found[:, :3]).sum(axis=1) + np.square(LEVER * found[:, 3:]).sum(axis=1)
        nearer = size < best
        best = np.where(nearer, size, best)
        error[nearer] = found[nearer]
        joints[nearer] = np.abs(played - q).max(axis=1)[nearer]
        shift[nearer] = np.abs(at - expected)[nearer]
        twist = np.einsum("mij,mj->mi", robot.jacobians(q), dq)
        at = np.clip(at + lags(found, twist), 0.0, plan.duration)
    return Distances(
        _bounded(np.linalg.norm(error[:, :3], axis=1)),
        _bounded(np.linalg.norm(error[:, 3:], axis=1)),
        _bounded(joints),
        float(shift.max()),
    )


def _error(R0: Array, p0: Array, R: Array, p: Array) -> Array:
    """Twists in the first frames that lead to the second ones, shape (m, 6) [m, rad]."""
    relative = np.einsum("mji,mjk->mik", R0, R)
    turned = Rotation.from_matrix(relative).as_rotvec()
    moved = np.einsum("mji,mj->mi", R0, p - p0)
    return np.hstack([moved, turned])


def _bounded(values: Array) -> float:
    """The largest of values at even times, and what a parabola between them may add."""
    bend = np.abs(np.diff(values, 2)).max(initial=0.0) / 8.0
    return float(values.max() + bend)
