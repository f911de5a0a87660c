"""Panda and UR5 as hulls of the meshes of example-robot-data."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.robots import Robot, load_robot
from ikplan.robots.folders import package_file
from ikplan.scene.body import Body, CollisionModel, ConvexPiece

__all__ = ["FILES", "mesh_bodies"]

Array = NDArray[np.float64]

FILES = {
    "panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf"),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "ur_description/srdf/ur5.srdf"),
}
_FINGER = 0.04
"""Where fingers are locked [m]."""


def mesh_bodies(name: str) -> tuple[Robot, CollisionModel]:
    """Return a robot and its links as hulls of the catalogue's meshes, with the SRDF's pairs."""
    urdf, srdf = (package_file("example-robot-data", path) for path in FILES[name])
    robot = load_robot(name)
    full = pin.buildModelFromUrdf(str(urdf))
    root = str(urdf.parents[4])
    geometry = pin.buildGeomFromUrdf(
        full, str(urdf), pin.GeometryType.COLLISION, package_dirs=[root]
    )
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(full, geometry, str(srdf))
    neutral = pin.neutral(full)
    locked = [k for k in range(1, full.njoints) if full.names[k] not in robot.model.names]
    for k in locked:
        neutral[full.joints[k].idx_q] = _FINGER
    model, geometry = pin.buildReducedModel(full, geometry, locked, neutral)
    for mine, theirs in zip(robot.model.jointPlacements, model.jointPlacements, strict=True):
        assert mine.isApprox(theirs, 1e-9)
    bodies = [
        Body(
            item.name,
            item.parentJoint,
            (_piece(item, robot if item.parentJoint == 0 else None),),
            source="hull of a mesh of example-robot-data",
        )
        for item in geometry.geometryObjects
    ]
    pairs = [
        (pair.first, pair.second)
        for pair in geometry.collisionPairs
        if bodies[pair.first].carrier != bodies[pair.second].carrier
    ]
    return robot, CollisionModel(tuple(bodies), np.array(pairs, dtype=np.int64), 0.0)


def _piece(item: pin.GeometryObject, on_base: Robot | None) -> ConvexPiece:
    """The hull of a geometry in the frame of its joint, or of the robot's base."""
    placement = item.placement
    if on_base is not None:
        placement = on_base.T_universe_base.inverse() * placement
    shape = item.geometry
    if isinstance(shape, coal.BVHModelBase):
        shape.buildConvexHull(True, "Qt")
        corners = np.array(shape.convex.points())
    else:
        half = np.array(shape.halfSide)
        corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * half
    return ConvexPiece(corners @ placement.rotation.T + placement.translation, 0.0)
