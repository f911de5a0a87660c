"""The bodies of a robot: its links, with shapes from its description."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import orjson

from ikplan.robots import Robot
from ikplan.robots.definition.collision import CollisionEntry, CollisionFile, LinkShape
from ikplan.robots.description import ShapeSource
from ikplan.scene.body import Body, ConvexPiece
from ikplan.scene.links import Links, links_of
from ikplan.scene.shapes import transformed
from ikplan.scene.urdf_shapes import LinkPieces, urdf_shapes

__all__ = ["RobotBodies", "SameBodies", "bodies_fingerprint", "robot_bodies"]


class RobotBodies(NamedTuple):
    """The links of a robot as bodies.

    Attributes:
        bodies: The links that have a shape, in the order of the description.
        unchecked: Names of links between base and tip, or beyond, that have none although they
            have a place of their own; and links whose mesh is not found.
        links: Where every link stands.
        notes: What could not be read, in words.
    """

    bodies: tuple[Body, ...]
    unchecked: tuple[str, ...]
    links: Links
    notes: tuple[str, ...]


def robot_bodies(robot: Robot, fixed_joints: Mapping[str, float] | None = None) -> RobotBodies:
    """Return the bodies of a robot, in the frames of their carriers.

    The shape of a link is that of ``robot.yaml``, else of the file of shapes that it names, else
    of the URDF's collision geometry. Meshes are read now and not when the robot is loaded.

    Args:
        robot: The robot.
        fixed_joints: Values of joints beside the chain, such as fingers [rad or m]; the others
            as the robot's description has them, else zero.

    Returns:
        The bodies; the same object for the same robot and values.

    Raises:
        InvalidRequest: No such joint beside the chain, or a value outside its limits.
        InvalidRobot: A shape of the description makes no sense.
    """
    return _bodies(SameBodies(robot), tuple(sorted((fixed_joints or {}).items())))


def bodies_fingerprint(robot: Robot) -> str:
    """SHA-256 over the bodies of a robot and the pairs that its description lets touch.

    A robot's own fingerprint leaves them out: they decide nothing where collisions are not checked.
    Files of meshes are not hashed, but the pieces made from them are.
    """
    digest = hashlib.sha256()
    for body in robot_bodies(robot).bodies:
        digest.update(orjson.dumps([body.name, body.carrier, len(body.pieces)]))
        for piece in body.pieces:
            digest.update(np.ascontiguousarray(piece.points).tobytes())
            digest.update(np.float64(piece.radius).tobytes())
    source = robot.description.shapes
    digest.update(source.srdf + b"|" + source.shapes)
    return digest.hexdigest()


class SameBodies:
    """A robot, equal to one that has the same bodies: the tool is no part of them."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        d = robot.description
        joints = tuple((j.lower, j.upper) for j in d.joints)
        self.key = (d.name, d.urdf, d.base, joints, d.coupling, d.shapes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameBodies) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


@functools.lru_cache(maxsize=64)
def _bodies(same: SameBodies, fixed: tuple[tuple[str, float], ...]) -> RobotBodies:
    robot = same.robot
    links = links_of(robot, dict(fixed))
    shapes = _shapes(robot.description.shapes, robot.name)
    bodies, unchecked, notes = [], [], []
    for name, carrier in links.carrier.items():
        shape = shapes.get(name)
        if name in links.loose:
            notes.append(f"link {name!r} follows a joint of the chain and is not checked")
            unchecked.append(name)
            continue
        if shape is None:
            if name in _bare(links, robot):
                unchecked.append(name)
            continue
        notes += [f"link {name!r}: {missing}" for missing in shape.missing]
        if shape.missing:
            unchecked.append(name)
        if shape.pieces:
            pieces = transformed(shape.pieces, *links.pose[name])
            bodies.append(Body(name, carrier, pieces, "link", shape.source, shape.excess))
    return RobotBodies(tuple(bodies), tuple(unchecked), links, tuple(notes))


def _bare(links: Links, robot: Robot) -> set[str]:
    """Links right behind a joint of the chain, whose carrier has no other link with a shape."""
    shaped = _shapes(robot.description.shapes, robot.name)
    moved = {links.carrier[name] for name in shaped if name in links.carrier}
    return {
        name
        for name, carrier in links.carrier.items()
        if carrier not in moved
        and (not carrier or links.carrier[links.parent[name]] != carrier)
        and (carrier or name == robot.base_frame)
    }


@functools.lru_cache(maxsize=64)
def _shapes(source: ShapeSource, robot: str) -> dict[str, LinkPieces]:
    """The shape of each link that has one, by name."""
    entry = CollisionEntry.model_validate(orjson.loads(source.shapes or b"{}"))
    shapes: dict[str, LinkPieces] = {}
    replaced: dict[str, LinkPieces] = {}
    if source.file:
        file = CollisionFile.model_validate(orjson.loads(source.file))
        for name, link in file.links.items():
            replaced[name] = _given(link, file.source)
    for name, link in entry.links.items():
        replaced[name] = _given(link, entry.source)
    if source.urdf:
        shapes = dict(urdf_shapes(source.urdf, source.folder, robot, skip=frozenset(replaced)))
    return {**shapes, **replaced}


def _given(link: LinkShape, source: str) -> LinkPieces:
    pieces = tuple(ConvexPiece(np.array(p.points, dtype=np.float64), p.radius) for p in link.pieces)
    excess = 0.0 if link.excess is None else link.excess
    return LinkPieces(pieces, link.source or source, excess, ())
