"""What a user sees of the bodies of a robot."""

from __future__ import annotations

from ikplan.robots import Robot
from ikplan.robots.info import AllowedPairInfo, BodyInfo, CollisionInfo, RobotInfo
from ikplan.scene.allowed import self_pairs
from ikplan.scene.robot_bodies import robot_bodies

__all__ = ["collision_info", "info_with_bodies"]


def collision_info(robot: Robot) -> CollisionInfo:
    """Return the bodies of a robot and the pairs that may touch, ready for JSON.

    Raises:
        InvalidRobot: A shape of the robot's description makes no sense.
    """
    found = robot_bodies(robot)
    kept, allowed = self_pairs(robot)
    return CollisionInfo(
        bodies=[
            BodyInfo(
                name=body.name,
                joint=None if body.carrier == 0 else robot.model.names[body.carrier],
                pieces=len(body.pieces),
                points=sum(len(piece.points) for piece in body.pieces),
                source=body.source,
                excess=body.excess,
            )
            for body in found.bodies
        ],
        pairs_checked=len(kept),
        allowed=[AllowedPairInfo(pair=[a, b], reason=why) for a, b, why in allowed],
        unchecked=list(found.unchecked),
        fixed_joints=dict(found.links.fixed),
        notes=list(found.notes),
    )


def info_with_bodies(robot: Robot) -> RobotInfo:
    """Return what :meth:`ikplan.Robot.info` does, with the bodies."""
    return robot.info().model_copy(update={"collision": collision_info(robot)})
