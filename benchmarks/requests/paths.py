"""Random tool paths about a configuration of a robot, smooth, closed, repeated or free."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from benchmarks.requests.limits import random_segment_limits
from ikplan.robots import Robot

__all__ = ["random_joint_path", "random_path"]

Draws = np.random.Generator
Document = dict[str, Any]
Array = NDArray[np.float64]

_SPREADS = (0.02, 0.1, 0.3, 1.0)


def _pose(T: pin.SE3, oriented: bool) -> Document:
    document: Document = {"position": T.translation.tolist()}
    if oriented:
        document["quaternion_xyzw"] = pin.Quaternion(T.rotation).coeffs().tolist()
    return document


def random_path(rng: Draws, robot: Robot, q: Array, free_start: bool) -> Document:
    """Draw the path of a plan request.

    Args:
        rng: Source of the numbers.
        robot: The robot.
        q: Where it starts; waypoints are tool poses of configurations about it.
        free_start: Whether the start is not told: segments then need a pose to begin at.

    Returns:
        The document.
    """
    spread = float(rng.choice(_SPREADS))
    # All, none, or some of the waypoints have an orientation.
    share = float(rng.choice([0.0, 0.5, 1.0]))

    def waypoint() -> Document:
        near = robot.clip(q + spread * rng.normal(size=robot.dof))
        return _pose(robot.fk(near), bool(rng.random() < share))

    path: Document
    if rng.random() < 0.5:
        path = _through_waypoints(rng, waypoint, _pose(robot.fk(q), True))
    else:
        path = {"segments": _segments(rng, robot, waypoint)}
        if free_start or rng.random() < 0.2:
            path["begin"] = _pose(robot.fk(q), True)
    if rng.random() < 0.25:
        kinds = ["all", {"about": "tool_z"}, {"about": "tool_x", "cone": 0.2}]
        path["orientation_free"] = kinds[int(rng.integers(3))]
    if rng.random() < 0.4:
        path["tolerance"] = {
            "position": float(rng.choice([1e-5, 1e-4, 1e-3])),
            "orientation": float(rng.choice([1e-4, 1e-3, 1e-2])),
        }
    return path


def _through_waypoints(rng: Draws, waypoint: Callable[[], Document], here: Document) -> Document:
    waypoints = [waypoint() for _ in range(rng.integers(1, 7))]
    if rng.random() < 0.2:
        waypoints.insert(0, here)
    if rng.random() < 0.2:
        waypoints.append(dict(waypoints[-1]))
    if rng.random() < 0.25:
        waypoints.append(dict(waypoints[0]))
    path: Document = {
        "waypoints": waypoints,
        "interpolation": str(rng.choice(["joint", "line", "spline", "spline"])),
    }
    if rng.random() < 0.3:
        path["approach"] = str(rng.choice(["joint", "path"]))
    return path


def _segments(rng: Draws, robot: Robot, waypoint: Callable[[], Document]) -> list[Document]:
    segments = []
    for _ in range(rng.integers(1, 5)):
        kind = str(rng.choice(["line", "line", "via", "centre", "spline", "joint"]))
        segment: Document
        if kind == "line":
            segment = {"type": "line", "to": waypoint()}
        elif kind == "via":
            segment = {"type": "arc", "via": waypoint()["position"], "to": waypoint()}
        elif kind == "centre":
            segment = {
                "type": "arc",
                "centre": waypoint()["position"],
                "axis": rng.normal(size=3).tolist(),
                "angle": float(rng.uniform(-7, 7)),
                "orientation": str(rng.choice(["constant", "follow", "free"])),
            }
        elif kind == "spline":
            segment = {"type": "spline", "through": [waypoint() for _ in range(rng.integers(1, 5))]}
        elif rng.random() < 0.5:
            segment = {"type": "joint", "q": robot.random_configuration(rng).tolist()}
        else:
            segment = {"type": "joint", "to": waypoint()}
        if kind in ("line", "via", "centre") and rng.random() < 0.4:
            segment["blend"] = float(rng.choice([0.001, 0.01, 0.05]))
        if rng.random() < 0.3:
            segment["limits"] = random_segment_limits(rng, robot)
        segments.append(segment)
    for segment, following in itertools.zip_longest(segments, segments[1:]):
        if following is None or following["type"] == "joint":
            segment.pop("blend", None)
    return segments


def random_joint_path(rng: Draws, robot: Robot) -> Document:
    """Draw waypoints, rest points and limited segments of a timing request."""
    n = int(np.exp(rng.uniform(np.log(2), np.log(60))))
    spread = float(rng.choice(_SPREADS))
    q = robot.random_configuration(rng)
    if rng.random() < 0.5:
        rows = q + spread * np.cumsum(rng.normal(size=(n, robot.dof)), axis=0) / np.sqrt(n)
    else:
        rows = q + spread * rng.normal(size=(n, robot.dof))
    rows = np.array([robot.clip(row) for row in rows])
    if rng.random() < 0.2:
        rows = np.repeat(rows, rng.integers(1, 3, n), axis=0)
    if rng.random() < 0.2:
        rows = np.vstack([rows, rows[:1]])
    document: Document = {"waypoints": rows.tolist()}
    if rng.random() < 0.3:
        document["rest_at"] = sorted({int(i) for i in rng.integers(0, len(rows), 2)})
    if rng.random() < 0.3 and len(rows) > 2:
        first, last = sorted(int(i) for i in rng.choice(len(rows), 2, replace=False))
        limits = random_segment_limits(rng, robot)
        document["segments"] = [{"first": first, "last": last, "limits": limits}]
    return document
