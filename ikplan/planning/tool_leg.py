"""Tracking one tool path: what is tried in turn, and what is refused."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, lengths_of
from ikplan.collision.check import ContactCheck
from ikplan.errors import (
    BudgetExceeded,
    Disconnected,
    InCollision,
    InvalidRequest,
    NoPlan,
    Unreachable,
)
from ikplan.kinematics.target import Freedom, Target
from ikplan.path import JointWaypoint, MoveLeg, ToolPath
from ikplan.path.tolerance_shares import exact_tracking
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.segment_number import segment_number
from ikplan.planning.task_freedom import counts_orientation, freedom_of
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.start_copies import StartCopies
from ikplan.planning.tracking.tracked_path import TrackedPath, TrackingFailed, in_contact
from ikplan.planning.tracking.tracking_failure import explain_tracking_failure
from ikplan.planning.waypoints.ik_branches import branches, further_branches
from ikplan.planning.waypoints.in_collision import motion_in_collision
from ikplan.planning.waypoints.waypoint_problem import WaypointProblem
from ikplan.planning.within.tolerant_tracker import TolerantTracker

__all__ = [
    "OpenPose",
    "StartingWays",
    "check_box",
    "path_tracker",
    "reached",
    "track_after",
    "track_tool_path",
]

_SAME_BRANCH = 1e-6
"""Configurations nearer to each other than this are one branch [rad or m]."""


@dataclass(frozen=True)
class OpenPose:
    """A pose at the end of a joint leg or a move whose branch is left to the tool path after it.

    Attributes:
        waypoint: The waypoint there.
        target: Its target.
        starts: Its solutions, shape (c, dof) [rad or m].
        costs: Joint motion to each, shape (c,).
        problem: The problem of the pose.
        move: The move that ends there; None: a joint leg.
        copies: Which full turns of them may be taken instead; None: they are among the starts.
    """

    waypoint: JointWaypoint
    target: Target
    starts: Array
    costs: Array
    problem: WaypointProblem
    move: MoveLeg | None = None
    copies: StartCopies | None = None


@dataclass(frozen=True)
class StartingWays:
    """How a tool path may begin.

    Attributes:
        starts: Configurations at its begin, shape (c, dof), c >= 1 [rad or m].
        costs: Joint motion already spent to get to each, shape (c,).
        copies: Which full turns of them may be taken instead; None: none.
        problem: The problem that they solve; None: where the motion before ends.
    """

    starts: Array
    costs: Array
    copies: StartCopies | None
    problem: WaypointProblem | None

    def without(self, q: Array) -> StartingWays:
        """Return the ways that do not begin in the branch nearest to a configuration."""
        away = np.abs(self.starts - q).max(axis=1)
        left = away > _SAME_BRANCH
        left[int(np.argmin(away))] = False
        starts = np.ascontiguousarray(self.starts[left])
        return replace(self, starts=starts, costs=self.costs[left])


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
        closeness=problem.closeness,
        exact_share=exact_tracking(problem.rounding),
    )


def track_tool_path(
    problem: JointPathProblem, tracker: TolerantTracker, path: ToolPath, ways: StartingWays
) -> TrackedPath:
    """Track a tool path exactly, else on a sequence chosen as a whole, else within the tolerance.

    Args:
        problem: The path of the request.
        tracker: Tracks it.
        path: The tool path.
        ways: How it may begin.

    Raises:
        Unreachable: Part of the path has no solution.
        Disconnected: No continuous motion follows it.
        InCollision: All that was found is in contact.
        TrackingFailed: One of these, where the problem asks for no explanation.
        BudgetExceeded: The time budget ran out; where another way was looked for after a verdict,
            it carries that in words.
    """
    starts, costs, copies = ways.starts, ways.costs, ways.copies
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
            with contextlib.suppress(TrackingFailed), _telling(verdict):
                return tracker.track_global(path, starts, costs)
            # Whatever is wrong with further starts, the verdict is on those tried first.
            nothing = contextlib.suppress(TrackingFailed, Unreachable, InCollision)
            with nothing, _telling(verdict):
                return _track_from_more(tracker, path, ways)
    if failure.contact is None:
        with contextlib.suppress(TrackingFailed), _telling(verdict):
            return tracker.track_within(path, starts, costs, copies)
    if verdict is None:
        verdict = _verdict(problem, tracker, path, failure)
    if isinstance(verdict, Disconnected):
        verdict = _held_by_contact(problem, tracker, path, ways) or verdict
    raise verdict from failure


def _track_from_more(tracker: TolerantTracker, path: ToolPath, ways: StartingWays) -> TrackedPath:
    """Track a tool path from more of the solutions of its begin than were tried at first.

    Those of a redundant arm are a continuum, of which a few tell where the branches are; that a
    joint comes to its limit near the end of the path, others along its self-motion avoid.

    Raises:
        TrackingFailed: None of them leads to the end either.
        Unreachable: None was found.
        InCollision: All that were found are in contact.
        BudgetExceeded: The time budget ran out.
    """
    if ways.problem is None:
        raise TrackingFailed(0.0, ways.starts[0])
    more = further_branches(ways.problem, ways.starts)
    if len(more) == 0:
        raise TrackingFailed(0.0, ways.starts[0])
    more = more[tracker.farthest_starts(path, more, ways.copies)]
    costs = np.zeros(len(more))
    if ways.costs.any():
        costs = lengths_of(more - ways.problem.q_start)
    return tracker.track(path, more, costs, ways.copies)


@contextlib.contextmanager
def _telling(verdict: NoPlan | None) -> Iterator[None]:
    """Say what was known, where the time budget runs out in the search for a way around it."""
    try:
        yield
    except BudgetExceeded as over:
        if verdict is None:
            raise
        raise BudgetExceeded(
            f"{over.detail}. Until then: {verdict.detail}",
            stage=over.stage,
            budget_s=over.budget_s,
            best=over.best,
        ) from verdict


def _held_by_contact(
    problem: JointPathProblem, tracker: TolerantTracker, path: ToolPath, ways: StartingWays
) -> InCollision | None:
    """The contact without which the path would be tracked from a start; None: there is none.

    Starts in contact are not tracked from, and those left may end at a singularity.
    """
    contact = problem.contact
    if contact is None or ways.problem is None:
        return None
    unchecked = replace(tracker, contact=None)
    every = branches(replace(ways.problem, contact=None))
    costs = lengths_of(every - ways.problem.q_start)
    try:
        tracked = unchecked.track(path, every, costs, ways.copies)
    except TrackingFailed:
        return None
    met = tracker.first_contact(path, tracked.s, tracked.q)
    if met is None:
        return None
    return _in_contact(contact, path, in_contact(met, tracked.s))


def track_after(
    problem: JointPathProblem,
    tracker: TolerantTracker,
    path: ToolPath,
    ways: StartingWays,
    opened: OpenPose | None,
) -> TrackedPath:
    """Track a tool path; after a move, from any full turn of its goals where these do not do.

    Args:
        problem: The path of the request.
        tracker: Tracks it.
        path: The tool path.
        ways: How it may begin.
        opened: The pose at which it begins, if its branch is open.

    Raises:
        Unreachable: As :func:`track_tool_path`, and so the others.
        Disconnected: As there.
        InCollision: As there.
        TrackingFailed: As there.
        BudgetExceeded: As there.
    """
    try:
        return track_tool_path(problem, tracker, path, ways)
    except (Unreachable, Disconnected, InCollision, TrackingFailed) as failure:
        if opened is None or opened.move is None:
            raise
        # The goals are the nearest ones; a long path may need a turn that none of them has.
        every, q_from = branches(opened.problem), opened.problem.q_start
        copies = StartCopies(q_from, True, problem.posture)
        turned = StartingWays(every, problem.away(every, q_from), copies, opened.problem)
        try:
            return track_tool_path(problem, tracker, path, turned)
        except (Unreachable, Disconnected, InCollision, TrackingFailed):
            raise failure from None


def _verdict(
    problem: JointPathProblem, tracker: PathTracker, path: ToolPath, failure: TrackingFailed
) -> NoPlan:
    """Why a tool path cannot be tracked to its end."""
    if failure.contact is None or problem.contact is None:
        return explain_tracking_failure(problem.robot, problem.solver, tracker, path, failure)
    return _in_contact(problem.contact, path, failure)


def _in_contact(contact: ContactCheck, path: ToolPath, failure: TrackingFailed) -> InCollision:
    """The verdict on a tool path that was tracked up to a contact."""
    assert failure.contact is not None
    after = next((w.row for w in path.waypoints if w.s >= failure.s), path.waypoints[-1].row)
    where = f"{failure.s * 1e3:.1f} mm of {path.length * 1e3:.1f} mm along the path"
    part = next((x for x in path.segments if x.begin <= failure.s <= x.end), None)
    segment = None if part is None else segment_number(part.field)
    subject = f"the path to waypoint {after}, {where}"
    return motion_in_collision(contact, failure.contact, after, subject, segment)


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
