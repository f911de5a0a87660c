"""The least distance of a robot from itself and its scene at one configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from ikplan.documents import parse
from ikplan.documents.scene import Scene, ToolGeometry
from ikplan.errors import InvalidRequest
from ikplan.robots import Robot
from ikplan.robots.clearance import Clearance
from ikplan.scene.body import CollisionModel
from ikplan.scene.contacts import Contacts
from ikplan.scene.model import collision_model
from ikplan.scene.poses import carrier_poses

__all__ = ["clearance", "model_clearance"]


def clearance(
    robot: Robot,
    q: ArrayLike,
    scene: Scene | Mapping[str, Any] | None = None,
    *,
    fixed_joints: Mapping[str, float] | None = None,
    tool_geometry: Sequence[ToolGeometry] = (),
) -> Clearance:
    """Return the least distance at a configuration, and between which bodies it is.

    Args:
        robot: The robot.
        q: Joint values, shape (dof,) [rad or m].
        scene: The scene, as a document; None: the arm against itself. What is attached counts
            whatever its segments.
        fixed_joints: Values of joints beside the chain [rad or m].
        tool_geometry: Shapes of the tool, in the tip frame.

    Raises:
        InvalidRequest: ``q`` or the scene is wrong, or no pair of bodies is left to be checked.
        InvalidRobot: A shape of the robot's description makes no sense.
    """
    document = None if scene is None else parse(Scene, scene)
    return model_clearance(robot, collision_model(robot, document, fixed_joints, tool_geometry), q)


def model_clearance(robot: Robot, model: CollisionModel, q: ArrayLike) -> Clearance:
    """Return the least distance of the pairs of a model at a configuration.

    Args:
        robot: The robot.
        model: Its bodies and pairs.
        q: Joint values, shape (dof,) [rad or m].

    Raises:
        InvalidRequest: ``q`` is wrong, or the model has no pair.
    """
    nearest = Contacts(model.bodies, model.pairs).nearest(*carrier_poses(robot, q))
    if nearest is None:
        raise InvalidRequest(
            f"{robot.name}: there is no pair of bodies to check; links without a shape: "
            + (", ".join(model.unchecked) or "none"),
            field="scene",
        )
    a, b = (model.bodies[int(k)].name for k in model.pairs[nearest.pair])
    return Clearance(nearest.distance, (a, b), nearest.points, len(model.pairs), model.unchecked)
