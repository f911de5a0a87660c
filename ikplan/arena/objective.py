"""The objective of a pose for an optimiser from outside, and a search set up for the arena."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.documents import parse
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.errors import InvalidRequest
from ikplan.ik.arguments import check_start, target_of
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.outside.pose_objective import PoseObjective
from ikplan.ik.registry import find_solver, solvers
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.arm import arm_of
from ikplan.pipeline.collisions import keep_clear, requested_model
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.scene.resolve import resolve_scene

__all__ = ["bodies_of", "objective", "searcher_of"]

_ANY = "de-rand-1"
"""A search whose common parameters stand for those of all."""


def objective(
    robot: Robot,
    pose: Any,
    *,
    start: ArrayLike | None = None,
    budget: int | None = None,
    scene: Mapping[str, Any] | None = None,
    **params: Any,
) -> PoseObjective:
    """Return what the searches minimise, as a function of candidates.

    ``f = ikplan.objective(robot, pose)``; ``f(X)`` returns the values of ``X``, shape (n, dof), as
    an array of shape (n,); ``f.lower`` and ``f.upper`` are the bounds, ``f.best_x`` and
    ``f.best_f`` the best so far, ``f.spent`` counts.

    Args:
        robot: The robot.
        pose: As for :func:`ikplan.solve_ik`.
        start: Start configuration, shape (dof,) [rad or m]; None: home.
        budget: Most evaluations; None: no bound. Beyond it ``BudgetSpent`` is raised.
        scene: Bodies to keep clear of, as of a request ({}: the arm itself); their crowding is then
            a term. None: no such term.
        params: What every search takes: ``objective``, ``weight_position``,
            ``weight_orientation``, ``weight_motion``.

    Raises:
        InvalidRequest: An argument is wrong.
    """
    q_start = np.array(robot.home) if start is None else check_start(robot, start)
    searcher = searcher_of(robot, _ANY, 0, bodies_of(robot, scene), params)
    lower, upper = searcher.arm.search_bounds(q_start)
    data = searcher.objective(target_of(pose), q_start)
    return PoseObjective(data, np.array(lower), np.array(upper), q_start, budget=budget)


def bodies_of(robot: Robot, scene: Mapping[str, Any] | None) -> CollisionModel | None:
    """Return the bodies that a scene names; None: no scene.

    Raises:
        InvalidRequest: The scene is wrong.
    """
    if scene is None:
        return None
    resolved = resolve_scene(parse(Scene, scene), Path.cwd())
    return requested_model(robot, resolved, {}, ToolFrame(), always=False)


def searcher_of(
    robot: Robot,
    method: str,
    seed: int,
    model: CollisionModel | None,
    params: Mapping[str, Any],
    population: int | str | None = None,
    iterations: int | str | None = None,
) -> Searcher:
    """Return a search by name, set up for a robot.

    Args:
        robot: The robot.
        method: Name of a search.
        seed: Seed of its random numbers.
        model: Bodies to keep clear of; None: no such term.
        params: Its parameters.
        population: N; None: the planner's own, "paper": the paper's.
        iterations: T, likewise.

    Raises:
        InvalidRequest: There is none of that name, it is no search, or a parameter is wrong.
    """
    if not find_solver(method).searches:
        searches = [s.name for s in solvers() if s.searches]
        raise InvalidRequest(
            f"solvers: {method} minimises nothing; searches: {', '.join(searches)}",
            field="solvers",
            allowed=searches,
        )
    solver = PoseSolver(arm_of(robot), method, seed, population, iterations, params)
    if model is not None:
        keep_clear(robot, solver, model)
    assert solver.searcher is not None
    return solver.searcher
