"""A straight line of the UR5's tool, planned and timed."""

from __future__ import annotations

import functools
import json
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import ikplan
from benchmarks.peers.measure import Contestant, Row, compare, module
from ikplan.arrays import Array
from ikplan.errors import Disconnected, TimingFailed, Unreachable
from ikplan.robots import Robot, load_robot
from ikplan.robots.folders import package_file

__all__ = ["requests", "run"]

LENGTH = 0.2
TOLERANCES = (1e-3, 1e-4)


def run(effort: float) -> list[Row]:
    """Plan random lines at two tolerances; lines that ikplan refuses are left out.

    Args:
        effort: Share of the full number of lines, in (0, 1].
    """
    robot = load_robot("ur5")
    lines = _lines(robot, max(3, int(20 * effort)))
    rows = []
    for tolerance in TOLERANCES:
        calls = [functools.partial(ikplan.plan, _request(line, tolerance)) for line in lines]
        contestants = [Contestant("ikplan", calls, "certified, the arm's own bodies not checked")]
        peer = _Roboplan(robot, tolerance) if module("roboplan") is not None else None
        if peer is not None:
            theirs = [functools.partial(peer.plan, line) for line in lines]
            solved = [call for call in theirs if call() is not None]
            note = f"{len(solved)} of the {len(lines)} lines; lines it does not solve left out"
            if solved:
                contestants.append(Contestant("roboplan", solved, note))
        rows += compare(f"UR5, line of 200 mm, {1e3 * tolerance:g} mm", contestants, 2)
    return rows


def requests(robot: Robot, count: int, tolerance: float) -> list[dict[str, Any]]:
    """Return requests of random lines that are planned, at a tolerance [m]."""
    return [_request(line, tolerance) for line in _lines(robot, count)]


def _lines(robot: Robot, count: int) -> list[tuple[Array, pin.SE3]]:
    """Starts and ends of lines that ikplan plans."""
    rng = np.random.default_rng(7)
    found: list[tuple[Array, pin.SE3]] = []
    while len(found) < count:
        q = robot.home + 0.5 * rng.uniform(-1.0, 1.0, robot.dof)
        direction = rng.normal(size=3)
        begin = robot.fk(q)
        shift = LENGTH * direction / np.linalg.norm(direction)
        line = (q, pin.SE3(begin.rotation, begin.translation + shift))
        try:
            ikplan.plan(_request(line, TOLERANCES[0]))
        except (Unreachable, Disconnected, TimingFailed):
            continue
        found.append(line)
    return found


def _request(line: tuple[Array, pin.SE3], tolerance: float) -> dict[str, Any]:
    q, end = line
    quaternion = pin.Quaternion(end.rotation).coeffs().tolist()
    waypoint = {"position": end.translation.tolist(), "quaternion_xyzw": quaternion}
    return {
        "robot": "ur5",
        "start": q.tolist(),
        "path": {
            "waypoints": [waypoint],
            "interpolation": "line",
            "tolerance": {"position": tolerance, "orientation": 10.0 * tolerance},
        },
        "scene": {"self_collision": False},
    }


def _limits(robot: Robot) -> dict[str, Any]:
    """The limits that ikplan plans with, as roboplan reads them."""
    return {
        name: {
            "max_velocity": [float(robot.velocity_limit[k])],
            "max_acceleration": [float(robot.acceleration_limit[k])],
        }
        for k, name in enumerate(robot.joint_names)
    }


class _Roboplan:
    """roboplan's planner of tool paths, on the same description without its meshes."""

    def __init__(self, robot: Robot, tolerance: float) -> None:
        self._core: Any = module("roboplan.core")
        planning: Any = module("roboplan.cartesian_planning")
        text = package_file("example-robot-data", "ur_description/urdf/ur5_robot.urdf").read_text()
        for tag in ("visual", "collision"):
            text = re.sub(rf"<{tag}\b.*?</{tag}>", "", text, flags=re.DOTALL)
        described = self._core.loadUrdfSceneDescriptionFromXml(text, [])
        self._robot, self._scene = robot, self._core.Scene("ur5", described)
        self._names = list(robot.joint_names)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "limits.yaml"
            file.write_text(json.dumps({"joint_limits": _limits(robot)}))
            self._scene.importJointLimitsFromConfig(self._core.loadJointLimitsConfig(file))
        self._scene.addGroup("arm", self._names)
        options = planning.CartesianPlannerOptions(
            group_name="arm",
            speed_mode=planning.CartesianSpeedMode.TimeOptimal,
            max_position_error=tolerance,
            max_orientation_error=10.0 * tolerance,
        )
        self._planner = planning.CartesianPathPlanner(self._scene, options)

    def plan(self, line: tuple[Array, pin.SE3]) -> object | None:
        """Return the trajectory; None: it finds none."""
        q, end = line
        poses = [np.asfortranarray(T.homogeneous) for T in (self._robot.fk(q), end)]
        path = self._core.CartesianPath([self._robot.base_frame], [self._robot.tip_frame], [poses])
        start = self._core.JointConfiguration(self._names, q)
        try:
            found: object = self._planner.plan(path, start)
        except RuntimeError:
            return None
        return found
