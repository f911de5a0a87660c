"""Meshes of robots: which file a URI of a URDF stands for, if any."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from ikplan.errors import InvalidRobot
from ikplan.robots.folders import package_file

__all__ = ["MESH_SUFFIXES", "find_mesh"]

MESH_SUFFIXES = (".dae", ".obj", ".stl")

_PACKAGE = "example-robot-data"
_SCHEME = "package://"
_PREFIX = f"{_PACKAGE}/robots/"


def find_mesh(uri: str) -> tuple[str, Path]:
    """Find the file of a mesh in the folder of the package of robots.

    Args:
        uri: What a URDF names: ``package://example-robot-data/robots/...``, or
            ``package://NAME/...`` for the folder NAME of that package.

    Returns:
        The path below the package's ``robots`` folder, and the file.

    Raises:
        InvalidRobot: The URI has another form, leads out of that folder (by itself or by a
            symbolic link), names no kind of mesh, or the file is not installed.
    """
    path = uri.removeprefix(_SCHEME).removeprefix(_PREFIX)
    pure = PurePosixPath(path)
    plain = path.isascii() and path.isprintable() and not set(path) & set("\\%:?#*")
    if (
        not uri.startswith(_SCHEME)
        or not plain
        or pure.is_absolute()
        or ".." in pure.parts
        or str(pure) != path
    ):
        raise InvalidRobot(
            f"the mesh {uri[:200]!r} is not in a package; use {_SCHEME}NAME/..., "
            f"with a folder of {_PACKAGE}",
            value=uri[:200],
        )
    if pure.suffix.lower() not in MESH_SUFFIXES:
        raise InvalidRobot(
            f"the mesh {path!r} is none of {', '.join(MESH_SUFFIXES)}",
            value=path,
            valid=MESH_SUFFIXES,
        )
    file = package_file(_PACKAGE, path)
    root = file.parents[len(pure.parts) - 1].resolve()
    resolved = file.resolve()
    if not resolved.is_relative_to(root):
        raise InvalidRobot(f"the mesh {path!r} leads out of {_PACKAGE}", value=path)
    return path, resolved
