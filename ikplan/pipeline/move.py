"""move(): one joint motion around what is in the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ikplan.documents.scene import Scene
from ikplan.errors import InvalidRequest
from ikplan.pipeline.plan import plan
from ikplan.plans.plan import Plan
from ikplan.robots import Robot, catalogue_robot
from ikplan.time_budget import Progress

__all__ = ["move"]


def move(
    robot: str | Robot,
    start: ArrayLike | None,
    goal: ArrayLike | pin.SE3 | Mapping[str, Any] | Sequence[Any],
    scene: Mapping[str, Any] | Scene | None = None,
    *,
    fixed_joints: Mapping[str, float] | None = None,
    limits: Mapping[str, Any] | None = None,
    sampling: Mapping[str, Any] | None = None,
    effort: int | None = None,
    seed: int = 0,
    budget_s: float = 10.0,
    progress: Progress | None = None,
) -> Plan:
    """Move from one configuration to another around what is in the way.

    The way is straight in joint space where that is free of contact. Else it is searched for,
    shortened, rounded and timed, and the timed motion is proven to be free.

    Args:
        robot: The robot, with its tool, or its name.
        start: Joint values, shape (dof,) [rad or m]; None: the robot's home.
        goal: Joint values, shape (dof,) [rad or m]; or a pose of the tool in the base, as an SE3
            [m] or as ``{"position": [...], "quaternion_xyzw": [...]}``, which any configuration
            may meet; or a list of these, of which the one with the shortest way found is gone to.
        scene: What stands around the arm, as in a request; None: nothing, and the arm is kept
            clear of itself.
        fixed_joints: Values of joints beside the chain [rad or m].
        limits: Limits of the motion, as in a request.
        sampling: Samples of the trajectory, as in a request.
        effort: Samples drawn at most in the search; None: 20,000.
        seed: Seed of the search.
        budget_s: Time budget [s].
        progress: As in :func:`ikplan.plan`.

    Returns:
        The plan; ``.stats.moves[0]`` says how much shortening gained.

    Raises:
        InvalidRequest: An argument is wrong.
        RobotNotFound: No robot of that name.
        Unreachable: No configuration meets the pose.
        InCollision: The start or every goal is in contact, or no way was found within the effort,
            which does not prove that there is none: ``.proven`` tells which.
        TimingFailed: No timing under the limits.
        BudgetExceeded: ``budget_s`` ran out.
        CertificateViolated: The finished plan broke a promise: a bug.
    """
    robot = catalogue_robot(robot) if isinstance(robot, str) else robot
    document: dict[str, Any] = {
        "robot": robot.name or "robot",
        "start": None if start is None else _numbers(start, "start"),
        "path": {"segments": [{"type": "move", **_targets(goal)}]},
        "ik": {"seed": seed, "effort": effort},
        "fixed_joints": dict(fixed_joints or {}),
        "limits": dict(limits or {}),
        "sampling": dict(sampling or {}),
        "budget_s": budget_s,
    }
    if scene is not None:
        document["scene"] = scene
    return plan(document, robot=robot, progress=progress)


def _targets(goal: ArrayLike | pin.SE3 | Mapping[str, Any] | Sequence[Any]) -> dict[str, Any]:
    """The goal as the fields of a move."""
    if isinstance(goal, pin.SE3):
        return {"to": _pose(goal)}
    if isinstance(goal, Mapping):
        return {"to": dict(goal)}
    if not isinstance(goal, list | tuple | np.ndarray) or len(goal) == 0:
        raise InvalidRequest(
            f"goal: joint values, a pose or a list of them, not {goal!r}", field="goal"
        )
    if isinstance(goal[0], int | float | np.number):
        return {"q": _numbers(goal, "goal")}
    return {"any": [_one_of_several(part, f"goal[{k}]") for k, part in enumerate(goal)]}


def _one_of_several(goal: Any, field: str) -> dict[str, Any]:
    if isinstance(goal, pin.SE3):
        return _pose(goal)
    return dict(goal) if isinstance(goal, Mapping) else {"q": _numbers(goal, field)}


def _pose(T: pin.SE3) -> dict[str, Any]:
    values = pin.SE3ToXYZQUAT(T).tolist()
    return {"position": values[:3], "quaternion_xyzw": values[3:]}


def _numbers(values: Any, field: str) -> list[float]:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(f"{field}: joint values are numbers", field=field) from error
    if array.ndim != 1:
        raise InvalidRequest(
            f"{field}: joint values have shape (dof,), not {array.shape}", field=field
        )
    return [float(value) for value in array]
