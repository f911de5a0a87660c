"""Planning scenes of MoveIt (``moveit_msgs/PlanningScene``) as scenes.

Read are the collision objects of ``world`` with their primitives (``shape_msgs/SolidPrimitive``)
and meshes, of which the convex hull counts. Planes and octomaps are refused, not left out. The
allowed collision matrix is not read: it names the links of one robot; use ``allow``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.errors import InvalidRequest

__all__ = ["is_planning_scene", "planning_scene"]

_TYPES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
"""Numbers of shape_msgs/SolidPrimitive."""
_CONE_SIDES = 24


def is_planning_scene(document: Any) -> bool:
    """Whether a document is a planning scene of MoveIt, or a world of one."""
    return isinstance(document, Mapping) and (
        "world" in document or "collision_objects" in document
    )


def planning_scene(document: Mapping[str, Any]) -> Scene:
    """Read a planning scene.

    Raises:
        InvalidRequest: A field is missing or wrong; names it.
    """
    world = document.get("world", document)
    obstacles: list[dict[str, Any]] = []
    try:
        for k, entry in enumerate(world.get("collision_objects") or []):
            obstacles += _object(entry, f"world.collision_objects[{k}]")
        if (world.get("octomap") or {}).get("octomap", {}).get("data"):
            raise InvalidRequest("world.octomap: octomaps are not read", field="world.octomap")
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        raise InvalidRequest(
            f"scene: not a planning scene of MoveIt: {type(error).__name__}: {error}",
            field="scene",
        ) from error
    return parse(Scene, {"obstacles": obstacles})


def _object(entry: Mapping[str, Any], field: str) -> list[dict[str, Any]]:
    """The obstacles of one collision object."""
    name, place = str(entry["id"]), _pose(entry.get("pose"))
    shapes = []
    for kind, poses in (("primitives", "primitive_poses"), ("meshes", "mesh_poses")):
        given, placed = entry.get(kind) or [], entry.get(poses) or []
        if placed and len(placed) != len(given):
            raise InvalidRequest(
                f"{field}.{poses}: {len(placed)} poses for {len(given)} {kind}",
                field=f"{field}.{poses}",
            )
        for k, shape in enumerate(given):
            make = _primitive if kind == "primitives" else _mesh
            T = place * _pose(placed[k] if placed else None)
            shapes.append((make(shape, f"{field}.{kind}[{k}]"), T))
    if entry.get("planes"):
        raise InvalidRequest(
            f"{field}.planes: planes without end are not read; give a box", field=f"{field}.planes"
        )
    return [
        {
            "name": name if len(shapes) == 1 else f"{name}[{k}]",
            "shape": shape,
            "position": (T.translation + 0.0).tolist(),
            "quaternion_xyzw": pin.SE3ToXYZQUAT(T)[3:].tolist(),
        }
        for k, (shape, T) in enumerate(shapes)
    ]


def _pose(pose: Mapping[str, Any] | None) -> pin.SE3:
    if not pose:
        return pin.SE3.Identity()
    position, turn = pose.get("position") or {}, pose.get("orientation") or {}
    xyz = [float(position.get(axis, 0.0)) for axis in "xyz"]
    quaternion = np.array([float(turn.get(axis, 0.0)) for axis in "xyzw"])
    length = float(np.linalg.norm(quaternion))
    # All zeros is what a message has where nobody set a rotation.
    quaternion = np.array([0.0, 0.0, 0.0, 1.0]) if length == 0.0 else quaternion / length
    return pin.XYZQUATToSE3(np.array([*xyz, *quaternion]))


def _primitive(shape: Mapping[str, Any], field: str) -> dict[str, Any]:
    kind, sizes = shape["type"], [float(v) for v in shape["dimensions"]]
    name = _TYPES.get(kind, str(kind).lower())
    if name == "box":
        return {"type": "box", "size": sizes[:3]}
    if name == "sphere":
        return {"type": "sphere", "radius": sizes[0]}
    if name == "cylinder":  # height, radius
        return {"type": "cylinder", "length": sizes[0], "radius": sizes[1]}
    if name == "cone":
        half, radius = 0.5 * sizes[0], sizes[1] / np.cos(np.pi / _CONE_SIDES)
        angles = 2.0 * np.pi * np.arange(_CONE_SIDES) / _CONE_SIDES
        ring = [[radius * np.cos(a), radius * np.sin(a), -half] for a in angles]
        return {"type": "convex", "points": [*ring, [0.0, 0.0, half]]}
    raise InvalidRequest(
        f"{field}.type: {kind!r} is not read; read are {', '.join(_TYPES.values())}",
        field=f"{field}.type",
        allowed=list(_TYPES.values()),
    )


def _mesh(shape: Mapping[str, Any], field: str) -> dict[str, Any]:
    points = [[float(v[axis]) for axis in "xyz"] for v in shape["vertices"]]
    if not points:
        raise InvalidRequest(f"{field}.vertices: there are none", field=f"{field}.vertices")
    return {"type": "convex", "points": points}
