"""Meshes from files: STL (binary and ASCII), OBJ and Collada, read by coal with assimp."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest

__all__ = ["MAX_MESH_BYTES", "MESH_SUFFIXES", "Mesh", "read_mesh", "read_vertices"]

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[np.int64]]
"""Vertices, shape (n, 3) [m], and triangles, shape (m, 3)."""

MESH_SUFFIXES = (".dae", ".obj", ".stl")
MAX_MESH_BYTES = 100_000_000


def read_mesh(path: Path, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Mesh:
    """Read the vertices and triangles of a mesh file.

    As :func:`read_vertices`.

    Returns:
        Vertices, shape (n, 3) [m], and triangles, shape (m, 3).
    """
    loaded = _load(path, scale)
    triangles = [loaded.tri_indices(k) for k in range(loaded.num_tris)]
    return _vertices(loaded, path), np.array([[t[0], t[1], t[2]] for t in triangles], np.int64)


def read_vertices(path: Path, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Array:
    """Read the vertices of a mesh file.

    Args:
        path: The file.
        scale: Factors on its coordinates.

    Returns:
        Shape (n, 3) [m]. Whether the mesh is closed does not matter to its hull.

    Raises:
        InvalidRequest: No such file, of another kind, too large, or without vertices.
    """
    return _vertices(_load(path, scale), path)


def _load(path: Path, scale: tuple[float, float, float]) -> Any:
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InvalidRequest(
            f"the mesh {path.name!r} is none of {', '.join(MESH_SUFFIXES)}",
            field="file",
            allowed=list(MESH_SUFFIXES),
        )
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        raise InvalidRequest(f"the mesh {path} cannot be read: {error}", field="file") from error
    if not path.is_file() or size > MAX_MESH_BYTES:
        raise InvalidRequest(
            f"the mesh {path} must be a file of at most {MAX_MESH_BYTES:,} bytes, not {size:,}",
            field="file",
            allowed=f"at most {MAX_MESH_BYTES} bytes",
        )
    try:
        return coal.MeshLoader().load(str(path), np.array(scale, dtype=np.float64))
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())[:300]
        raise InvalidRequest(f"the mesh {path} cannot be read: {reason}", field="file") from error


def _vertices(loaded: Any, path: Path) -> Array:
    vertices = np.array(loaded.vertices(), dtype=np.float64).reshape(-1, 3)
    if not len(vertices) or not np.isfinite(vertices).all():
        raise InvalidRequest(f"the mesh {path} has no finite vertices", field="file")
    return vertices
