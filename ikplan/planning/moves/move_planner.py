"""Plans moves: where they may end, the way there, its corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.trajectory import MoveReport
from ikplan.errors import Disconnected, InCollision, InvalidRequest, Unreachable
from ikplan.ik.arguments import check_start
from ikplan.kinematics.target import Target, pose_target
from ikplan.path import JointWaypoint, MoveLeg
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.ladder.motion_cost import posture_distances
from ikplan.planning.moves.piece_check import piece_check
from ikplan.planning.moves.region.tool_region import ToolRegion, tool_region
from ikplan.planning.moves.region.way import inside
from ikplan.planning.moves.rounding import round_way
from ikplan.planning.moves.search import way_of
from ikplan.planning.moves.way import DEFAULT_EFFORT, Way
from ikplan.planning.segment_number import segment_number
from ikplan.planning.waypoints.ik_branches import branches
from ikplan.planning.waypoints.in_collision import in_collision
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["MoveGoals", "MovePlanner", "PlannedMove"]


@dataclass(frozen=True, eq=False)
class MoveGoals:
    """Configurations that a move may end at, free of contact.

    Attributes:
        q: Shape (g, dof), g >= 1 [rad or m].
        targets: What each meets, length g.
    """

    q: Array
    targets: list[Target]


@dataclass(frozen=True, eq=False)
class PlannedMove:
    """A planned move.

    Attributes:
        q: Configurations that its joint path passes, shape (k, dof) [rad or m].
        rest: Indices of those between its ends where it stops.
        goal: Index of the goal that it leads to.
        report: What the result says of it.
    """

    q: Array
    rest: list[int]
    goal: int
    report: MoveReport


class MovePlanner:
    """Plans the moves of one path.

    Args:
        problem: The path.
    """

    def __init__(self, problem: JointPathProblem) -> None:
        self._problem = problem

    def goals(self, leg: MoveLeg, problems: list[WaypointProblem]) -> MoveGoals:
        """Return every configuration that a move may end at.

        Args:
            leg: The move.
            problems: The problem of each of its targets.

        Raises:
            InvalidRequest: Joint values are outside their limits, or the goals outside the
                region of the move.
            InCollision: No target is free: of the first one in contact.
            Unreachable: No target is reachable: of the first.
        """
        if leg.name in self._problem.ends:
            q, target = self._problem.ends[leg.name]
            return MoveGoals(q[None].copy(), [target])
        rows: list[Array] = []
        targets: list[Target] = []
        refused: InCollision | Unreachable | None = None
        for waypoint, problem in zip(leg.targets, problems, strict=True):
            try:
                if waypoint.q is None:
                    found = branches(problem, turns=True)
                    target = problem.targets[0]
                else:
                    found = self._joint_values(waypoint, problem)[None]
                    T = problem.robot.fk(found[0])
                    target = pose_target(T.translation.copy(), T.rotation.copy())
            except (InCollision, Unreachable) as verdict:
                if refused is None or (
                    isinstance(refused, Unreachable) and isinstance(verdict, InCollision)
                ):
                    refused = verdict
                continue
            rows.append(found)
            targets += [target] * len(found)
        if refused is not None and not rows:
            raise refused
        goals = MoveGoals(np.concatenate(rows), targets)
        return goals if leg.within is None else self._within(leg, goals)

    def _within(self, leg: MoveLeg, goals: MoveGoals) -> MoveGoals:
        """Those of goals at which the tool is where it is to stay."""
        region = self.region(leg)
        assert region is not None
        kept = inside(region, goals.q)
        if not kept.any():
            raise _outside(leg, "no goal is")
        targets = [target for target, keep in zip(goals.targets, kept, strict=True) if keep]
        return MoveGoals(np.ascontiguousarray(goals.q[kept]), targets)

    def region(self, leg: MoveLeg) -> ToolRegion | None:
        """Return where the tool stays on a move; None: anywhere."""
        problem = self._problem
        if leg.within is None:
            return None
        return tool_region(problem.solver.arm, problem.path, leg.within)

    def _joint_values(self, waypoint: JointWaypoint, problem: WaypointProblem) -> Array:
        assert waypoint.q is not None
        q = check_start(problem.robot, waypoint.q, waypoint.name)
        segment = problem.segment(0)
        if problem.contact is not None and not problem.contact.free(q[None], segment)[0]:
            raise in_collision(
                problem.contact, q[None], waypoint.row, waypoint.name, segment, proven=True
            )
        return q

    def plan(self, leg: MoveLeg, q_start: Array, goals: Array) -> PlannedMove:
        """Plan the way to one of some goals.

        Args:
            leg: The move.
            q_start: Where it begins, shape (dof,) [rad or m].
            goals: The goals, free of contact, shape (g, dof) [rad or m].

        Raises:
            InvalidRequest: It does not begin in the region of the move.
            InCollision: It begins in contact, or no way was found within the effort.
            Disconnected: No way within the region of the move was found within the effort.
            BudgetExceeded: The time budget ran out.
        """
        problem, segment = self._problem, segment_number(leg.name)
        straight = np.linalg.norm(goals - q_start, axis=1)
        extra = posture_distances(goals, problem.cost)
        region = self.region(leg)
        if region is not None and not inside(region, q_start[None])[0]:
            raise _outside(leg, "its begin is not")
        if problem.contact is None and region is None:
            goal = int(np.argmin(straight + extra))
            way = Way(np.vstack([q_start, goals[goal]]), goal, float(straight[goal]), 0)
            samples = 0
        else:
            way, samples = self._search(leg, q_start, goals, segment, region)
        margin = problem.move_margins.get(leg.name, 0.0)
        check = piece_check(region, problem.contact, segment)
        rounded = round_way(way.q, problem.limits, check, margin)
        report = MoveReport(
            field=leg.name,
            length=rounded.length,
            found_length=way.found_length,
            least_length=float(straight[way.goal]),
            corners=len(way.q) - 2,
            stops=len(rounded.rest),
            samples=samples,
        )
        return PlannedMove(rounded.q, rounded.rest, way.goal, report)

    def _search(
        self,
        leg: MoveLeg,
        q_start: Array,
        goals: Array,
        segment: int | None,
        region: ToolRegion | None,
    ) -> tuple[Way, int]:
        problem, contact = self._problem, self._problem.contact
        row = leg.targets[0].row
        if contact is not None and not contact.free(q_start[None], segment)[0]:
            subject = f"{leg.name}: the configuration at which the move begins"
            raise in_collision(contact, q_start[None], row - 1, subject, segment, proven=True)
        way, samples = way_of(problem, q_start, goals, segment, region)
        if way is None:
            raise self._not_found(leg, q_start, goals, segment)
        return way, samples

    def _not_found(
        self, leg: MoveLeg, q_start: Array, goals: Array, segment: int | None
    ) -> InCollision | Disconnected:
        """The verdict where the effort is used up: not that there is no way."""
        contact = self._problem.contact
        nearest = goals[np.argmin(np.linalg.norm(goals - q_start, axis=1))]
        effort = self._problem.options.effort or DEFAULT_EFFORT
        straight = np.vstack([q_start, nearest])
        met = None if contact is None else contact.first_contact(straight, segment)
        if contact is None or met is None:  # the straight motion is held by the region alone
            return Disconnected(
                f"{leg.name}: no way within {leg.name}.within was found within an effort of "
                f"{effort:,} samples, which does not prove that there is none. A larger ik.effort "
                "searches longer",
                waypoints=(leg.targets[0].row - 1, leg.targets[0].row),
                jump=float(np.abs(nearest - q_start).max()),
                reason="the tool leaves the region of the move on the straight motion",
                q=q_start.tolist(),
            )
        depth = contact.shortfall(met.q, met.pair, segment)
        a, b = met.pair
        return InCollision(
            f"{leg.name}: no way was found within an effort of {effort:,} samples, which does not "
            f"prove that there is none; the straight motion meets {a} and {b}. A larger ik.effort "
            "searches longer",
            waypoint=leg.targets[0].row,
            pair=met.pair,
            depth=depth,
            q=met.q.tolist(),
            proven=False,
            reason=f"{a} and {b}",
        )


def _outside(leg: MoveLeg, what: str) -> InvalidRequest:
    return InvalidRequest(
        f"{leg.name}.within: {what} in the region that the tool is to stay in",
        field=f"{leg.name}.within",
        allowed="a cone and a box that hold the begin and a goal of the move",
    )
