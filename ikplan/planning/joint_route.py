"""A path to be laid into the joint space, and the route that it becomes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.documents.plan_request import IkOptions, PathRequest
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.target import Target
from ikplan.limits import JointLimits
from ikplan.path import ToolPath
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget

__all__ = ["JointPathProblem", "Route", "Span", "Stretch", "WaypointKnot"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointPathProblem:
    """A path to be laid into the joint space.

    Attributes:
        robot: The robot, with its tool.
        solver: Solves single targets.
        path: The path of the request.
        options: How joint solutions are looked for.
        q_start: Where the arm is, shape (dof,); with a free start, where it would rather be.
        start_free: Whether the path may begin anywhere.
        limits: Position limits.
        clock: The time budget.
        brief: Whether a refusal may leave out why: what holds the arm takes longer to find out
            than that it is held.
    """

    robot: Robot
    solver: PoseSolver
    path: PathRequest
    options: IkOptions
    q_start: Array
    start_free: bool
    limits: JointLimits
    clock: TimeBudget
    brief: bool = False


@dataclass(frozen=True)
class WaypointKnot:
    """A waypoint asked for and the knot that meets it.

    Attributes:
        row: Its row among the waypoints of the result.
        knot: Index of its knot.
        target: The tool pose wanted.
        exact: Whether the path passes it; false at a rounded corner.
    """

    row: int
    knot: int
    target: Target
    exact: bool = True


@dataclass(frozen=True)
class Span:
    """A tool path that the tool follows between two knots.

    Attributes:
        path: The tool path in the base.
        first: Knot of its begin.
        s: Path length at each of its knots, from ``first`` on, shape (m,) [m].
    """

    path: ToolPath
    first: int
    s: Array


@dataclass(frozen=True)
class Stretch:
    """What of the request leads from one knot to another.

    Attributes:
        field: The field, such as ``path.segments[3]``.
        first: Knot at which it begins, or the last one before.
        last: Knot at which it ends, or the first one after.
    """

    field: str
    first: int
    last: int


@dataclass(frozen=True)
class Route:
    """The knots of a joint path.

    Attributes:
        knots: Configurations, shape (k, dof) [rad or m]; the first is where the motion begins.
        rest: Knots where the motion stops.
        wanted: The waypoints asked for, in order.
        spans: The tool paths followed.
        evaluations: Forward-kinematics evaluations spent.
        stretches: Where each field of the request leads, in order.
    """

    knots: Array
    rest: list[int]
    wanted: list[WaypointKnot]
    spans: list[Span]
    evaluations: int
    stretches: list[Stretch]

    @property
    def waypoint_q(self) -> Array:
        """Configurations of the waypoints, shape (n, dof) [rad or m]."""
        return self.knots[[w.knot for w in self.wanted]]
