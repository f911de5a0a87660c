"""Request documents with meshes in files, as documents that can be sent: hulls in their place.

A document without a mesh costs no import of what reads meshes.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

__all__ = ["without_mesh_files"]

_PARTS = (("scene", "obstacles"), ("scene", "attached"), ("tool", "geometry"))
"""Where a request has shapes."""


def without_mesh_files(document: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """Return a request document in which every mesh in a file is its convex hull.

    What makes no sense stays as it is: who reads the document reports that.

    Args:
        document: The request, or a scene under the name ``scene``; not changed.
        folder: Folder that relative paths begin at.

    Raises:
        InvalidRequest: A mesh cannot be read; names the field.
    """
    result = dict(document)
    for outer, inner in _PARTS:
        holder = _plain(result.get(outer))
        parts = holder.get(inner) if isinstance(holder, Mapping) else None
        if not isinstance(parts, list | tuple):
            continue
        plain = [_plain(part) for part in parts]
        if any(_is_mesh(part) for part in plain):
            read = [_read(part, folder, f"{outer}.{inner}[{k}]") for k, part in enumerate(plain)]
            result[outer] = {**holder, inner: read}
    return result


def _plain(value: Any) -> Any:
    return value.model_dump(exclude_unset=True) if isinstance(value, BaseModel) else value


def _is_mesh(part: Any) -> bool:
    shape = _plain(part.get("shape")) if isinstance(part, Mapping) else None
    return isinstance(shape, Mapping) and shape.get("type") == "mesh" and "file" in shape


def _read(part: Any, folder: Path, field: str) -> Any:
    if not _is_mesh(part):
        return part
    from ikplan.documents import parse
    from ikplan.documents.shape import MeshShape
    from ikplan.errors import InvalidRequest
    from ikplan.scene.resolve import hull_points

    where = f"{field}.shape"
    try:
        mesh = parse(MeshShape, _plain(part["shape"]))
    except InvalidRequest as error:
        raise InvalidRequest(
            f"{where}.{error.detail}", field=f"{where}.{error.field}", allowed=error.allowed
        ) from error
    return {**part, "shape": hull_points(mesh, folder, where).model_dump()}
