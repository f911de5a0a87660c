"""The scene of a command: of a request, or of a file."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ikplan.scene.mesh_files import without_mesh_files

__all__ = ["set_scene", "with_meshes_beside"]


def with_meshes_beside(document: Any, file: str) -> Any:
    """Return a request document with its meshes read, relative to the folder of the request.

    Args:
        document: The document.
        file: Its file; ``-``: standard input, and the working folder.

    Raises:
        InvalidRequest: A mesh cannot be read.
    """
    if not isinstance(document, Mapping):
        return document
    return without_mesh_files(document, Path() if file == "-" else Path(file).parent)


def set_scene(options: argparse.Namespace, document: Any) -> None:
    """Put the scene of ``--scene`` into a document, in place of its own.

    Raises:
        InvalidRequest: The file cannot be read, or is no scene.
        InvalidRobot: The URDF of a cell makes no sense.
    """
    given: str | None = options.scene
    if given is None or not isinstance(document, dict):
        return
    if getattr(options, "server", None) is not None and not Path(given).exists():
        document["scene"] = given  # an id, which the service knows or refuses
        return
    from ikplan.scene.read_scene import read_scene

    document["scene"] = read_scene(given).model_dump(mode="json")
