"""The model of what must not touch: a robot's bodies, its tool, what it carries and obstacles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.documents.scene import AttachedBody, Obstacle, Scene, ToolGeometry
from ikplan.errors import InvalidRequest, near_names
from ikplan.robots import Robot
from ikplan.scene.allowed import self_pairs
from ikplan.scene.body import Body, CollisionModel
from ikplan.scene.links import Links
from ikplan.scene.robot_bodies import robot_bodies
from ikplan.scene.shapes import enclose, transformed

__all__ = ["collision_model"]

Array = NDArray[np.float64]


def collision_model(
    robot: Robot,
    scene: Scene | str | None = None,
    fixed_joints: Mapping[str, float] | None = None,
    tool_geometry: Sequence[ToolGeometry] = (),
) -> CollisionModel:
    """Return the bodies of a robot and its scene, and the pairs that must not touch.

    Pairs are those of links by :func:`~ikplan.scene.allowed.self_pairs` and, where
    ``self_collision`` is on, of the tool and of attached bodies with links of other carriers; and
    all that moves with every obstacle. Without are pairs of one carrier and pairs of ``allow``
    and ``touches``. What the tip itself carries - the last link with a shape, the tool, attached
    bodies - moves as one. Obstacles stand with the base: they are not checked against its links.

    Args:
        robot: The robot; its tool frame is where attached bodies are.
        scene: The scene; None: nothing but the arm. The id of a scene must be resolved before.
        fixed_joints: Values of joints beside the chain [rad or m].
        tool_geometry: Shapes of the tool, in the tip frame.

    Raises:
        InvalidRequest: A name in ``allow``, ``touches`` or ``fixed_joints`` that there is not, or
            two bodies of one name; an id, or a mesh that is not read.
        InvalidRobot: A shape of the robot's description makes no sense.
    """
    if isinstance(scene, str):
        raise InvalidRequest(
            f"scene: {scene!r} is the id of a scene that a service holds; give the scene itself",
            field="scene",
            allowed="a scene",
        )
    scene = Scene() if scene is None else scene
    found = robot_bodies(robot, fixed_joints)
    links = found.bodies
    kept, said = self_pairs(robot, fixed_joints)
    tip = int(robot.model.frames[robot.tip_frame_id].parentJoint)
    T_tip = pin.SE3(robot.model.frames[robot.tip_frame_id].placement)
    T_tool = T_tip * robot.T_tip_tool
    carried = [
        _placed(part, tip, T_tip, "tool", f"tool.geometry[{k}]")
        for k, part in enumerate(tool_geometry)
    ]
    carried += [
        _placed(part, tip, T_tool, "attached", f"scene.attached[{k}]")
        for k, part in enumerate(scene.attached)
    ]
    standing = [
        _placed(part, *_stand_of(part, found.links, f"scene.obstacles[{k}]"))
        for k, part in enumerate(scene.obstacles)
    ]
    bodies = (*links, *carried, *standing)
    _names_once(bodies, found.links.carrier, len(links))
    may_touch = _may_touch(scene, [body.name for body in bodies], found.links.carrier)
    allowed = list(said) if scene.self_collision else []
    pairs = [tuple(pair) for pair in kept.tolist()] if scene.self_collision else []
    first, last = len(links), len(links) + len(carried)
    if scene.self_collision:
        pairs += [
            (i, j)
            for i in range(first)
            for j in range(first, last)
            if not _is_joined(links[i], bodies[j], tip)
        ]
    pairs += [(i, j) for i in range(last) for j in range(last, len(bodies))]
    checked = []
    for i, j in pairs:
        names = frozenset((bodies[i].name, bodies[j].name))
        if names in may_touch:
            allowed.append((bodies[i].name, bodies[j].name, may_touch[names]))
        elif bodies[i].carrier != bodies[j].carrier:
            checked.append((i, j))
    return CollisionModel(
        bodies=bodies,
        pairs=np.array(checked, dtype=np.int64).reshape(-1, 2),
        clearance=scene.clearance,
        allowed=tuple(allowed),
        unchecked=found.unchecked,
    )


def _stand_of(part: Obstacle, links: Links, field: str) -> tuple[int, pin.SE3, str, str]:
    """What an obstacle moves with, the frame that it is given in, its kind and its field.

    Raises:
        InvalidRequest: There is no such link.
    """
    if part.link is None:
        return 0, pin.SE3.Identity(), "obstacle", field
    known = set(links.carrier)
    _require(part.link, known, list(links.carrier), f"{field}.link")
    return links.carrier[part.link], pin.SE3(*links.pose[part.link]), "obstacle", field


def _is_joined(link: Body, carried: Body, tip: int) -> bool:
    """Whether a link moves with what the tip carries."""
    return link.carrier == tip == carried.carrier


def _placed(
    part: Obstacle | AttachedBody | ToolGeometry,
    carrier: int,
    frame: pin.SE3,
    kind: str,
    field: str,
) -> Body:
    """A body of the request, in the frame of its carrier."""
    pieces, excess = enclose(part.shape, f"{field}.shape")
    T = frame * pin.XYZQUATToSE3(np.array([*part.position, *part.quaternion_xyzw]))
    source = f"the request: {part.shape.type}" + (
        f", enlarged by {part.padding:g} m" if part.padding else ""
    )
    segments = (part.first_segment, part.last_segment) if isinstance(part, AttachedBody) else ()
    return Body(
        part.name,
        carrier,
        transformed(pieces, T.rotation, T.translation, part.padding),
        kind,
        source,
        excess,
        *segments,
    )


def _names_once(bodies: Sequence[Body], links: Mapping[str, int], own: int) -> None:
    """Refuse a body of the request that is named as a link or as another body."""
    seen = set(links) | {body.name for body in bodies[:own]}
    for body in bodies[own:]:
        if body.name in seen:
            what = "a link of the robot" if body.name in links else "another body"
            field = {"tool": "tool.geometry", "attached": "scene.attached"}.get(
                body.kind, "scene.obstacles"
            )
            raise InvalidRequest(
                f"{field}: {body.name!r} is the name of {what} already", field=field
            )
        seen.add(body.name)


def _may_touch(
    scene: Scene, names: Sequence[str], links: Mapping[str, int]
) -> dict[frozenset[str], str]:
    """The pairs of names that the request allows to touch, and by which field."""
    valid = list(dict.fromkeys([*names, *links]))
    known = set(valid)
    found: dict[frozenset[str], str] = {}
    for k, pair in enumerate(scene.allow):
        for name in pair:
            _require(name, known, valid, f"scene.allow[{k}]")
        found[frozenset(pair)] = "the request: allow"
    for k, body in enumerate(scene.attached):
        for name in body.touches:
            _require(name, known, valid, f"scene.attached[{k}].touches")
            found[frozenset((body.name, name))] = "the request: touches"
    return found


def _require(name: str, known: set[str], valid: list[str], field: str) -> None:
    if name in known:
        return
    near = near_names(name, valid)
    hint = f"; did you mean {' or '.join(near)}?" if near else ""
    shown = ", ".join(valid[:60]) + (", ..." if len(valid) > 60 else "")
    raise InvalidRequest(
        f"{field}: no body {name!r}{hint or '.'} There are: {shown}", field=field, allowed=valid
    )
