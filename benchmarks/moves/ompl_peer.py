"""OMPL's RRTConnect over the same bodies, its states checked by ikplan's compiled check.

Edges are sampled, as OMPL does: at shares of the extent of the space. Needs ``pip install ompl``.
"""

from __future__ import annotations

import importlib
import time
from typing import Any

import numpy as np

from benchmarks.moves.problems import Problem, checker_of
from benchmarks.moves.search import Runs
from ikplan.robots import Robot

__all__ = ["ompl_runs"]

_SECONDS = 5.0
"""Most time of one search [s]."""
_STEP = 0.05
"""Joint distance between two states that are checked [rad]."""


def ompl_runs(robot: Robot, problems: list[Problem], seeds: int) -> Runs:
    """Search every problem by OMPL, with its own shortening.

    Raises:
        ModuleNotFoundError: OMPL is not installed.
    """
    base: Any = importlib.import_module("ompl.base")
    geometric: Any = importlib.import_module("ompl.geometric")
    util: Any = importlib.import_module("ompl.util")
    util.setLogLevel(util.LogLevel.LOG_NONE)
    runs = Runs()
    for problem in problems:
        checker = checker_of(robot, problem)
        lower = np.minimum(np.maximum(robot.lower, problem.start - np.pi), problem.goal)
        upper = np.maximum(np.minimum(robot.upper, problem.start + np.pi), problem.goal)
        for seed in range(seeds):
            util.RNG.setSeed(seed + 1)
            space = base.RealVectorStateSpace(robot.dof)
            bounds = base.RealVectorBounds(robot.dof)
            for d in range(robot.dof):
                bounds.setLow(d, float(lower[d]) - 1e-9)
                bounds.setHigh(d, float(upper[d]) + 1e-9)
            space.setBounds(bounds)
            setup = geometric.SimpleSetup(space)

            def valid(state: Any, checker: Any = checker) -> bool:
                q = np.array([[state[d] for d in range(robot.dof)]])
                return bool(checker.free(q)[0])

            setup.setStateValidityChecker(valid)
            information = setup.getSpaceInformation()
            information.setStateValidityCheckingResolution(_STEP / space.getMaximumExtent())
            start, goal = space.allocState(), space.allocState()
            for d in range(robot.dof):
                start[d], goal[d] = float(problem.start[d]), float(problem.goal[d])
            setup.setStartAndGoalStates(start, goal)
            setup.setPlanner(geometric.RRTConnect(information))
            begin = time.process_time()
            setup.solve(_SECONDS)
            found = time.process_time()
            solved = setup.haveExactSolutionPath()
            runs.solved.append(bool(solved))
            runs.search.append(1e3 * (found - begin))
            if not solved:
                continue
            runs.found_length.append(float(setup.getSolutionPath().length()))
            setup.simplifySolution()
            runs.shortened.append(1e3 * (time.process_time() - begin))
            runs.length.append(float(setup.getSolutionPath().length()))
    return runs
