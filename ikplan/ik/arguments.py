"""What callers from Python pass to the solvers, checked as the request document is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
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
    """Return the target of a pose in any of its forms; a target as it is.

    Args:
        pose: ``pinocchio.SE3``; a homogeneous matrix, shape (4, 4), or what has one by
            ``as_matrix()``; position and unit quaternion xyzw, shape (7,); a pair of a position and
            a quaternion xyzw, a matrix of shape (3, 3) or a SciPy ``Rotation``; or a position
            alone, shape (3,) [m].

    Raises:
        InvalidRequest: It is none of these, not finite, too far away, or its rotation is none.
    """
    if isinstance(pose, Target):
        return pose
    R_wanted = getattr(pose, "rotation", None)
    try:
        if R_wanted is not None:
            position = pose.translation
        else:
            R_wanted, position = _rotation_and_position(pose)
        oriented = R_wanted is not None
        p = np.array(position, dtype=np.float64)
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


def _rotation_and_position(pose: Any) -> tuple[Any, Any]:
    """Return the rotation matrix (None: a position alone) and the position of a pose."""
    if hasattr(pose, "as_matrix"):
        pose = pose.as_matrix()
    if isinstance(pose, Sequence) and len(pose) == 2:
        position, turn = pose
        return _rotation(turn), position
    values = np.asarray(pose, dtype=np.float64)
    if values.shape == (4, 4):
        if (values[3] != (0.0, 0.0, 0.0, 1.0)).any():
            raise _no_pose()
        return values[:3, :3], values[:3, 3]
    if values.shape == (7,):
        return _rotation(values[3:]), values[:3]
    return None, values


def _rotation(turn: Any) -> Any:
    """Return the matrix of a rotation given as such, as a quaternion xyzw, or by SciPy."""
    if hasattr(turn, "as_matrix"):
        return turn.as_matrix()
    values = np.asarray(turn, dtype=np.float64)
    if values.shape != (4,):
        return values
    norm = math.sqrt(float(values @ values))
    if not abs(norm - 1.0) <= 1e-3:
        raise _no_pose()
    return pin.Quaternion(values / norm).matrix()


def _no_pose() -> InvalidRequest:
    forms = (
        "a pinocchio.SE3, a matrix of shape (4, 4), x y z qx qy qz qw, a pair of a position and a "
        "rotation (quaternion xyzw, matrix or SciPy Rotation), or three finite numbers"
    )
    return InvalidRequest(
        f"pose: must be {forms}, with a proper rotation", field="pose", allowed=forms
    )


def _wrong(field: str, value: Any, wanted: str) -> InvalidRequest:
    return InvalidRequest(f"{field}: must be {wanted}, not {value!r}", field=field, allowed=wanted)
