"""Single pose with a preferred posture: what a plan chooses at its only waypoint."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.collision.check import ContactCheck
from ikplan.documents.pose_results import IkSolution
from ikplan.documents.poses import Posture, Tolerance
from ikplan.errors import InCollision, Unreachable
from ikplan.ik.arguments import check_start, target_of
from ikplan.ik.solve import NoSolution, PoseSolver, pose_distance, solve_pose
from ikplan.kinematics.arm import arm_of
from ikplan.planning.ladder.motion_cost import sequence_cost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.posture import (
    motion_cost,
    preferred_configuration,
    report_posture,
    within_soft_limits,
)
from ikplan.planning.waypoints.clear_waypoints import select_clear
from ikplan.planning.waypoints.least_motion import select_least_motion
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget

__all__ = ["preferred_pose"]

ContactOf = Callable[[Robot, PoseSolver], ContactCheck | None]


def preferred_pose(
    robot: Robot,
    solver: PoseSolver,
    pose: Any,
    start: ArrayLike | None,
    clock: TimeBudget,
    posture: Posture,
    contact_of: ContactOf,
    *,
    clearest: bool,
) -> IkSolution:
    """Return the solution that a posture prefers.

    The weighted distance from the start, plus ``pull`` times that from the preferred configuration,
    is least among those found; a solution within the soft limits is taken where one is found.

    Args:
        robot: The robot, with its tool.
        solver: The solver.
        pose: As for :func:`ikplan.solve_ik`.
        start: Where the solution is near to; None: where the posture would be.
        clock: The time budget.
        posture: What is preferred.
        contact_of: Returns what refuses configurations of a robot in contact, for a solver of its
            own; None: nothing is checked.
        clearest: Whether the least crowded solution is looked for.

    Raises:
        InvalidRequest: The posture does not fit the robot, or there is nothing to keep clear of.
        Unreachable: No solution within tolerance.
        InCollision: Every solution found is in contact.
        BudgetExceeded: The budget ran out.
    """
    cost = motion_cost(robot, posture)
    q_start = (
        preferred_configuration(robot, posture) if start is None else check_start(robot, start)
    )

    def chosen(within: Robot, solver: PoseSolver) -> Array:
        tolerance = Tolerance.model_construct(
            position=solver.tolerance_position, orientation=solver.tolerance_orientation
        )
        # With a free start the way from it is not looked at: a single pose has none.
        problem = WaypointProblem(
            within,
            solver,
            [target_of(pose)],
            q_start,
            True,
            tolerance,
            clock,
            contact=contact_of(within, solver),
            posture=cost,
        )
        if clearest:
            return np.array(select_clear(problem)[0])
        return _nearer_to_posture(problem, select_least_motion(problem)[0], posture)

    with clock.cutting(solver.cut, solver.search_evaluations):
        q = None
        if posture.lower is not None or posture.upper is not None:
            within = within_soft_limits(robot, posture)
            try:
                q = chosen(within, replace(solver, arm=arm_of(within), verdict=False))
            except (Unreachable, InCollision):
                q = None  # the soft limits are left
        if q is None:
            try:
                q = chosen(robot, solver)
            except Unreachable:
                q = solve_pose(robot, solver, pose, q_start).q  # refuses it as a single pose
    target = target_of(pose)
    distance, angle = pose_distance(solver.arm, target, q)
    return IkSolution.model_construct(
        q=q,
        position_error=distance,
        orientation_error=angle if target.oriented else None,
        elongation=float(np.linalg.norm(q - q_start)),
        evaluations=clock.evaluations,
        posture=report_posture(robot, posture, q[None]),
    )


def _nearer_to_posture(problem: WaypointProblem, q: Array, posture: Posture) -> Array:
    """The cheapest of a solution and of those that self-motion leads to from near the posture.

    At the start itself the cost has an edge, at which a descent along the self-motion rests.
    """
    arm, cost, q_start = problem.solver.arm, problem.cost, problem.q_start
    wanted = q_start if posture.q is None else np.array(posture.q, dtype=np.float64)
    wanted = np.clip(wanted, np.maximum(cost.lower, arm.lower), np.minimum(cost.upper, arm.upper))
    best, least = q, float(sequence_cost(q[None], q_start, False, cost))
    try:
        solved = problem.solver.solve(problem.targets[0], wanted)
    except NoSolution:
        return best  # met within the tolerance only, and there is no self-motion to it
    problem.clock.count(solved.evaluations)
    targets = stack_targets(problem.targets)
    for row in solved.q:
        rows = np.ascontiguousarray(row[None])
        total, spent = shorten_sequence(
            arm.chain, targets, rows, q_start, False, arm.lower, arm.upper, cost, 60, 1e-7
        )
        problem.clock.count(spent)
        if total < least and (problem.contact is None or problem.contact.free(rows)[0]):
            best, least = rows[0], total
    return best
