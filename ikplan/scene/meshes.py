"""Meshes from files: STL (binary and ASCII), OBJ and Collada, read by coal with assimp."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest

__all__ = ["MAX_MESH_BYTES", "MESH_SUFFIXES", "Mesh", "read_mesh"]

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[np.int64]]
"""Vertices, shape (n, 3) [m], and triangles, shape (m, 3)."""

MESH_SUFFIXES = (".dae", ".obj", ".stl")
MAX_MESH_BYTES = 100_000_000


def read_mesh(path: Path, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Mesh:
    """Read a mesh file.

    Args:
        path: The file.
        scale: Factors on its coordinates.

    Returns:
        Its vertices and triangles. Whether it is closed does not matter to its hull.

    Raises:
        InvalidRequest: No such file, of another kind, too large, or without vertices.
    """
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
        loaded = coal.MeshLoader().load(str(path), np.array(scale, dtype=np.float64))
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())[:300]
        raise InvalidRequest(f"the mesh {path} cannot be read: {reason}", field="file") from error
    vertices = np.array(loaded.vertices(), dtype=np.float64).reshape(-1, 3)
    if not len(vertices) or not np.isfinite(vertices).all():
        raise InvalidRequest(f"the mesh {path} has no finite vertices", field="file")
    triangles = [loaded.tri_indices(k) for k in range(loaded.num_tris)]
    return vertices, np.array([[t[0], t[1], t[2]] for t in triangles], dtype=np.int64)
