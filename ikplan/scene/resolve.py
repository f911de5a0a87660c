"""Scenes with meshes in files, as scenes that need no file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ikplan.documents.scene import AttachedBody, Obstacle, Scene, ToolGeometry
from ikplan.documents.shape import ConvexShape, MeshShape
from ikplan.errors import InvalidRequest
from ikplan.scene.hulls import hull_of
from ikplan.scene.meshes import read_vertices

__all__ = ["hull_points", "resolve_geometry", "resolve_scene"]

_Part = TypeVar("_Part", Obstacle, AttachedBody, ToolGeometry)


def resolve_scene(scene: Scene, folder: Path | None, *, field: str = "scene.") -> Scene:
    """Return a scene whose meshes are replaced by their convex hulls.

    A hull fills the hollows of a mesh: nothing that touches the mesh is missed, and a gap inside
    a hollow is not seen. Split a hollow body into several obstacles to keep its hollows.

    Args:
        scene: The scene.
        folder: Folder that relative paths begin at; None: files are refused, as a service does.
        field: What stands before the names of its fields in messages.

    Raises:
        InvalidRequest: A file where none is allowed, or a mesh that cannot be read; names the
            field.
    """
    obstacles = [
        _resolved(o, folder, f"{field}obstacles[{k}]") for k, o in enumerate(scene.obstacles)
    ]
    attached = [_resolved(a, folder, f"{field}attached[{k}]") for k, a in enumerate(scene.attached)]
    return Scene.model_validate(
        {
            **{name: getattr(scene, name) for name in type(scene).model_fields},
            "obstacles": obstacles,
            "attached": attached,
        }
    )


def resolve_geometry(geometry: list[ToolGeometry], folder: Path | None) -> list[ToolGeometry]:
    """Return the shapes of a tool, meshes replaced by their convex hulls.

    As :func:`resolve_scene`.
    """
    return [_resolved(g, folder, f"tool.geometry[{k}]") for k, g in enumerate(geometry)]


def hull_points(mesh: MeshShape, folder: Path, where: str) -> ConvexShape:
    """Return the convex hull of a mesh in a file.

    Args:
        mesh: The mesh.
        folder: Folder that a relative path begins at.
        where: The field of the shape, for messages.

    Raises:
        InvalidRequest: The mesh cannot be read; names the field.
    """
    try:
        vertices = read_vertices(folder / mesh.file, (mesh.scale,) * 3)
    except InvalidRequest as error:
        raise InvalidRequest(
            f"{where}.file: {error.detail}", field=f"{where}.file", allowed=error.allowed
        ) from error
    hull = hull_of(vertices)
    points = np.unique(vertices, axis=0) if hull is None else vertices[np.sort(hull.vertices)]
    return _convex(points, where)


def _resolved(part: _Part, folder: Path | None, field: str) -> _Part:
    shape = part.shape
    if not isinstance(shape, MeshShape):
        return part
    where = f"{field}.shape"
    if folder is None:
        raise InvalidRequest(
            f"{where}.file: files are read in Python, the shell and the client only; send the "
            "points as a convex shape",
            field=f"{where}.file",
            allowed="a shape without a file",
        )
    made: dict[str, Any] = {"shape": hull_points(shape, folder, where)}
    return part.model_copy(update=made)


def _convex(points: np.ndarray[Any, np.dtype[np.float64]], where: str) -> ConvexShape:
    largest = float(np.abs(points).max())
    if largest > 1_000.0:
        raise InvalidRequest(
            f"{where}.file: the mesh reaches {largest:g} m; it looks like millimetres: give "
            "scale 0.001",
            field=f"{where}.scale",
            allowed="0.001 for millimetres",
        )
    return ConvexShape(points=points.tolist())
