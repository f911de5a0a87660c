"""The problem of a joint path, and the route that solves it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ikplan.arrays import Array, Indices, lengths_of, steps_of
from ikplan.collision.check import ContactCheck
from ikplan.documents.path import PathRequest
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.documents.trajectory import MoveReport
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.target import Target
from ikplan.limits import JointLimits
from ikplan.path import FoundCorners, Rounding, passed_rows
from ikplan.planning.ladder.motion_cost import MotionCost, plain_cost
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget

__all__ = [
    "JointPathProblem",
    "JointRoute",
    "RouteJointStep",
    "RouteMove",
    "RouteSegment",
    "RouteWaypoint",
]


@dataclass(frozen=True)
class JointPathProblem:
    """A path of a request for which a joint path is to be planned.

    Attributes:
        robot: The robot, with its tool.
        solver: Solves single targets.
        path: The path of the request.
        options: How joint solutions are looked for.
        q_start: Where the arm is, shape (dof,); with a free start, where it would rather be.
        start_free: Whether the path may begin anywhere.
        limits: Position limits.
        clock: The time budget.
        explain: Whether a refusal says why: what holds the arm takes longer to find out than
            that it is held.
        contact: Refuses configurations and motions in contact; None: nothing is checked.
        move_margins: Gap that the rounded corners of a move keep on top of that of the check, by
            the name of the move [m]; absent: none.
        rounding: Which corners are rounded within the tolerance, if the path asks for it.
        stops: Rows of the waypoints at which corners of tool paths are exact all the same.
        found: Corners rounded so far; variants of the path share them.
        order: Numbers of the waypoints or segments in the order in which they are passed; None:
            as the path is written.
        ends: Configurations at which moves, and joint motions before a tool path, end, by name:
            chosen already, with the target that each meets.
        left_from: Configuration in contact from which a straight motion to ``q_start`` comes
            first, shape (dof,) [rad or m]; None: the motion begins at ``q_start``.
        left: Rows of the model's pairs that touch there; None: none do.
        posture: What motions cost where a posture is preferred; None: joint motion alone counts.
        closeness: How near joint motions stay to tool paths that are met exactly [m].
    """

    robot: Robot
    solver: PoseSolver
    path: PathRequest
    options: IkOptions
    q_start: Array
    start_free: bool
    limits: JointLimits
    clock: TimeBudget
    explain: bool = True
    contact: ContactCheck | None = None
    move_margins: Mapping[str, float] = field(default_factory=dict)
    rounding: Rounding = "all"
    stops: frozenset[int] = frozenset()
    found: FoundCorners = field(default_factory=FoundCorners)
    order: tuple[int, ...] | None = None
    ends: Mapping[str, tuple[Array, Target]] = field(default_factory=dict)
    left_from: Array | None = None
    left: Indices | None = None
    posture: MotionCost | None = None
    closeness: float = np.inf

    @property
    def places(self) -> dict[int, int]:
        """Where each row of the waypoints is passed, where the path is not passed as written."""
        rows = [] if self.order is None else passed_rows(self.path, self.order)
        return {row: place for place, row in enumerate(rows)}

    @property
    def cost(self) -> MotionCost:
        """What a motion costs."""
        return plain_cost(self.robot.dof) if self.posture is None else self.posture

    def away(self, q: Array, q_from: Array) -> Array:
        """Return the weighted joint motion from one configuration to each of others.

        Args:
            q: The others, shape (c, dof) [rad or m].
            q_from: The one, shape (dof,) [rad or m].
        """
        return lengths_of(self.cost.weights * (q - q_from))


@dataclass(frozen=True)
class RouteWaypoint:
    """A waypoint of the request and the configuration that meets it.

    Attributes:
        row: Its row among the waypoints of the request.
        index: Index of its configuration.
        target: The target there.
        exact: Whether the path passes it; false at a rounded corner.
    """

    row: int
    index: int
    target: Target
    exact: bool = True


@dataclass(frozen=True)
class RouteSegment:
    """The configurations between which one segment of the request leads.

    Attributes:
        field: The field, such as ``path.segments[3]``.
        first: Index of the configuration at which it begins, or of the last one before.
        last: Index of the one at which it ends, or of the first one after.
    """

    field: str
    first: int
    last: int


@dataclass(frozen=True)
class RouteJointStep:
    """The configurations between which the joints move straight to a waypoint, as planned.

    Attributes:
        first: Index of the configuration at which the step begins.
        last: Index of the waypoint's.
        segment: Number of the segment of the request; None: not known.
    """

    first: int
    last: int
    segment: int | None


@dataclass(frozen=True)
class RouteMove:
    """The configurations between which one move leads.

    Attributes:
        report: Its report.
        first: Index of the configuration at which it begins.
        last: Index of the one at which it ends.
    """

    report: MoveReport
    first: int
    last: int


@dataclass(frozen=True)
class JointRoute:
    """The configurations that a joint path passes.

    Attributes:
        q: Configurations, shape (k, dof) [rad or m]; the first is where the motion begins.
        rest: Indices of those where the motion stops.
        waypoints: The waypoints of the request, in the order passed.
        segments: The segments of the request, in order.
        moves: The moves around obstacles, in order.
        other_roundings: Other ways to round corners within the tolerance that may be faster.
        joint_steps: The steps of joint legs, in order.
        stopped: The same route with stops at the corners between joint motions and tool paths;
            None: it passes none of them without.
    """

    q: Array
    rest: list[int]
    waypoints: list[RouteWaypoint]
    segments: list[RouteSegment]
    moves: list[RouteMove] = field(default_factory=list)
    other_roundings: frozenset[Rounding] = frozenset()
    joint_steps: list[RouteJointStep] = field(default_factory=list)
    stopped: JointRoute | None = None

    @property
    def length(self) -> float:
        """Joint distance along its chords [rad or m]."""
        return float(lengths_of(steps_of(self.q)).sum())
