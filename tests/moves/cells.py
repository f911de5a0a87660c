"""Small cells for moves: an arm and what stands in its way."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan
from ikplan.robots import Robot

Array = NDArray[np.float64]


def box(name: str, position: Any, size: Any) -> dict[str, Any]:
    shape = {"type": "box", "size": [float(v) for v in size]}
    return {"name": name, "shape": shape, "position": [float(v) for v in position]}


def turned(robot: Robot, angle: float) -> Array:
    """The home of a robot, turned about its first axis."""
    q = robot.home.copy()
    q[0] += angle
    return np.asarray(q)


def post(robot: Robot, angle: float = 0.8, height: float = 1.6) -> dict[str, Any]:
    """A post where the tool passes when the arm turns by an angle from its home."""
    x, y, _ = robot.fk(turned(robot, angle)).translation
    return box("post", (x, y, 0.5 * height), (0.06, 0.06, height))


def window(
    robot: Robot, angle: float = 0.8, opening: float = 0.5, lift: float = 0.4
) -> list[dict[str, Any]]:
    """A wall across the turn from home with a square opening above the tool's way, in three parts.

    The wall is the plane x = 0 of a frame turned about z; its parts are boxes in that plane.
    """
    x, y, z = robot.fk(turned(robot, angle)).translation
    radius, half = float(np.hypot(x, y)), 0.5 * opening
    z += lift
    turn = float(np.arctan2(y, x))
    quaternion = [0.0, 0.0, float(np.sin(turn / 2)), float(np.cos(turn / 2))]
    along = np.array([np.cos(turn), np.sin(turn)])

    def part(name: str, r: float, height: float, size: tuple[float, float]) -> dict[str, Any]:
        found = box(name, (*(r * along), height), (size[0], 0.02, size[1]))
        return {**found, "quaternion_xyzw": quaternion}

    return [
        part("outer", radius + half + 0.3, z, (0.6, opening + 2.0)),
        part("below", radius, z - half - 0.5, (opening, 1.0)),
        part("above", radius, z + half + 0.25, (opening, 0.5)),
    ]


def pose(robot: Robot, q: Array) -> dict[str, Any]:
    """The tool's pose at joint values, as a waypoint."""
    from pinocchio import SE3ToXYZQUAT

    values = SE3ToXYZQUAT(robot.fk(q)).tolist()
    return {"position": values[:3], "quaternion_xyzw": values[3:]}


def moving(robot: str, segments: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    """A request for segments."""
    return {"robot": robot, "path": {"segments": segments}, "budget_s": 300.0, **more}


def nearest_bodies(plan: ikplan.Plan, scene: dict[str, Any]) -> float:
    """Least distance of the samples of a plan to a scene and to the arm itself [m]."""
    robot = ikplan.load_robot(plan.robot)
    return min(robot.clearance(q, scene).distance for q in plan.q[::4])
