"""Planning scenes of MoveIt (``moveit_msgs/PlanningScene``) as scenes.

Read are the collision objects of ``world`` with their primitives (``shape_msgs/SolidPrimitive``)
and meshes, of which the convex hull counts, and the allowed collision matrix, as pairs that may
touch. What is not read is refused, not left out: planes, octomaps, attached objects, and padding
and scale of links.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
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
_OCTOMAP = "<octomap>"
"""MoveIt's name for its octomap in a matrix; a scene has none."""


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
    parts: dict[str, list[dict[str, Any]]] = {}
    try:
        for k, entry in enumerate(world.get("collision_objects") or []):
            made = _object(entry, f"world.collision_objects[{k}]")
            parts.setdefault(str(entry["id"]), []).extend(made)
        if (world.get("octomap") or {}).get("octomap", {}).get("data"):
            raise InvalidRequest("world.octomap: octomaps are not read", field="world.octomap")
        _refuse_unread(document)
        matrix = document.get("allowed_collision_matrix") or {}
        objects = {name: [str(o["name"]) for o in made] for name, made in parts.items()}
        allow = _allowed_pairs(matrix, objects)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        raise InvalidRequest(
            f"scene: not a planning scene of MoveIt: {type(error).__name__}: {error}",
            field="scene",
        ) from error
    obstacles = [obstacle for made in parts.values() for obstacle in made]
    return parse(Scene, {"obstacles": obstacles, "allow": allow})


def _refuse_unread(document: Mapping[str, Any]) -> None:
    """Refuse what would be checked otherwise than MoveIt checks it."""
    state = document.get("robot_state") or {}
    if state.get("attached_collision_objects"):
        field = "robot_state.attached_collision_objects"
        raise InvalidRequest(
            f"{field}: attached objects are not read; give them as `attached`, in the tool frame",
            field=field,
        )
    for field, key, usual in (("link_padding", "padding", 0.0), ("link_scale", "scale", 1.0)):
        for k, entry in enumerate(document.get(field) or []):
            if float(entry[key]) != usual:
                raise InvalidRequest(
                    f"{field}[{k}].{key}: {entry[key]} of {entry.get('link_name')!r} is not read; "
                    "give `clearance`, or `padding` of an obstacle",
                    field=f"{field}[{k}].{key}",
                    allowed=usual,
                )


def _allowed_pairs(
    matrix: Mapping[str, Any], objects: Mapping[str, Sequence[str]]
) -> list[list[str]]:
    """The pairs that may touch by ``moveit_msgs/AllowedCollisionMatrix``.

    A pair that is not in the matrix is allowed by the default of the one name that has any; where
    both have, both must allow it. Pairs are those of the names in the file.

    Args:
        matrix: The message.
        objects: Names of the obstacles that each collision object became.
    """
    where = "allowed_collision_matrix"
    names = [str(name) for name in matrix.get("entry_names") or []]
    rows = [[_flag(v) for v in row["enabled"]] for row in matrix.get("entry_values") or []]
    default_names = [str(name) for name in matrix.get("default_entry_names") or []]
    default_values = [_flag(v) for v in matrix.get("default_entry_values") or []]
    for field, found, wanted in (
        ("entry_names", len(set(names)), len(names)),
        ("entry_values", len(rows), len(names)),
        *((f"entry_values[{k}].enabled", len(row), len(names)) for k, row in enumerate(rows)),
        ("default_entry_values", len(default_values), len(default_names)),
    ):
        if found != wanted:
            raise InvalidRequest(
                f"{where}.{field}: {found} for {wanted} names; each name needs one of its own",
                field=f"{where}.{field}",
                allowed=wanted,
            )
    index = {name: k for k, name in enumerate(names)}
    defaults = dict(zip(default_names, default_values, strict=True))
    known = list(dict.fromkeys([*names, *default_names, *objects]))
    pairs = []
    for a, b in combinations([name for name in known if name != _OCTOMAP], 2):
        if a in index and b in index:
            allowed = rows[index[a]][index[b]]
            if allowed != rows[index[b]][index[a]]:
                raise InvalidRequest(
                    f"{where}.entry_values: {a!r} and {b!r} may touch in one row and not in the "
                    "other",
                    field=f"{where}.entry_values",
                )
        else:
            said = [defaults[name] for name in (a, b) if name in defaults]
            allowed = bool(said) and all(said)
        if allowed and not (a in objects and b in objects):  # obstacles are not checked
            pairs += [[i, j] for i in objects.get(a, [a]) for j in objects.get(b, [b])]
    return pairs


def _flag(value: Any) -> bool:
    """A ``bool`` of a message; some tools write 0 and 1."""
    if value in (0, 1):
        return bool(value)
    raise ValueError(f"{value!r} is no bool")


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
