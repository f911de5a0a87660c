"""What the choice along the path works on."""

from __future__ import annotations

from dataclasses import dataclass

from ikplan.arrays import Array
from ikplan.documents.plan_request import Tolerance
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.target import Target
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget

__all__ = ["WaypointProblem"]


@dataclass(frozen=True)
class WaypointProblem:
    """Targets to be met one after the other.

    Attributes:
        robot: The robot, with its tool.
        solver: Solves single targets.
        targets: The targets, in order.
        q_start: Where the arm is, shape (dof,); with a free start, where it would rather be.
        start_free: Whether the path may begin anywhere.
        tolerance: Deviation allowed where a target cannot be met exactly.
        clock: The time budget.
        first_row: Number of the first target among the waypoints of the path.
        explain: Whether a refusal names every waypoint out of reach; else the first only.
    """

    robot: Robot
    solver: PoseSolver
    targets: list[Target]
    q_start: Array
    start_free: bool
    tolerance: Tolerance
    clock: TimeBudget
    first_row: int = 0
    explain: bool = True
