"""The pose of the tool, as the legs of a path ask for it."""

from __future__ import annotations

from ikplan.arrays import Array
from ikplan.planning.joint_route import JointPathProblem

__all__ = ["tool_pose"]


def tool_pose(problem: JointPathProblem, q: Array) -> tuple[Array, Array]:
    """Return rotation, shape (3, 3), and position, shape (3,) [m], of the tool in the base.

    Args:
        problem: The path.
        q: Joint values, shape (dof,) [rad or m].
    """
    T = problem.robot.fk(q)
    return T.rotation.copy(), T.translation.copy()
