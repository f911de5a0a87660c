"""From a path of a request to the knots of one joint path: leg by leg."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import Disconnected, InvalidRequest
from ikplan.ik.arguments import check_start
from ikplan.kinematics.target import Freedom, Target, pose_target
from ikplan.path import JointLeg, JointTarget, Leg, Pose, ToolLeg, ToolPath, legs_of
from ikplan.planning.joint_route import JointPathProblem, Route, Span, Stretch, WaypointKnot
from ikplan.planning.task_freedom import counts_orientation, freedom_of
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.reference_path import stations_around
from ikplan.planning.tracking.tracked_path import TrackedPath, TrackingFailed
from ikplan.planning.tracking.tracking_failure import explain_tracking_failure
from ikplan.planning.waypoints.ik_branches import branches
from ikplan.planning.waypoints.select import choose
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem

__all__ = ["plan_joint_path"]

Array = NDArray[np.float64]


def plan_joint_path(problem: JointPathProblem) -> Route:
    """Lay a path into the joint space.

    Args:
        problem: The path.

    Returns:
        The knots of a joint path that meets every waypoint and follows every tool path.

    Raises:
        InvalidRequest: The path makes no sense.
        Unreachable: A waypoint, or a place on a tool path, has no solution.
        Disconnected: No continuous motion follows a tool path.
        TrackingFailed: The same, where a brief refusal is asked for.
        BudgetExceeded: The time budget ran out.
    """
    layer = _JointPathPlanner(problem)
    start = None
    if not problem.start_free:
        T = problem.robot.fk(problem.q_start)
        start = Pose(T.rotation.copy(), T.translation.copy())
    legs = legs_of(problem.path, start, layer.fk)
    problem.clock.expect(sum(map(_waypoint_count, legs)))
    for leg, after in zip(legs, [*legs[1:], None], strict=True):
        if isinstance(leg, JointLeg):
            layer.joint_leg(leg, after)
        else:
            layer.tool_leg(leg)
        problem.clock.advance(len(layer.wanted))
    return layer.route()


def _waypoint_count(leg: Leg) -> int:
    return len(leg.targets) if isinstance(leg, JointLeg) else len(leg.path.waypoints)


@dataclass(frozen=True)
class _Open:
    """A pose at the end of a joint leg whose branch is left to the tool path that begins there.

    Attributes:
        asked: The pose as it was asked for.
        target: The same, in the base.
        starts: Its solutions, shape (c, dof) [rad or m].
        costs: Joint motion to each, shape (c,).
    """

    asked: JointTarget
    target: Target
    starts: Array
    costs: Array


class _JointPathPlanner:
    """Lays one leg after the other."""

    def __init__(self, problem: JointPathProblem) -> None:
        self.problem = problem
        self.freedom: Freedom = freedom_of(problem.path)
        self.follower = PathTracker(
            problem.solver.arm,
            problem.limits,
            self.freedom,
            counts_orientation(problem.path),
            problem.path.tolerance,
            problem.clock,
        )
        self.knots: list[Array] = [] if problem.start_free else [problem.q_start]
        self.rest: list[int] = []
        self.wanted: list[WaypointKnot] = []
        self.spans: list[Span] = []
        self.stretches: list[Stretch] = []
        self.evaluations = 0
        self.opened: _Open | None = None

    def fk(self, q: Array) -> tuple[Array, Array]:
        """Rotation, shape (3, 3), and position, shape (3,) [m], of the tool in the base."""
        T = self.problem.robot.fk(q)
        return T.rotation.copy(), T.translation.copy()

    def route(self) -> Route:
        """The route laid."""
        wanted = sorted(self.wanted, key=lambda w: w.row)
        return Route(
            np.ascontiguousarray(self.knots),
            self.rest,
            wanted,
            self.spans,
            self.evaluations,
            self.stretches,
        )

    @property
    def _q(self) -> Array:
        return self.knots[-1] if self.knots else self.problem.q_start

    def _target(self, pose: Pose) -> Target:
        R = pose.R if counts_orientation(self.problem.path) else None
        return pose_target(pose.p, R, freedom=self.freedom)

    def joint_leg(self, leg: JointLeg, after: Leg | None) -> None:
        """Lay a joint spline; its last pose is left to a tool path that begins there."""
        targets = list(leg.targets)
        last = targets[-1]
        left_open = isinstance(after, ToolLeg) and last.q is None and self.problem.options.refine
        if left_open:
            targets.pop()
        run: list[JointTarget] = []
        for target in targets:
            if target.q is None:
                run.append(target)
                continue
            self._poses(run)
            run = []
            q = check_start(self.problem.robot, target.q, target.name)
            R, p = self.fk(q)
            self._add(q, target, pose_target(p, R))
        self._poses(run)
        if left_open and last.pose is not None:
            self._open_pose(last, last.pose)

    def _waypoint_problem(self, run: list[JointTarget]) -> WaypointProblem:
        problem = self.problem
        return WaypointProblem(
            problem.robot,
            problem.solver,
            [self._target(t.pose) for t in run if t.pose is not None],
            self._q,
            not self.knots,
            problem.path.tolerance,
            problem.clock,
            run[0].index,
            problem.brief,
        )

    def _poses(self, run: list[JointTarget]) -> None:
        """Choose the configurations of successive poses."""
        if not run:
            return
        waypoints = self._waypoint_problem(run)
        chosen = choose(waypoints, self.problem.options)
        self.evaluations += chosen.evaluations
        for target, wanted, q in zip(run, waypoints.targets, chosen.q, strict=True):
            self._add(q, target, wanted)

    def _open_pose(self, target: JointTarget, pose: Pose) -> None:
        """Offer every branch of a pose to the tool path that begins there."""
        waypoints = self._waypoint_problem([target])
        starts, spent = branches(waypoints)
        costs = np.linalg.norm(starts - self._q, axis=1)
        self.opened = _Open(target, self._target(pose), starts, costs)
        self.evaluations += spent

    def tool_leg(self, leg: ToolLeg) -> None:
        """Lay a tool path."""
        path = leg.path
        self._check_box(path)
        starts, costs = self._starts(path)
        try:
            followed = self.follower.follow(path, starts, costs)
        except TrackingFailed as lost:
            if self.problem.brief:
                raise
            verdict = explain_tracking_failure(
                self.problem.robot, self.problem.solver, self.follower, path, lost
            )
            if not isinstance(verdict, Disconnected):
                raise verdict from lost
            try:
                followed = self.follower.track_global(path, starts, costs)
            except TrackingFailed:
                raise verdict from lost
            followed = replace(followed, evaluations=followed.evaluations + lost.evaluations)
        self._append(path, followed)

    def _check_box(self, path: ToolPath) -> None:
        """Refuse a box whose axes are known on a part of the path only."""
        if not (self.freedom.boxed and self.freedom.in_tool and self.freedom.box[:3].any()):
            return
        told = [piece.oriented for piece in path.pieces] + [w.R is not None for w in path.waypoints]
        if any(told) and not all(told):
            raise InvalidRequest(
                "path.tolerance.box.frame: part of the path asks for no orientation, and with it "
                'the axes of the tool are not told for the box: choose "path"',
                field="path.tolerance.box.frame",
                allowed=["path"],
            )

    def _starts(self, path: ToolPath) -> tuple[Array, Array]:
        """Configurations that the tool path may begin at, and the joint motion to each."""
        if self.opened is not None:
            return self.opened.starts, self.opened.costs
        if self.knots:
            return self.knots[-1][None], np.zeros(1)
        R, p = path.pose(0.0)
        # What begins without an orientation may begin at a waypoint with one.
        asked = [w.R for w in path.waypoints if w.s == 0.0 and w.R is not None]
        pose = Pose(R if path.oriented(0.0) else (asked[0] if asked else None), p)
        starts, spent = branches(
            self._waypoint_problem([JointTarget(0, "the begin of the path", pose=pose)])
        )
        self.evaluations += spent
        return starts, np.zeros(len(starts))

    def _append(self, path: ToolPath, followed: TrackedPath) -> None:
        """Add the stations of a tool path; the motion rests where it begins and ends."""
        self.evaluations += followed.evaluations
        joined = bool(self.knots) and np.array_equal(self.knots[-1], followed.q[0])
        if joined:
            self.knots.pop()
        first = len(self.knots)
        if self.opened is not None:
            if not joined:
                self._end_stretch(self.opened.asked)
            self.wanted.append(WaypointKnot(self.opened.asked.index, first, self.opened.target))
            self.opened = None
        self.knots += list(followed.q)
        self.rest += [first, *(first + k for k in followed.rest), len(self.knots) - 1]
        self.spans.append(Span(path, first, followed.s))
        for waypoint, station in zip(path.waypoints, followed.waypoint, strict=True):
            pose = Pose(waypoint.R, waypoint.p)
            row = WaypointKnot(
                waypoint.index, first + int(station), self._target(pose), waypoint.exact
            )
            self.wanted.append(row)
        for stretch in path.stretches:
            begin, end = stations_around(path, followed.s, stretch.begin, stretch.end)
            self.stretches.append(Stretch(stretch.field, first + begin, first + end))

    def _add(self, q: Array, asked: JointTarget, target: Target) -> None:
        self._end_stretch(asked)
        self.knots.append(np.array(q))
        self.wanted.append(WaypointKnot(asked.index, len(self.knots) - 1, target))

    def _end_stretch(self, target: JointTarget) -> None:
        """Note that a joint segment ends at the next knot; a free start has no way to it."""
        if target.field and self.knots:
            end = len(self.knots)
            self.stretches.append(Stretch(target.field, end - 1, end))
