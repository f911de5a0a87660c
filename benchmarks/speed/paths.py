"""Tool paths of many pieces, and joint paths of many waypoints, planned or timed in-process."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

import ikplan
from benchmarks.planning.scaling import spline_request
from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan.arrays import Array
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.robots import load_robot
from ikplan.timing import time_joint_path

__all__ = ["SECTION", "blended_corners", "polyline", "recorded_part", "retiming"]

FK = 0.55e-6
"""One call of the forward kinematics where the goals were set [s]."""


def blended_corners(count: int = 30, jerk: float | None = None) -> dict[str, Any]:
    """Return a zigzag of the iiwa that turns the tool, its corners rounded within 5 mm.

    Args:
        count: Number of corners.
        jerk: Limit of the joints' jerk [rad/s^3]; None: none.
    """
    waypoints = []
    for k in range(count + 2):
        a = math.pi * k / (count + 1)
        position = [0.55 + 0.06 * (k % 2) + 0.05 * math.sin(a), 0.25 * math.cos(a), 0.35]
        tilt = 0.1 * math.sin(3.0 * a)
        quaternion = [math.cos(tilt), math.sin(tilt), 0.0, 0.0]
        waypoints.append({"position": position, "quaternion_xyzw": quaternion})
    path = {"waypoints": waypoints, "interpolation": "line", "blend": 0.005, "approach": "joint"}
    limits = {} if jerk is None else {"limits": {"jerk": jerk}}
    return {**_plain("iiwa14"), "path": path, **limits}


def polyline(count: int) -> dict[str, Any]:
    """Return ``count`` waypoints of the iiwa, with a stop at each."""
    request: dict[str, Any] = spline_request(count, "line")
    request["path"] |= {"corners": "exact"}
    first = request["path"]["waypoints"][0]
    pose = pin.SE3(np.diag([1.0, -1.0, -1.0]), np.array(first["position"]))
    begin = ikplan.solve_ik(load_robot("iiwa14"), pose)
    return {**request, "start": np.asarray(begin.q).tolist()}


def recorded_part(count: int = 437) -> dict[str, Any]:
    """Return points on the rim of a bent part, the tool across it and free about its axis."""
    waypoints = []
    for k in range(count):
        a = 2.0 * math.pi * k / (count - 1)
        lean = 0.5 * math.sin(2.0 * a)
        position = [0.55 + 0.08 * math.cos(a), 0.1 * math.sin(a), 0.35 + 0.03 * math.sin(3.0 * a)]
        quaternion = [math.cos(0.5 * lean), 0.0, -math.sin(0.5 * lean), 0.0]
        rounded = [round(x, 7) for x in position]
        waypoints.append({"position": rounded, "quaternion_xyzw": quaternion})
    path = {
        "waypoints": waypoints,
        "interpolation": "line",
        "orientation_free": {"about": "tool_z"},
    }
    limits = {"tool_speed": 0.02}
    return {**_plain("iiwa14"), "start": "free", "path": path, "limits": limits}


def _plain(robot: str) -> dict[str, Any]:
    return {"robot": robot, "scene": {"self_collision": False}, "budget_s": 600}


def retiming(count: int) -> tuple[Array, JointLimits]:
    """Return ``count`` waypoints on seven sines, shape (count, 7) [rad], and their limits."""
    s = np.linspace(0.0, 1.0, count)[:, None]
    rates = np.array([1.0, 2.0, 1.5, 2.5, 3.0, 2.0, 1.0])
    q = 0.8 * np.sin(2.0 * math.pi * rates * s + np.arange(7))
    limits = JointLimits(
        lower=np.full(7, -3.0),
        upper=np.full(7, 3.0),
        velocity=np.full(7, 2.0),
        acceleration=np.full(7, 10.0),
        joint_names=tuple(f"joint{k}" for k in range(1, 8)),
    )
    return np.asarray(q), limits


def _planning(request: dict[str, Any]) -> Callable[[], object]:
    return lambda: ikplan.plan(request)


def _timing(count: int) -> Callable[[], object]:
    q, limits = retiming(count)
    return lambda: time_joint_path(JointPath.through(q, limits), limits)


def cases() -> dict[str, tuple[Callable[[], object], float | None]]:
    """Return what is timed, and the goal [ms] for calls of FK; None: reported only."""
    return {
        "30 blended corners": (_planning(blended_corners()), 150.0),
        "the same under a jerk limit": (_planning(blended_corners(jerk=500.0)), 600.0),
        "a bent part, 437 points": (_planning(recorded_part()), None),
        "polyline, 1,000 stops": (_planning(polyline(1000)), 500.0),
        "spline of 1,000": (_planning(spline_request(1000)), 250.0),
        "retiming 20 waypoints": (_timing(20), 3.0),
        "retiming 200 waypoints": (_timing(200), 4.0),
        "retiming 2,000 waypoints": (_timing(2000), 20.0),
    }


def run(effort: float) -> list[Figure]:
    """Time each case."""
    clock = FkClock(load_robot("iiwa14"))
    figures = []
    for name, (call, goal) in cases().items():
        call()
        short = goal is not None and goal < 50.0
        repeats = max(1, round((9 if short else 3) * effort))
        ratio = clock.ratio([call] * 3, repeats)
        most = None if goal is None else 1e-3 * goal / FK
        figures.append(Figure(name, ratio, "x FK", most=most))
    return figures


SECTION = Section("paths", "tool paths of many pieces, and timing of many waypoints, warm", run)
