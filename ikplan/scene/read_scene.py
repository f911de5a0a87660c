"""Scenes from files: our own JSON or YAML, a planning scene of MoveIt, the URDF of a cell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import orjson
import yaml

from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.errors import InvalidRequest
from ikplan.robots.yaml_text import load_yaml
from ikplan.scene.moveit import is_planning_scene, planning_scene
from ikplan.scene.resolve import resolve_scene
from ikplan.scene.urdf_cell import urdf_cell

__all__ = ["read_scene"]

MAX_SCENE_BYTES = 50_000_000


def read_scene(path: str | Path) -> Scene:
    """Read a scene from a file.

    Args:
        path: A ``.json``, ``.yaml`` or ``.yml`` file with a scene as in a request or with a
            planning scene of MoveIt (``moveit_msgs/PlanningScene``), whose frame counts as the
            robot's base; or a ``.urdf`` or ``.xml`` of a cell, whose root link counts as the
            robot's base, with its joints at zero. Meshes beside the file are read: obstacles are
            their convex hulls.

    Returns:
        The scene.

    Raises:
        InvalidRequest: No such file, or content that is no scene; names the field.
        InvalidRobot: A URDF that makes no sense.
    """
    file = Path(path)
    try:
        size = file.stat().st_size
        if size > MAX_SCENE_BYTES:
            raise InvalidRequest(
                f"{file}: {size:,} bytes; a scene may have {MAX_SCENE_BYTES:,}", field="scene"
            )
        content = file.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidRequest(f"{file}: cannot be read: {reason}", field="scene") from error
    folder = file.absolute().parent
    if file.suffix.lower() in (".urdf", ".xml"):
        return urdf_cell(content, folder, file.name)
    document = _document(content, file)
    if is_planning_scene(document):
        return planning_scene(document)
    return resolve_scene(parse(Scene, document), folder)


def _document(content: bytes, file: Path) -> Any:
    try:
        if file.suffix.lower() == ".json":
            return orjson.loads(content)
        return load_yaml(content)
    except (orjson.JSONDecodeError, yaml.YAMLError, RecursionError, ValueError) as error:
        where = " ".join(str(error).split())[:300]
        raise InvalidRequest(f"{file}: neither JSON nor YAML: {where}", field="scene") from error
