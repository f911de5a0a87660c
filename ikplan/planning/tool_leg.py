"""Tracking one tool path: what is tried in turn, and what is refused."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.check import ContactCheck
from ikplan.errors import Disconnected, InCollision, InvalidRequest, NoPlan
from ikplan.kinematics.target import Freedom, Target
from ikplan.path import JointWaypoint, MoveLeg, ToolPath
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.segment_number import segment_number
from ikplan.planning.task_freedom import counts_orientation, freedom_of
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.tracking.tracked_path import TrackedPath, TrackingFailed
from ikplan.planning.tracking.tracking_failure import explain_tracking_failure
from ikplan.planning.waypoints.in_collision import motion_in_collision
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.planning.within.tolerant_tracker import TolerantTracker

__all__ = ["OpenPose", "check_box", "path_tracker", "reached", "track_tool_path"]


@dataclass(frozen=True)
class OpenPose:
    """A pose at the end of a joint leg or a move whose branch is left to the tool path after it.

    Attributes:
        waypoint: The waypoint there.
        target: Its target.
        starts: Its solutions, shape (c, dof) [rad or m].
        costs: Joint motion to each, shape (c,).
        move: The move that ends there; None: a joint leg.
        copies: Which full turns of them may be taken instead; None: they are among the starts.
        problem: The problem of the pose, at the end of a joint leg.
    """

    waypoint: JointWaypoint
    target: Target
    starts: Array
    costs: Array
    move: MoveLeg | None = None
    copies: StartCopies | None = None
    problem: WaypointProblem | None = None


def path_tracker(problem: JointPathProblem) -> TolerantTracker:
    """Return what tracks the tool paths of a problem."""
    return TolerantTracker(
        problem.solver.arm,
        problem.limits,
        freedom_of(problem.path),
        counts_orientation(problem.path),
        problem.path.tolerance,
        problem.clock,
        problem.contact,
        posture=problem.posture,
    )


def track_tool_path(
    problem: JointPathProblem,
    tracker: TolerantTracker,
    path: ToolPath,
    starts: Array,
    costs: Array,
    copies: StartCopies | None,
) -> TrackedPath:
    """Track a tool path exactly, else on a sequence chosen as a whole, else within the tolerance.

    Args:
        problem: The path of the request.
        tracker: Tracks it.
        path: The tool path.
        starts: Configurations that it may begin at, shape (c, dof), c >= 1 [rad or m].
        costs: Joint motion already spent to get to each, shape (c,).
        copies: Which full turns of them may be taken instead; None: none.

    Raises:
        Unreachable: Part of the path has no solution.
        Disconnected: No continuous motion follows it.
        InCollision: All that was found is in contact.
        TrackingFailed: One of these, where the problem asks for no explanation.
        BudgetExceeded: The time budget ran out.
    """
    try:
        return tracker.track(path, starts, costs, copies)
    except TrackingFailed as error:
        if not problem.explain:
            raise
        failure = error
    verdict: NoPlan | None = None
    if tracker.redundant(path):
        verdict = _verdict(problem, tracker, path, failure)
        if isinstance(verdict, Disconnected | InCollision):
            with contextlib.suppress(TrackingFailed):
                return tracker.track_global(path, starts, costs)
    if failure.contact is None:
        with contextlib.suppress(TrackingFailed):
            return tracker.track_within(path, starts, costs, copies)
    if verdict is None:
        verdict = _verdict(problem, tracker, path, failure)
    raise verdict from failure


def _verdict(
    problem: JointPathProblem, tracker: PathTracker, path: ToolPath, failure: TrackingFailed
) -> NoPlan:
    """Why a tool path cannot be tracked to its end."""
    if failure.contact is None or problem.contact is None:
        return explain_tracking_failure(problem.robot, problem.solver, tracker, path, failure)
    after = next((w.row for w in path.waypoints if w.s >= failure.s), path.waypoints[-1].row)
    where = f"{failure.s * 1e3:.1f} mm of {path.length * 1e3:.1f} mm along the path"
    part = next((x for x in path.segments if x.begin <= failure.s <= x.end), None)
    segment = None if part is None else segment_number(part.field)
    subject = f"the path to waypoint {after}, {where}"
    return motion_in_collision(problem.contact, failure.contact, after, subject, segment)


def check_box(freedom: Freedom, path: ToolPath) -> None:
    """Refuse a box whose axes are known on a part of the path only.

    Raises:
        InvalidRequest: They are.
    """
    if not (freedom.boxed and freedom.in_tool and freedom.box[:3].any()):
        return
    told = [piece.oriented for piece in path.pieces] + [w.R is not None for w in path.waypoints]
    if any(told) and not all(told):
        raise InvalidRequest(
            "path.tolerance.box.frame: part of the path asks for no orientation, and with it "
            'the axes of the tool are not told for the box: choose "path"',
            field="path.tolerance.box.frame",
            allowed=["path"],
        )


def reached(
    contact: ContactCheck,
    q_from: Array,
    starts: Array,
    waypoint: JointWaypoint,
    segment: int | None,
) -> Array:
    """Return those of configurations to which the straight joint motion is free of contact.

    Args:
        contact: Refuses motions in contact.
        q_from: Where the motion begins, shape (dof,) [rad or m].
        starts: The configurations, shape (c, dof), c >= 1 [rad or m].
        waypoint: The waypoint that they meet.
        segment: Number of the segment that ends there; None: not known.

    Raises:
        InCollision: There is none; names the pair that the motion to the first meets.
    """
    met = [contact.first_contact(np.vstack([q_from, q]), segment) for q in starts]
    free = [k for k, found in enumerate(met) if found is None]
    if not free and (first := met[0]) is not None:
        subject = f"the joint motion to {waypoint.name}"
        raise motion_in_collision(contact, first, waypoint.row, subject, segment)
    return np.ascontiguousarray(starts[free])
