"""The task that reads a scene to be stored, which takes 0.2 s for the meshes of a cell."""

from __future__ import annotations

from ikplan.documents import parse_json
from ikplan.documents.base import content_hash
from ikplan.documents.scene import Scene, SceneUpload
from ikplan.scene.resolve import resolve_scene
from ikplan_api.workers.headed import headed

__all__ = ["read_scene_file"]


def read_scene_file(body: bytes) -> bytes:
    """Return the document of a scene, with its id and name as its head.

    Raises:
        InvalidRequest: A field is invalid, or a mesh is given by a file.
    """
    upload = parse_json(SceneUpload, body)
    scene = Scene.model_construct(
        **{name: getattr(upload, name) for name in Scene.model_fields if name != "name"}
    )
    resolve_scene(scene, None, field="")  # a file is refused
    head = {"id": f"scene-{content_hash(scene)}", "name": upload.name}
    return headed(head, scene.model_dump_json().encode())
