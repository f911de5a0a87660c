"""The URDF of a cell as a scene: its collision geometry, where its links stand."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ikplan.documents.scene import Scene
from ikplan.documents.shape import ConvexShape, PointsShape
from ikplan.errors import InvalidRequest
from ikplan.robots.urdf.urdf import parse_urdf
from ikplan.scene.body import ConvexPiece
from ikplan.scene.links import tree_poses
from ikplan.scene.shapes import transformed
from ikplan.scene.urdf_shapes import urdf_shapes

__all__ = ["urdf_cell"]


def urdf_cell(document: bytes, folder: Path, name: str) -> Scene:
    """Read the obstacles of a cell; its joints stand at zero, its root link is the base frame.

    Raises:
        InvalidRequest: A mesh that is not found: nothing is left out in silence.
        InvalidRobot: Not a URDF, or one that makes no sense.
    """
    poses = tree_poses(parse_urdf(document, robot=name))
    obstacles = []
    for link, shape in urdf_shapes(document, str(folder), name).items():
        if shape.missing:
            raise InvalidRequest(f"{name}: link {link!r}: {shape.missing[0]}", field="scene")
        pieces = transformed(shape.pieces, *poses[link])
        for k, piece in enumerate(pieces):
            label = link if len(pieces) == 1 else f"{link}[{k}]"
            obstacles.append({"name": label, **_obstacle(piece)})
    return Scene.model_validate({"obstacles": obstacles})


def _obstacle(piece: ConvexPiece) -> dict[str, object]:
    points = np.asarray(piece.points).tolist()
    if len(points) == 1 and piece.radius > 0.0:
        return {"shape": PointsShape(points=points, radius=piece.radius)}
    return {"shape": ConvexShape(points=points), "padding": piece.radius}
