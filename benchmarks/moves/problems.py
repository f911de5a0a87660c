"""The problems of MotionBenchMaker, as requests of ikplan.

C. Chamzas et al., "MotionBenchMaker: A tool to generate and benchmark motion planning datasets",
IEEE Robotics and Automation Letters 7 (2), 2022; a subset, as shipped in KavrakiLab/vamp
(Apache-2.0).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.collision.checker import CollisionChecker
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.pipeline.collisions import requested_model
from ikplan.pipeline.plan import CONTACT_MARGIN
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["Problem", "checker_of", "model_of", "read_problems"]

Array = NDArray[np.float64]
_FOLDER = Path(__file__).parent / "scenes"

_ALLOW = {"panda": [], "ur5": [["forearm_link", "wrist_2_link"]]}
"""The convex hull of the ur5's bent forearm holds its wrist in 15 of the goals; the robot's
published SRDF does not check this pair."""


@dataclass(frozen=True, eq=False)
class Problem:
    """One problem.

    Attributes:
        name: Its set and number.
        start: Shape (dof,) [rad].
        goal: Shape (dof,) [rad].
        scene: The scene, as a document.
        fixed_joints: Joints beside the chain [rad or m].
        obstacles: The obstacles as the file has them.
    """

    name: str
    start: Array
    goal: Array
    scene: dict[str, Any]
    fixed_joints: dict[str, float]
    obstacles: list[dict[str, Any]]


def read_problems(robot: str) -> list[Problem]:
    """Return the problems of a robot of the set: "panda" or "ur5"."""
    data = json.loads((_FOLDER / f"{robot}.json").read_text())
    fixed = dict(data.get("fixed_joints") or {})
    fixed.pop("panda_finger_joint2", None)  # it mimics the first
    return [
        Problem(
            f"{row['set']} {row['index']}",
            np.array(row["start"], dtype=np.float64),
            np.array(row["goal"], dtype=np.float64),
            {"obstacles": [_obstacle(part) for part in row["obstacles"]], "allow": _ALLOW[robot]},
            fixed,
            row["obstacles"],
        )
        for row in data["problems"]
    ]


def _obstacle(part: dict[str, Any]) -> dict[str, Any]:
    sizes = {key: part[key] for key in ("size", "radius", "length") if key in part}
    turn = pin.Quaternion(np.array(part["rotation"]).reshape(3, 3)).normalized()
    return {
        "name": f"{part['name']} of the scene",  # a link may have its name
        "shape": {"type": part["type"], **sizes},
        "position": part["position"],
        "quaternion_xyzw": turn.coeffs().tolist(),
    }


def model_of(robot: Robot, problem: Problem) -> CollisionModel:
    """Return the bodies of a problem."""
    scene = Scene.model_validate(problem.scene)
    model = requested_model(robot, scene, problem.fixed_joints, ToolFrame(), always=True)
    assert model is not None
    return model


def checker_of(robot: Robot, problem: Problem) -> CollisionChecker:
    """Return the planner's check of a problem."""
    return CollisionChecker(robot, model_of(robot, problem), CONTACT_MARGIN)
