"""Cells of random boxes about any arm, made by a seed: problems that no setting was chosen on."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import ikplan
from benchmarks.moves.problems import Problem, checker_of
from ikplan.robots import Robot
from ikplan.robots.folders import package_file

__all__ = ["arm_on_a_rail", "random_problems"]

Array = NDArray[np.float64]
_BOXES = 8
_TRIES = 500
"""Configurations that are drawn for a free start and goal."""
_APART = 1.5
"""Least joint distance of start and goal [rad or m]."""


def random_problems(robot: Robot, count: int, seed: int, boxes: int = _BOXES) -> list[Problem]:
    """Return problems of random boxes with a free start and a free goal.

    Args:
        robot: The robot.
        count: How many cells are made; those in which no free ends are found are left out.
        seed: Of the cells.
        boxes: Boxes in each cell.
    """
    rng = np.random.default_rng(seed)
    places = np.array([robot.fk(robot.random_configuration(rng)).translation for _ in range(200)])
    reach = float(np.linalg.norm(places - np.median(places, axis=0), axis=1).max())
    problems = []
    for cell in range(count):
        scene = {"obstacles": [_box(k, rng, reach) for k in range(boxes)]}
        problem = Problem(f"cell {cell}", robot.home, robot.home, scene, {}, [])
        checker = checker_of(robot, problem)
        near = np.clip(
            robot.home + rng.uniform(-np.pi, np.pi, (_TRIES, robot.dof)), robot.lower, robot.upper
        )
        free = near[checker.free(near)]
        apart = np.flatnonzero(np.linalg.norm(free - free[:1], axis=1) > _APART)
        if len(apart):
            problems.append(Problem(problem.name, free[0], free[apart[0]], scene, {}, []))
    return problems


def _box(k: int, rng: np.random.Generator, reach: float) -> dict[str, object]:
    turn, far = rng.uniform(-np.pi, np.pi), reach * rng.uniform(0.4, 0.9)
    position = [far * np.cos(turn), far * np.sin(turn), reach * rng.uniform(-0.2, 0.8)]
    size = (reach * rng.uniform(0.05, 0.35, 3)).tolist()
    return {"name": f"box {k}", "shape": {"type": "box", "size": size}, "position": position}


def arm_on_a_rail() -> Robot:
    """Return the ur5 on a rail of 2 m along y."""
    urdf = package_file("example-robot-data", "ur_description/urdf/ur5_robot.urdf").read_text()
    rail = """<link name="rail"/>
  <joint name="rail_joint" type="prismatic">
    <parent link="rail"/><child link="base_link"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="1000"/>
  </joint>
</robot>"""
    urdf = urdf.replace('<link name="world"/>', "").replace('<link name="world" />', "")
    begin = urdf.find('<joint name="world_joint"')
    if begin >= 0:
        urdf = urdf[:begin] + urdf[urdf.index("</joint>", begin) + len("</joint>") :]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ur5_on_a_rail.urdf"
        path.write_text(urdf.replace("</robot>", rail))
        return ikplan.load_robot(path, base="rail", tip="tool0")
