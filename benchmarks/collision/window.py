"""A 7-joint arm through a window: the tool on a line with a free axis, the start given."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan
from benchmarks.collision.oracle import Oracle
from benchmarks.collision.window_search import flood_line
from benchmarks.planning.measure import pose_document
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.scene import Scene
from ikplan.errors import IkplanError
from ikplan.ik.solve import NoSolution, PoseSolver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.task_freedom import freedom_of
from ikplan.robots import Robot
from ikplan.scene.model import collision_model

__all__ = ["WindowStudy", "window_cases", "window_study"]

Array = NDArray[np.float64]

_TOOL = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
"""The tool's z axis points through the window, along x."""
WALL = 0.04
"""Thickness of the wall [m]."""
REACH = 0.7
"""How far the wall reaches from the window's middle [m]."""
SEEDS = 40
"""Configurations tried for a start that is free."""


@dataclass
class WindowStudy:
    """What became of the windows.

    Attributes:
        held: Windows where the motion planned without them is in contact with them.
        planned: Those of them that are planned and proven.
        open: The other windows.
        open_planned: Those of them that are planned.
        least: Least distance proven of each plan of the held ones [m].
        refused: Verdicts of the others, in words.
        lost: Those of them that a dense search over the self-motion passes.
    """

    held: int = 0
    planned: int = 0
    open: int = 0
    open_planned: int = 0
    least: list[float] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)


def window_scene(middle: Array, size: Array) -> dict[str, Any]:
    """Return a wall across x with a window, of width and height ``size`` [m]."""
    (w, h), (x, y, z) = 0.5 * size, middle
    parts = {
        "left": ((0.0, w + 0.5 * REACH, 0.0), (WALL, REACH, 2.0 * REACH)),
        "right": ((0.0, -w - 0.5 * REACH, 0.0), (WALL, REACH, 2.0 * REACH)),
        "sill": ((0.0, 0.0, -h - 0.5 * REACH), (WALL, 2.0 * w, REACH)),
        "lintel": ((0.0, 0.0, h + 0.5 * REACH), (WALL, 2.0 * w, REACH)),
    }
    return {
        "obstacles": [
            {
                "name": name,
                "shape": {"type": "box", "size": list(edges)},
                "position": [x + at[0], y + at[1], z + at[2]],
            }
            for name, (at, edges) in parts.items()
        ]
    }


def window_cases(robot: Robot, count: int, seed: int = 0) -> list[dict[str, Any]]:
    """Return requests: a line of 240 mm through a window, from a start that is free."""
    rng = np.random.default_rng(seed)
    solver = PoseSolver(arm_of(robot), "lm", tolerance_position=1e-9, tolerance_orientation=1e-9)
    cases: list[dict[str, Any]] = []
    while len(cases) < count:
        middle = rng.uniform([0.42, -0.3, 0.3], [0.55, 0.3, 0.7])
        scene = window_scene(middle, rng.uniform(0.28, 0.45, 2))
        begin = middle + np.array([-0.12, *rng.uniform(-0.03, 0.03, 2)])
        end = middle + np.array([0.12, *rng.uniform(-0.03, 0.03, 2)])
        oracle = Oracle(robot, collision_model(robot, parse(Scene, scene)))
        for _ in range(SEEDS):
            try:
                q = solver.solve(pose_target(begin, _TOOL), robot.random_configuration(rng)).q[0]
            except NoSolution:
                break
            if oracle.distances(q).min() > 2e-3:
                cases.append(
                    {
                        "robot": robot.name,
                        "scene": scene,
                        "start": q.tolist(),
                        "budget_s": 300.0,
                        "path": {
                            "waypoints": [pose_document(_TOOL, end)],
                            "interpolation": "line",
                            "orientation_free": {"about": "tool_z"},
                            "tolerance": {"position": 1e-3, "orientation": 1e-2},
                        },
                    }
                )
                break
    return cases


def _holds(robot: Robot, request: dict[str, Any]) -> bool | None:
    """Whether the motion planned without the scene is free of contact; None: there is none."""
    try:
        plan = ikplan.plan(request | {"scene": {"self_collision": False}}, robot=robot)
    except IkplanError:
        return None
    oracle = Oracle(robot, collision_model(robot, parse(Scene, request["scene"])))
    return all(oracle.distances(q).min() > 0.0 for q in plan.q)


def _passed(robot: Robot, request: dict[str, Any]) -> bool:
    """Whether a dense search over the self-motion along the line gets through a window."""
    document = parse(PlanRequest, request)
    oracle = Oracle(robot, collision_model(robot, parse(Scene, request["scene"])))
    end = np.array(request["path"]["waypoints"][0]["position"])
    start = np.array(request["start"])
    return flood_line(robot, oracle, start, end, freedom_of(document.path)).passed


def window_study(robot: Robot, count: int, seed: int = 0) -> WindowStudy:
    """Plan lines through windows.

    Args:
        robot: The robot, of seven joints.
        count: How many windows that the arm can follow the line of where there is none.
        seed: Of windows and starts.
    """
    study = WindowStudy()
    for k, request in enumerate(window_cases(robot, count, seed)):
        free = _holds(robot, request)
        if free is None:
            continue
        study.open += free
        study.held += not free
        try:
            plan = ikplan.plan(request, robot=robot)
        except IkplanError as error:
            refused = f"window {k}, {'open' if free else 'held'}: {error}"
            study.refused.append(refused)
            if _passed(robot, request):
                study.lost.append(refused)
            continue
        clearance = plan.certificate.clearance
        assert clearance is not None
        assert clearance.proven
        assert clearance.least is not None
        study.open_planned += free
        study.planned += not free
        if not free:
            study.least.append(clearance.least)
    return study
