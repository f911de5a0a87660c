"""How far outside what a target allows a tool pose is, by the words of the request."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.request import PathRequest

__all__ = ["offset", "offsets"]

Array = NDArray[np.float64]

_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}


def offset(
    path: PathRequest, p: Array, R: Array, p_wanted: Array, R_wanted: Any
) -> tuple[float, float | None]:
    """Return how far one tool pose is outside what a target allows.

    Args:
        path: The path of the request: says what is free.
        p: Position of the tool in the base, shape (3,) [m].
        R: Rotation of the tool in the base, shape (3, 3).
        p_wanted: Position asked for, shape (3,) [m].
        R_wanted: Rotation asked for, shape (3, 3); None: any.

    Returns:
        Distance [m] and angle [rad]; None: no orientation is asked for.
    """
    any_rotation = R_wanted is None or path.orientation_free == "all"
    target = np.eye(3) if R_wanted is None else R_wanted
    distance, angle = offsets(path, p[None], R[None], p_wanted[None], target[None])
    return float(distance[0]), None if any_rotation else float(angle[0])


def offsets(
    path: PathRequest, p: Array, R: Array, p_wanted: Array, R_wanted: Array
) -> tuple[Array, Array]:
    """Return how far tool poses are outside what their targets allow.

    Args:
        path: The path of the request: says what is free.
        p: Positions of the tool in the base, shape (m, 3) [m].
        R: Rotations of the tool in the base, shape (m, 3, 3).
        p_wanted: Positions asked for, shape (m, 3) [m].
        R_wanted: Rotations asked for, shape (m, 3, 3).

    Returns:
        Distances [m] and angles [rad], each of shape (m,).
    """
    box, free = path.tolerance.box, path.orientation_free
    apart, axes = p - p_wanted, R_wanted
    if box is not None:
        if box.frame == "path":
            frame = np.array([*path.frame.position, *path.frame.quaternion_xyzw])
            axes = np.broadcast_to(pin.XYZQUATToSE3(frame).rotation, R.shape)
        along = np.einsum("mji,mj->mi", axes, apart)
        apart = np.maximum(np.abs(along) - np.array(box.position), 0.0)
    distance = np.linalg.norm(apart, axis=1)
    if free is not None and free != "all":
        axis = _AXES[free.about]
        a, b = R[:, :, axis], R_wanted[:, :, axis]
        sine = np.linalg.norm(np.cross(a, b), axis=1)
        angle = np.arctan2(sine, np.einsum("mi,mi->m", a, b))
        return distance, np.maximum(angle - (free.cone or 0.0), 0.0)
    if box is not None:
        turn = np.array([A @ pin.log3(A.T @ B) for A, B in zip(R, R_wanted, strict=True)])
        along = np.einsum("mji,mj->mi", axes, turn)
        excess = np.maximum(np.abs(along) - np.array(box.orientation), 0.0)
        return distance, np.asarray(np.linalg.norm(excess, axis=1))
    # ||A - B||_F = 2 sqrt(2) sin(angle / 2)
    chord = np.linalg.norm(R - R_wanted, axis=(1, 2)) / np.sqrt(8.0)
    return distance, 2.0 * np.arcsin(np.minimum(chord, 1.0))
