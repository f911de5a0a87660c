"""Stages of the tasks: a motion to a waypoint and the tool path that follows, by branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.target import Target
from ikplan.path import JointLeg, JointWaypoint, Leg, MoveLeg, ToolLeg, ToolPath
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.moves.move_planner import MoveGoals, MovePlanner
from ikplan.planning.segment_number import segment_to
from ikplan.planning.task_freedom import freedom_of, target_of
from ikplan.planning.tool_leg import OpenPose, StartingWays, path_tracker, track_after
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.planning.within.tolerant_tracker import TolerantTracker

__all__ = ["Stage", "stages_of"]

_BRANCHES = 8
"""Configurations of a waypoint that the choice is between, nearest to the start first."""


@dataclass(frozen=True, eq=False)
class Stage:
    """A joint motion or a move to a waypoint, and the tool path that begins there, if any.

    Attributes:
        leg: The motion to it.
        part: Number of the segment, or of the waypoint, that the motion ends.
        entries: Configurations in which the waypoint is met, shape (b, dof) [rad or m].
        targets: What each meets, length b.
        tracked: The tool path from each, a shape (m, dof) each, m >= 1; without one, the entry.
        followed: Whether a tool path follows.
    """

    leg: JointWaypoint | MoveLeg
    part: int
    entries: Array
    targets: list[Target]
    tracked: list[Array]
    followed: bool

    @property
    def exits(self) -> Array:
        """Where the tool path from each entry ends, shape (b, dof) [rad or m]."""
        return np.array([q[-1] for q in self.tracked])

    @property
    def moves(self) -> bool:
        """Whether it is gone to around what is in the way."""
        return isinstance(self.leg, MoveLeg)

    @property
    def name(self) -> str:
        """Where the request asks for its waypoint, or its move."""
        return self.leg.name


def stages_of(problem: JointPathProblem, legs: list[Leg], q_from: Array) -> list[Stage]:
    """Return the stages of legs, in the order written.

    Args:
        problem: The path.
        legs: Its legs, from the first that is no tool path.
        q_from: Where the motion to them begins, shape (dof,) [rad or m].

    Raises:
        Unreachable: A waypoint, or a tool path from it, has no solution.
        Disconnected: No continuous motion follows a tool path.
        InCollision: All that was found for one is in contact.
        TrackingFailed: The same, where ``problem.explain`` is false.
        BudgetExceeded: The time budget ran out.
    """
    finder = _Finder(problem, q_from)
    found: list[Stage] = []
    for leg, after in zip(legs, [*legs[1:], None], strict=True):
        path = after.path if isinstance(after, ToolLeg) else None
        if isinstance(leg, MoveLeg):
            found.append(finder.stage(leg, path))
        elif isinstance(leg, JointLeg):
            found += [finder.stage(waypoint, None) for waypoint in leg.waypoints[:-1]]
            found.append(finder.stage(leg.waypoints[-1], path))
        problem.clock.check()
    return found


class _Finder:
    def __init__(self, problem: JointPathProblem, q_from: Array) -> None:
        self._problem, self._q_from = problem, q_from
        self._freedom = freedom_of(problem.path)
        self._tracker: TolerantTracker = path_tracker(problem)
        self._planner = MovePlanner(problem)

    def stage(self, leg: JointWaypoint | MoveLeg, path: ToolPath | None) -> Stage:
        """The branches of a waypoint, and where each of them ends."""
        move = leg if isinstance(leg, MoveLeg) else MoveLeg((leg,), leg.name)
        goals = self._planner.goals(move, [self._problem_of(w) for w in move.targets])
        entries, targets = goals.q[:_BRANCHES], goals.targets[:_BRANCHES]
        tracked = [q[None] for q in entries]
        if path is not None:
            tracked = self._tracked(path, goals, leg, move.targets[0])
            entries = np.array([q[0] for q in tracked])
            targets = [goals.targets[0]] * len(entries)
        waypoint = move.targets[0]
        part = segment_to(waypoint)
        assert part is not None  # of every motion but that to the begin, which is no stage
        return Stage(leg, part, entries, targets, tracked, path is not None)

    def _problem_of(self, waypoint: JointWaypoint) -> WaypointProblem:
        problem = self._problem
        return WaypointProblem(
            problem.robot,
            problem.solver,
            [] if waypoint.pose is None else [target_of(problem.path, waypoint.pose)],
            self._q_from,
            False,
            problem.path.tolerance,
            problem.clock,
            waypoint.row,
            problem.explain,
            problem.contact,
            (segment_to(waypoint),),
        )

    def _tracked(
        self,
        path: ToolPath,
        goals: MoveGoals,
        leg: JointWaypoint | MoveLeg,
        waypoint: JointWaypoint,
    ) -> list[Array]:
        """A tool path as it is tracked from its entries, shortest first, where it can be."""
        rough = self._tracker.rough_sequences(path, goals.q[:_BRANCHES])
        if not rough:
            q = goals.q
            costs = self._problem.away(q, self._q_from)
            opened = None
            if isinstance(leg, MoveLeg) and waypoint.q is None:
                target, to = goals.targets[0], self._problem_of(waypoint)
                opened = OpenPose(waypoint, target, q, costs, to, leg)
            ways = StartingWays(q, costs, None, None if opened is None else opened.problem)
            one = track_after(self._problem, self._tracker, path, ways, opened)
            return [one.q]
        return [q for _, _, q in rough]
