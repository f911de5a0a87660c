"""Requests of every kind of path, about a configuration of an arm in the middle of its reach."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan import load_robot
from ikplan.robots import Robot

START = [0.4, -1.2, 1.5, -0.8, -1.2, 0.3]
Document = dict[str, Any]
Vector = NDArray[np.float64]


def arm() -> Robot:
    return load_robot("ur5")


def pose_after(robot: Robot, step: list[float], turn: list[float]) -> Document:
    """The pose a step [m] and a turn [rad] away from that of the start, in the base."""
    T = robot.fk(START)
    R = T.rotation @ pin.exp3(np.array(turn))
    return {
        "position": (T.translation + np.array(step)).tolist(),
        "quaternion_xyzw": pin.Quaternion(R).coeffs().tolist(),
    }


def curve_frame(robot: Robot, first: list[float]) -> Document:
    """A frame turned about the base's z axis whose point ``first`` is the tool's at the start."""
    R = pin.exp3(np.array([0.0, 0.0, 0.7]))
    origin = robot.fk(START).translation - R @ np.array(first)
    return {"position": origin.tolist(), "quaternion_xyzw": pin.Quaternion(R).coeffs().tolist()}


def request(path: Document, **more: Any) -> Document:
    return {"robot": "ur5", "start": START, "ik": {"method": "lm"}, "path": path, **more}


def paths() -> dict[str, Document]:
    """One path of each kind that a request can ask for, by name."""
    robot = arm()
    p = robot.fk(START).translation
    near = pose_after(robot, [0.05, 0.06, 0.02], [0.2, -0.1, 0.15])
    far = pose_after(robot, [-0.03, 0.12, 0.05], [-0.1, 0.2, 0.1])
    third = pose_after(robot, [0.0, 0.2, 0.0], [0.0, 0.0, 0.0])
    bare = {"position": far["position"]}
    end = {"quaternion_xyzw": near["quaternion_xyzw"]}
    via = (p + np.array([0.05, 0.02, 0.03])).tolist()
    centre = (p + np.array([0.05, 0.01, 0.0])).tolist()
    about = {"type": "arc", "centre": centre, "axis": [0.1, -0.2, 2.0], "angle": 1.3}
    frame = {"frame": curve_frame(robot, [0.05, 0.0, 0.0])}
    wave = {"frame": curve_frame(robot, [0.0, 0.0, 0.0])}
    # The path frame: what is given in it is given in the base by its inverse.
    T_base_path = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([0.1, -0.05, 0.2]))
    framed = {
        "frame": _document(T_base_path),
        "waypoints": [_moved(T_base_path, near), _moved(T_base_path, far)],
    }
    single: dict[str, list[Document]] = {
        "line": [{"type": "line", "to": near}],
        "line, long way": [{"type": "line", "to": near, "turn_axis": _against(robot, near)}],
        "turn on the spot": [{"type": "line", "to": {**near, "position": p.tolist()}}],
        "arc through a point": [{"type": "arc", "via": via, "to": near}],
        "arc about a centre": [about],
        "arc that follows": [{**about, "orientation": "follow"}],
        "arc with an end": [{**about, "orientation": end}],
        "spline": [{"type": "spline", "through": [near, far, third]}],
        "joint values": [{"type": "joint", "q": [0.6, -1.1, 1.3, -0.7, -1.0, 0.2]}],
        "joint pose": [{"type": "joint", "to": near}],
        "circle": [{"type": "circle", "radius": 0.05, **frame}],
        "circle that follows": [
            {"type": "circle", "radius": 0.05, "angle": 2.0, "orientation": "follow", **frame}
        ],
        "helix": [{"type": "helix", "radius": 0.05, "rise": 0.06, "turns": 1.25, **frame}],
        "rose": [{"type": "rose", "radius": 0.05, "petals": 3, **frame}],
        "rose that follows": [
            {"type": "rose", "radius": 0.05, "angle": 0.8, "orientation": "follow", **frame}
        ],
        "rose with an end": [
            {"type": "rose", "radius": 0.05, "angle": 0.8, "orientation": end, **frame}
        ],
        "sinusoid": [
            {"type": "sinusoid", "length": 0.1, "amplitude": 0.02, "wavelength": 0.05, **wave}
        ],
        "sawtooth": [
            {"type": "sawtooth", "length": 0.1, "height": 0.03, "teeth": 2, "fall": 0.3, **wave}
        ],
        "trapezoid": [{"type": "trapezoid", "length": 0.1, "height": 0.03, "periods": 2, **wave}],
        "curve with an end": [{"type": "circle", "radius": 0.05, "orientation": end, **frame}],
        "blend": [
            {"type": "line", "to": near, "blend": 0.02},
            {"type": "line", "to": far},
        ],
        "led to an orientation": [
            {"type": "line", "to": bare},
            {"type": "line", "to": pose_after(robot, [0.0, 0.15, 0.0], [0.3, 0.2, 0.1])},
        ],
        "tool path after joint values": [
            {"type": "joint", "q": [0.6, -1.1, 1.3, -0.7, -1.0, 0.2]},
            {"type": "line", "to": near},
        ],
    }
    found: dict[str, Document] = {name: {"segments": part} for name, part in single.items()}
    found |= {
        "joint waypoints": {**framed, "interpolation": "joint"},
        "line waypoints": {**framed, "interpolation": "line"},
        "spline waypoints": {**framed, "interpolation": "spline"},
        "positions only": {"segments": [{"type": "line", "to": bare}]},
        "free about an axis": {
            "segments": [{"type": "line", "to": near}],
            "orientation_free": {"about": "tool_z"},
        },
        "cone": {
            "segments": [{"type": "line", "to": near}],
            "orientation_free": {"about": "tool_x", "cone": 0.1},
        },
        "box": {
            "segments": [{"type": "line", "to": far}],
            "tolerance": {
                "position": 1e-4,
                "orientation": 1e-3,
                "box": {"position": [0.01, 0.0, 0.005], "orientation": [0.0, 0.1, 0.0]},
            },
        },
    }
    return found


def _document(T: pin.SE3) -> Document:
    pose = pin.SE3ToXYZQUAT(T)
    return {"position": pose[:3].tolist(), "quaternion_xyzw": pose[3:].tolist()}


def _moved(T_base_path: pin.SE3, pose: Document) -> Document:
    T = pin.XYZQUATToSE3(np.array([*pose["position"], *pose["quaternion_xyzw"]]))
    return _document(T_base_path.inverse() * T)


def _against(robot: Robot, pose: Document) -> list[float]:
    """The axis of the turn to a pose, reversed: the way round is the longer one."""
    R = pin.Quaternion(np.array(pose["quaternion_xyzw"])).toRotationMatrix()
    R0 = robot.fk(START).rotation
    turn = R0 @ pin.log3(R0.T @ R)
    axis: list[float] = (-turn / math.sqrt(float(turn @ turn))).tolist()
    return axis
