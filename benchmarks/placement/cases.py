"""Paths to be placed: one of E9 (Li et al., 2023) and the seam of a pipe on a plate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.papers.li_paths import EQ_47, path_points
from ikplan.placement.evaluation import Aim

__all__ = ["CASES", "PlacementCase"]

_E9_POINTS = 25
_SEAM_POINTS = 9
_PIPE, _LEAN = 0.12, math.radians(45.0)


@dataclass(frozen=True)
class PlacementCase:
    """A request and what of its placement may change.

    Attributes:
        title: What it is, for people.
        request: The request.
        bounds: What may change, [m] and [rad].
        aim: What is least.
        carried: Obstacles that move with the part.
    """

    title: str
    request: dict[str, Any]
    bounds: dict[str, tuple[float, float]]
    aim: Aim
    carried: tuple[str, ...] = ()


def _e9() -> PlacementCase:
    """Trajectory 2 of E9: a circle of 600 mm, one orientation, a spline through 25 points."""
    quaternion = Rotation.from_matrix(EQ_47).as_quat().tolist()
    points = path_points("2")[np.linspace(0, 199, _E9_POINTS).astype(int)]
    poses = [{"position": p.tolist(), "quaternion_xyzw": quaternion} for p in points]
    return PlacementCase(
        "E9, trajectory 2 (circle of 600 mm, one orientation), eod_arm",
        {
            "robot": "eod_arm",
            "start": "free",
            "path": {"begin": poses[0], "segments": [{"type": "spline", "through": poses[1:]}]},
        },
        {
            **dict.fromkeys(("x", "y", "z"), (-0.4, 0.4)),
            **dict.fromkeys(("roll", "pitch", "yaw"), (-0.5 * math.pi, 0.5 * math.pi)),
        },
        "time",
    )


def _seam() -> PlacementCase:
    """The seam of a pipe that stands on a plate: a torch that leans by 45 degrees goes around."""
    angles = np.linspace(0.0, 1.5 * math.pi, _SEAM_POINTS)
    poses = []
    for a in angles:
        outwards = np.array([math.cos(a), math.sin(a), 0.0])
        z = -math.sin(_LEAN) * outwards - math.cos(_LEAN) * np.array([0.0, 0.0, 1.0])
        x = np.array([-math.sin(a), math.cos(a), 0.0])
        R = np.column_stack([x, np.cross(z, x), z])
        place = np.array([0.65, 0.0, 0.1]) + _PIPE * outwards
        quaternion = Rotation.from_matrix(R).as_quat().tolist()
        poses.append({"position": place.tolist(), "quaternion_xyzw": quaternion})
    return PlacementCase(
        "seam around a pipe of 240 mm on a plate, torch at 45 degrees free about its axis, ur10e",
        {
            "robot": "ur10e",
            "start": "free",
            "tool": {"position": [0.0, 0.0, 0.25]},
            "path": {
                "begin": poses[0],
                "segments": [{"type": "spline", "through": poses[1:]}],
                "orientation_free": {"about": "tool_z"},
            },
            "limits": {"tool_speed": 0.1},
            "scene": {
                "obstacles": [
                    {
                        "name": "pipe",
                        "shape": {"type": "box", "size": [0.16, 0.16, 0.2]},
                        "position": [0.65, 0.0, 0.2],
                    },
                    {
                        "name": "plate",
                        "shape": {"type": "box", "size": [0.5, 0.5, 0.02]},
                        "position": [0.65, 0.0, 0.07],
                    },
                ]
            },
        },
        {"x": (-0.3, 0.3), "y": (-0.4, 0.4), "z": (-0.1, 0.3), "yaw": (-math.pi, math.pi)},
        "wrist-speed",
        ("pipe", "plate"),
    )


CASES = {"e9": _e9, "seam": _seam}
