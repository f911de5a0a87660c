"""Part of the certificate: where the tool is, against where it was asked to be.

Like the certificate, it uses Pinocchio and the definition of the path, and nothing of the planner.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.path import ToolPath, path_deviation
from ikplan.request import PathRequest
from ikplan.robots import Robot

__all__ = ["Followed", "TimedSpan", "follow_checks", "offset", "offsets"]

Array = NDArray[np.float64]

_AXES = {"tool_x": 0, "tool_y": 1, "tool_z": 2}


@dataclass(frozen=True)
class TimedSpan:
    """A tool path, and when the motion says it is where on it.

    Attributes:
        path: The tool path asked for.
        time: Times, shape (k,), increasing [s].
        s: Path length at each, shape (k,) [m]; hints for the search of the nearest pose.
    """

    path: ToolPath
    time: Array
    s: Array


@dataclass(frozen=True)
class Followed:
    """How far the tool was from its paths.

    Attributes:
        distance: Largest distance [m]; None: there is no tool path.
        distance_time: When [s].
        angle: Largest rotation [rad]; None: no orientation is asked for along a path.
        angle_time: When [s].
    """

    distance: float | None = None
    distance_time: float | None = None
    angle: float | None = None
    angle_time: float | None = None


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


def follow_checks(
    robot: Robot, path: PathRequest, spans: list[TimedSpan], time: Array, q: Array
) -> Followed:
    """Measure the tool against its paths on every sample.

    Args:
        robot: The robot, with its tool.
        path: The path of the request.
        spans: The tool paths.
        time: Sample times, shape (m,) [s].
        q: Joint values, shape (m, dof) [rad or m].
    """
    worst = Followed()
    for span in spans:
        inside = np.flatnonzero((time >= span.time[0]) & (time <= span.time[-1]))
        if len(inside) == 0:
            continue
        R, p = robot.poses(q[inside])
        hints = np.interp(time[inside], span.time, span.s)
        plain = path.orientation_free is None and path.tolerance.box is None
        weight = path.tolerance.position / path.tolerance.orientation if plain else 0.0
        distance, angle, nearest = path_deviation(
            span.path,
            p,
            R,
            hints,
            window=_window(span),
            rotation_weight=weight,
        )
        if not plain:
            # Where nothing is free the search's own figures hold: where an oriented piece and a
            # free one meet, the path length alone does not tell which of them it measured.
            R_path, p_path = span.path.poses(nearest)
            distance, angle = offsets(path, p, R, p_path, R_path)
        at = int(np.argmax(distance))
        if worst.distance is None or distance[at] > worst.distance:
            worst = replace(
                worst, distance=float(distance[at]), distance_time=float(time[inside[at]])
            )
        counts = span.path.orientation_mask(nearest) & (path.orientation_free != "all")
        if not counts.any():
            continue
        at = int(np.argmax(np.where(counts, angle, -1.0)))
        if worst.angle is None or angle[at] > worst.angle:
            worst = replace(worst, angle=float(angle[at]), angle_time=float(time[inside[at]]))
    return worst


def _window(span: TimedSpan) -> float:
    """How far around a hint to look: hints are exact at the stations and near between them."""
    return float(np.max(np.diff(span.s), initial=1e-4))
