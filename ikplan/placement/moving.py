"""A request with its part, or its robot's base, put elsewhere."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from scipy.spatial.transform import Rotation

from ikplan.arrays import Array
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import InvalidRequest

__all__ = ["AXES", "Moved", "offset_of", "replaced"]

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""What of a placement may change: lengths [m], and angles about the base's x, y and z, in this
order [rad]."""
Moved = Literal["part", "base"]


def offset_of(names: Sequence[str], values: Sequence[float], pivot: Array) -> tuple[Array, Array]:
    """Return the motion of a placement, as rotation (3, 3) and translation (3,) [m].

    Args:
        names: Names out of :data:`AXES`.
        values: Their values [m or rad].
        pivot: Place about which it turns, shape (3,) [m].
    """
    given = dict(zip(names, values, strict=True))
    shift = np.array([given.get(name, 0.0) for name in AXES[:3]])
    angles = [given.get(name, 0.0) for name in AXES[3:]]
    R = Rotation.from_euler("xyz", angles).as_matrix()
    return R, pivot + shift - R @ pivot


def replaced(
    request: PlanRequest, move: Moved, R: Array, p: Array, carried: Sequence[str] = ()
) -> dict[str, Any]:
    """Return the document of a request after a motion of its part or of its base.

    Args:
        request: The request, with a scene that is no id.
        move: "part": the path frame moves, and the obstacles that are carried with it; "base": the
            base moves, and path and obstacles are then elsewhere in it.
        R: Rotation of the motion in the base as it is, shape (3, 3).
        p: Its translation, shape (3,) [m].
        carried: Names of obstacles that move with the part.

    Raises:
        InvalidRequest: No obstacle has a name that is carried.
    """
    document = copy.deepcopy(request.model_dump(mode="json"))
    if move == "base":
        R, p = R.T, -R.T @ p
    document["path"]["frame"] = _moved(document["path"]["frame"], R, p)
    scene = document.get("scene")
    obstacles = scene.get("obstacles", []) if isinstance(scene, dict) else []
    names = [each["name"] for each in obstacles]
    for name in carried:
        if name not in names:
            raise InvalidRequest(
                f"carried: no obstacle is named {name!r}", field="carried", allowed=names
            )
    for each in obstacles:
        if move == "base" or each["name"] in carried:
            each |= _moved(each, R, p)
    return document


def _moved(frame: Mapping[str, Any], R: Array, p: Array) -> dict[str, list[float]]:
    turned = Rotation.from_matrix(R) * Rotation.from_quat(frame["quaternion_xyzw"])
    quaternion = turned.as_quat()
    # One of the two quaternions of a rotation, always the same one.
    quaternion = -quaternion if quaternion[3] < 0.0 else quaternion
    place = R @ np.array(frame["position"]) + p
    return {"position": place.tolist(), "quaternion_xyzw": quaternion.tolist()}
