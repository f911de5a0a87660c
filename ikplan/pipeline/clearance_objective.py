"""What ``ik.objective: "clearance"`` needs, and its refusal where that is missing."""

from __future__ import annotations

from ikplan.collision.checker import CollisionChecker
from ikplan.errors import InvalidRequest
from ikplan.ik.solve import PoseSolver
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["keep_clear"]


def keep_clear(
    robot: Robot, solver: PoseSolver, model: CollisionModel | None, margin: float = 0.0
) -> CollisionChecker:
    """Make clearance what a solver looks for, and return the check of its bodies.

    Args:
        robot: The robot, with its tool.
        solver: The solver.
        model: The bodies; None: the request asks for no check.
        margin: Gap asked for on top of the clearance [m].

    Raises:
        InvalidRequest: There are no two bodies to keep apart.
    """
    if model is None:
        raise InvalidRequest(
            "ik.objective: clearance needs bodies to keep clear of: give a scene, {} for the arm "
            "against itself",
            field="ik.objective",
            allowed=["motion"],
        )
    if len(model.pairs) == 0:
        raise InvalidRequest(
            f"ik.objective: clearance needs two bodies at least that are to be kept apart; links "
            f"of {robot.name} without a shape: {', '.join(model.unchecked) or 'none'}",
            field="ik.objective",
            allowed=["motion"],
        )
    contact = CollisionChecker(robot, model, margin)
    solver.keep_clear(contact.arrays(None))
    return contact
