"""What callers from Python pass to the solvers, checked as the request document is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.documents import MAX_NUMBER
from ikplan.errors import InvalidRequest
from ikplan.kinematics.bounds import clip_inside
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Target, no_freedom, pose_defect

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["check_objective", "check_options", "check_start", "check_tolerances", "target_of"]

OBJECTIVES = ("motion", "clearance")


def check_options(
    method: Any, seed: Any, population: Any, iterations: Any, params: Mapping[str, Any]
) -> None:
    """Refuse a method, seed, budget or parameter that a request document could not hold.

    Raises:
        InvalidRequest: Names the option and what is allowed.
    """
    if not isinstance(method, str):
        raise _wrong("ik.method", method, "the name of a solver")
    if not (isinstance(seed, int | np.integer) and 0 <= seed < 2**63):
        raise _wrong("ik.seed", seed, "a whole number from 0, below 2**63")
    for field, budget in (("ik.population", population), ("ik.iterations", iterations)):
        counts = isinstance(budget, int) and not isinstance(budget, bool) and budget >= 1
        if not (budget is None or budget == "paper" or counts):
            raise _wrong(field, budget, 'a whole number from 1, "paper" or null')
    if not isinstance(params, Mapping):
        raise _wrong("ik.params", params, "a mapping from names to values")
    for name, value in params.items():
        if not isinstance(value, bool | int | float | str | np.integer):
            raise _wrong(f"ik.params.{name}", value, "a number, a string, true or false")


def check_objective(objective: Any) -> None:
    """Refuse an objective that a request document could not hold.

    Raises:
        InvalidRequest: Names what is allowed.
    """
    if objective not in OBJECTIVES:
        raise InvalidRequest(
            f"ik.objective: must be one of {', '.join(OBJECTIVES)}, not {objective!r}",
            field="ik.objective",
            allowed=list(OBJECTIVES),
        )


def check_tolerances(position: float, orientation: float) -> None:
    """Refuse tolerances that nothing, or anything, could meet.

    Raises:
        InvalidRequest: Names the tolerance.
    """
    for field, tolerance in (
        ("tolerance.position", position),
        ("tolerance.orientation", orientation),
    ):
        if not 0.0 < tolerance < math.inf:
            raise _wrong(field, tolerance, "a finite number above 0")


def check_start(robot: Robot, start: ArrayLike, field: str = "start") -> Array:
    """Return a start configuration as an array of shape (dof,).

    Raises:
        InvalidRequest: Wrong number of joints, not finite, or outside the position limits.
    """
    try:
        q = np.array(start, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(
            f"{field}: must be {robot.dof} numbers", field=field, allowed=f"{robot.dof} numbers"
        ) from error
    if q.shape != (robot.dof,):
        raise InvalidRequest(
            f"{field}: {robot.name} has {robot.dof} joints ({', '.join(robot.joint_names)}), "
            f"got {q.size} values",
            field=field,
            allowed=f"{robot.dof} numbers",
        )
    k = clip_inside(q, robot.lower, robot.upper, 1e-9, MAX_NUMBER)
    if k >= 0:
        raise InvalidRequest(
            f"{field}[{k}]: joint {robot.joint_names[k]} is at {q[k]:.6g}, outside its limits "
            f"{robot.lower[k]:.6g} to {robot.upper[k]:.6g}",
            field=f"{field}[{k}]",
            allowed=[
                max(float(robot.lower[k]), -MAX_NUMBER),
                min(float(robot.upper[k]), MAX_NUMBER),
            ],
        )
    return q


_NO_FREEDOM = no_freedom()
_ANY_ROTATION = np.eye(3)
_ANY_ROTATION.setflags(write=False)


def target_of(pose: Any) -> Target:
    """Return the target of a ``pinocchio.SE3`` or a position, shape (3,) [m]; a target as it is.

    Raises:
        InvalidRequest: It is neither, not finite, too far away, or its rotation is none.
    """
    if isinstance(pose, Target):
        return pose
    R_wanted = getattr(pose, "rotation", None)
    oriented = R_wanted is not None
    try:
        p = np.array(pose.translation if oriented else pose, dtype=np.float64)
        R = np.array(R_wanted if oriented else _ANY_ROTATION, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise _no_pose() from error
    if p.shape != (3,) or R.shape != (3, 3):
        raise _no_pose()
    defect = pose_defect(R, p)
    if defect > 1e-3:
        raise _no_pose()
    if defect > 1e-13:
        # The nearest rotation: an error of the matrix would count as an error of the solution.
        U, _, Vt = np.linalg.svd(R)
        R = np.ascontiguousarray(U @ Vt)
    return Target(R, p, oriented, ORIENTATION_WEIGHT if oriented else 0.0, _NO_FREEDOM)


def _no_pose() -> InvalidRequest:
    return InvalidRequest(
        "pose: must be a pinocchio.SE3 with a proper rotation, or three finite numbers",
        field="pose",
        allowed="pinocchio.SE3 or position of shape (3,)",
    )


def _wrong(field: str, value: Any, wanted: str) -> InvalidRequest:
    return InvalidRequest(f"{field}: must be {wanted}, not {value!r}", field=field, allowed=wanted)
