"""Part of the certificate: where the tool is, against where it was asked to be.

Like the certificate, it uses Pinocchio and the definition of the path, and nothing of the planner.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.path import ToolPath, path_deviation
from ikplan.request import PathRequest
from ikplan.robots import Robot

__all__ = ["Followed", "TimedSpan", "follow_checks", "offset"]

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
    """Return how far a tool pose is outside what a target allows.

    Args:
        path: The path of the request: says what is free.
        p: Position of the tool in the base, shape (3,) [m].
        R: Rotation of the tool in the base, shape (3, 3).
        p_wanted: Position asked for, shape (3,) [m].
        R_wanted: Rotation asked for, shape (3, 3); None: any.

    Returns:
        Distance [m] and angle [rad]; None: no orientation is asked for.
    """
    box, free = path.tolerance.box, path.orientation_free
    apart = p - p_wanted
    axes = np.eye(3) if R_wanted is None else R_wanted
    if box is not None:
        if box.frame == "path":
            frame = np.array([*path.frame.position, *path.frame.quaternion_xyzw])
            axes = pin.XYZQUATToSE3(frame).rotation
        apart = np.maximum(np.abs(axes.T @ apart) - np.array(box.position), 0.0)
    distance = float(np.linalg.norm(apart))
    if R_wanted is None or free == "all":
        return distance, None
    if free is not None:
        axis = _AXES[free.about]
        a, b = R[:, axis], R_wanted[:, axis]
        angle = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
        return distance, max(angle - (free.cone or 0.0), 0.0)
    turn = R @ pin.log3(R.T @ R_wanted)
    if box is not None:
        turn = np.maximum(np.abs(axes.T @ turn) - np.array(box.orientation), 0.0)
    return distance, float(np.linalg.norm(turn))


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
        poses = [robot.fk(q[k]) for k in inside]
        p = np.array([T.translation for T in poses])
        R = np.array([T.rotation for T in poses])
        hints = np.interp(time[inside], span.time, span.s)
        plain = path.orientation_free is None and path.tolerance.box is None
        weight = path.tolerance.position / path.tolerance.orientation if plain else 0.0
        _, _, nearest = path_deviation(
            span.path,
            p,
            R,
            hints,
            window=_window(span),
            rotation_weight=weight,
        )
        R_path, p_path = span.path.poses(nearest)
        oriented = span.path.orientation_mask(nearest)
        for k, index in enumerate(inside):
            wanted = R_path[k] if oriented[k] else None
            distance, angle = offset(path, p[k], R[k], p_path[k], wanted)
            worst = _worse(worst, distance, angle, float(time[index]))
    return worst


def _window(span: TimedSpan) -> float:
    """How far around a hint to look: hints are exact at the stations and near between them."""
    return float(np.max(np.diff(span.s), initial=1e-4))


def _worse(worst: Followed, distance: float, angle: float | None, time: float) -> Followed:
    if worst.distance is None or distance > worst.distance:
        worst = Followed(distance, time, worst.angle, worst.angle_time)
    if angle is not None and (worst.angle is None or angle > worst.angle):
        worst = Followed(worst.distance, worst.distance_time, angle, time)
    return worst
