"""From a path of a request to the configurations of one joint path: leg by leg."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InCollision
from ikplan.ik.arguments import check_start
from ikplan.kinematics.target import Freedom, Target, pose_target
from ikplan.path import (
    JointLeg,
    JointWaypoint,
    Leg,
    MoveLeg,
    Pose,
    Rounding,
    ToolLeg,
    ToolPath,
)
from ikplan.planning.joins import Join, with_joins
from ikplan.planning.joint_route import (
    JointPathProblem,
    JointRoute,
    RouteJointStep,
    RouteMove,
    RouteSegment,
    RouteWaypoint,
)
from ikplan.planning.moves.move_planner import MovePlanner
from ikplan.planning.segment_number import segment_number, segment_to
from ikplan.planning.task_freedom import freedom_of, target_of
from ikplan.planning.tool_leg import (
    OpenPose,
    StartingWays,
    check_box,
    path_tracker,
    reached,
    track_after,
)
from ikplan.planning.tool_pose import tool_pose
from ikplan.planning.tracking.reference_path import points_around
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.tracking.tracked_path import TrackedPath
from ikplan.planning.waypoints.ik_branches import branches
from ikplan.planning.waypoints.in_collision import in_collision
from ikplan.planning.waypoints.select import select_configurations
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["JointPathPlanner"]


class JointPathPlanner:
    """Plans one leg after the other."""

    def __init__(self, problem: JointPathProblem) -> None:
        self.problem = problem
        self.freedom: Freedom = freedom_of(problem.path)
        self.tracker = path_tracker(problem)
        self.q: list[Array] = [] if problem.start_free else [problem.q_start]
        self.rest: list[int] = []
        if problem.left_from is not None:
            self.q, self.rest = [problem.left_from, problem.q_start], [1]
        self.waypoints: list[RouteWaypoint] = []
        self.segments: list[RouteSegment] = []
        self.moves: list[RouteMove] = []
        self.joint_steps: list[RouteJointStep] = []
        self.move_planner = MovePlanner(problem)
        self.joins: list[Join] = []
        self.other_roundings: frozenset[Rounding] = frozenset()
        self.opened: OpenPose | None = None

    def check_start_free(self) -> None:
        """Refuse a start in contact."""
        contact, q = self.problem.contact, self.problem.q_start
        if contact is not None and not contact.free(q[None], 0)[0]:
            raise in_collision(contact, q[None], -1, "the start", 0, proven=True)

    def fk(self, q: Array) -> tuple[Array, Array]:
        """Rotation and position of the tool in the base."""
        return tool_pose(self.problem, q)

    def route(self) -> JointRoute:
        """The route planned so far."""
        passed = self.problem.places
        waypoints = sorted(self.waypoints, key=lambda w: passed.get(w.row, w.row))
        q, parts = np.ascontiguousarray(self.q), (self.segments, self.moves)
        route = JointRoute(q, self.rest, waypoints, *parts, self.other_roundings, self.joint_steps)
        return with_joins(self.tracker, route, self.joins)

    @property
    def _last_q(self) -> Array:
        return self.q[-1] if self.q else self.problem.q_start

    def _target(self, pose: Pose) -> Target:
        return target_of(self.problem.path, pose, self.freedom)

    def joint_leg(self, leg: JointLeg, after: Leg | None) -> None:
        """Plan a joint leg; its last pose is left to a tool path that begins there."""
        waypoints = list(leg.waypoints)
        last = waypoints[-1]
        left_open = isinstance(after, ToolLeg) and last.q is None and self.problem.options.refine
        if left_open:
            waypoints.pop()
        run: list[JointWaypoint] = []
        for waypoint in waypoints:
            if waypoint.q is None:
                run.append(waypoint)
                continue
            self._select(run)
            run = []
            q = check_start(self.problem.robot, waypoint.q, waypoint.name)
            self._check_free(q, waypoint)
            R, p = self.fk(q)
            self._add(q, waypoint, pose_target(p, R))
        self._select(run)
        if left_open and last.pose is not None and isinstance(after, ToolLeg):
            self._open_pose(last, last.pose, after.path)

    def _waypoint_problem(self, run: list[JointWaypoint]) -> WaypointProblem:
        problem = self.problem
        return WaypointProblem(
            problem.robot,
            problem.solver,
            [self._target(t.pose) for t in run if t.pose is not None],
            self._last_q,
            not self.q,
            problem.path.tolerance,
            problem.clock,
            run[0].row,
            problem.explain,
            problem.contact,
            tuple(segment_to(waypoint) for waypoint in run),
            problem.posture,
        )

    def _select(self, run: list[JointWaypoint]) -> None:
        """Select the configurations of successive poses."""
        if not run:
            return
        problem = self._waypoint_problem(run)
        chosen = select_configurations(problem, self.problem.options)
        for waypoint, target, q in zip(run, problem.targets, chosen, strict=True):
            self._add(q, waypoint, target)

    def _open_pose(self, waypoint: JointWaypoint, pose: Pose, after: ToolPath) -> None:
        """Offer every branch of a pose to the tool path that begins there, turned as it begins."""
        begin = waypoint
        if pose.R is None and after.oriented(0.0):
            begin = replace(waypoint, pose=Pose(after.pose(0.0)[0], pose.p))
        problem = self._waypoint_problem([begin])
        copies: StartCopies | None = self._copies()
        chosen = self.problem.ends.get(waypoint.name)
        try:
            if chosen is None:
                starts = self._reached(branches(problem), waypoint)
            else:
                starts, copies = self._reached(chosen[0][None], waypoint), None
        except InCollision:
            starts, copies = self._reached(branches(problem, turns=True), waypoint), None
        costs = self.problem.away(starts, self._last_q) if self.q else np.zeros(len(starts))
        self.opened = OpenPose(waypoint, self._target(pose), starts, costs, problem, copies=copies)

    def move_leg(self, leg: MoveLeg, after: Leg | None) -> None:
        """Plan a move around obstacles; its branch is left to a tool path that begins there."""
        problems = [self._waypoint_problem([target]) for target in leg.targets]
        goals = self.move_planner.goals(leg, problems)
        last = leg.targets[0]
        if isinstance(after, ToolLeg) and last.q is None and self.problem.options.refine:
            costs = self.problem.away(goals.q, self._last_q)
            self.opened = OpenPose(last, goals.targets[0], goals.q, costs, problems[0], leg)
            return
        if not self.q:  # from a free start nothing leads to it
            k = int(np.argmin(self.problem.away(goals.q, self._last_q)))
            self._add(goals.q[k], last, goals.targets[k])
            return
        k = self._move(leg, goals.q)
        self.waypoints.append(RouteWaypoint(last.row, len(self.q) - 1, goals.targets[k]))

    def _move(self, leg: MoveLeg, goals: Array) -> int:
        """Add a move to one of some configurations; return which."""
        move = self.move_planner.plan(leg, self._last_q, goals)
        first = len(self.q) - 1
        self.q += list(move.q[1:])
        last = len(self.q) - 1
        self.rest += [first, *(first + k for k in move.rest), last]
        self.moves.append(RouteMove(move.report, first, last))
        if segment_number(leg.name) is not None and leg.targets[0].field:
            self.segments.append(RouteSegment(leg.targets[0].field, first, last))
        return move.goal

    def _reached(self, starts: Array, waypoint: JointWaypoint) -> Array:
        """Those of configurations that the straight joint motion leads to without contact."""
        contact = self.problem.contact
        if contact is None or not self.q:
            return starts
        return reached(contact, self._last_q, starts, waypoint, segment_to(waypoint))

    def tool_leg(self, leg: ToolLeg, *, last: bool) -> None:
        """Track a tool path; where a motion leads to it, from a branch that it gets to.

        After the last one, the branch that it ends in does not matter.
        """
        path = leg.path
        check_box(self.freedom, path)
        ways = self._starts(path)
        while True:
            opened = self.opened
            tracked = track_after(self.problem, self.tracker, path, ways, opened)
            if opened is None or not self.q:
                break
            try:
                if opened.move is None:
                    if ways.copies is not None:  # the copy that was taken may be beyond a body
                        self._reached(tracked.q[:1], opened.waypoint)
                    break
                self._move(opened.move, tracked.q[:1])
                break
            except InCollision:
                if opened.move is None:
                    every = branches(opened.problem, turns=True)
                    starts = self._reached(every, opened.waypoint)
                    costs = self.problem.away(starts, self._last_q)
                    ways = StartingWays(starts, costs, None, opened.problem)
                    continue
                ways = ways.without(tracked.q[0])
                if len(ways.starts) == 0:
                    raise
        self._append(leg, self.tracker.straighten(path, tracked) if last else tracked)
        self.other_roundings |= path.other_roundings

    def _check_free(self, q: Array, waypoint: JointWaypoint) -> None:
        """Refuse joint values that are asked for and in contact."""
        contact, segment = self.problem.contact, segment_to(waypoint)
        if contact is not None and not contact.free(q[None], segment)[0]:
            raise in_collision(contact, q[None], waypoint.row, waypoint.name, segment, proven=True)

    def _copies(self) -> StartCopies:
        return StartCopies(self._last_q, bool(self.q), self.problem.posture)

    def _starts(self, path: ToolPath) -> StartingWays:
        """How the tool path may begin."""
        opened = self.opened
        if opened is not None:
            return StartingWays(opened.starts, opened.costs, opened.copies, opened.problem)
        if self.q:
            return StartingWays(self.q[-1][None], np.zeros(1), None, None)
        R, p = path.pose(0.0)
        # What begins without an orientation may begin at a waypoint with one.
        rotations = [w.R for w in path.waypoints if w.s == 0.0 and w.R is not None]
        pose = Pose(R if path.oriented(0.0) else (rotations[0] if rotations else None), p)
        begin = self._waypoint_problem([JointWaypoint(0, "the begin of the path", pose=pose)])
        starts = branches(begin)
        return StartingWays(starts, np.zeros(len(starts)), self._copies(), begin)

    def _append(self, leg: ToolLeg, tracked: TrackedPath) -> None:
        """Add the points of a tracked path; the motion rests where it begins and ends."""
        path, joined = leg.path, bool(self.q) and np.array_equal(self.q[-1], tracked.q[0])
        if joined:
            self.q.pop()
        first = len(self.q)
        if self.opened is not None:
            if not joined and self.opened.move is None:
                self._end_segment(self.opened.waypoint)
            self.waypoints.append(
                RouteWaypoint(self.opened.waypoint.row, first, self.opened.target)
            )
            self.opened = None
        self.q += list(tracked.q)
        self.rest += [first, *(first + k for k in tracked.rest), len(self.q) - 1]
        for corner, radius in ((first, leg.begin_blend), (len(self.q) - 1, leg.end_blend)):
            if radius > 0.0:
                self.joins.append(Join(corner, radius, path, tracked.s, first))
        for waypoint, k in zip(path.waypoints, tracked.waypoint, strict=True):
            pose = Pose(waypoint.R, waypoint.p)
            row = RouteWaypoint(waypoint.row, first + int(k), self._target(pose), waypoint.exact)
            self.waypoints.append(row)
        ranges = np.array([(x.begin, x.end) for x in path.segments]).reshape(-1, 2)
        around = points_around(path, tracked.s, *ranges.T)
        for segment, begin, end in zip(path.segments, *(k.tolist() for k in around), strict=True):
            self.segments.append(RouteSegment(segment.field, first + begin, first + end))

    def _add(self, q: Array, waypoint: JointWaypoint, target: Target) -> None:
        self._end_segment(waypoint)
        self.q.append(np.array(q))
        self.waypoints.append(RouteWaypoint(waypoint.row, len(self.q) - 1, target))

    def _end_segment(self, waypoint: JointWaypoint) -> None:
        """End a joint step at the next configuration; from a free start nothing leads to it."""
        end = len(self.q)
        if end > 0:
            self.joint_steps.append(RouteJointStep(end - 1, end, segment_to(waypoint)))
            if waypoint.field:
                self.segments.append(RouteSegment(waypoint.field, end - 1, end))
