"""What would make a path feasible: changes of the request, each tried before it is offered."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikplan.arrays import Array, lengths_of
from ikplan.documents.limits import LimitOptions
from ikplan.documents.path import PathRequest
from ikplan.documents.poses import Frame
from ikplan.errors import (
    Disconnected,
    InCollision,
    InvalidRequest,
    TimingFailed,
    Unreachable,
)
from ikplan.ik.closest_approach import explain_unreachable
from ikplan.kinematics.forward import forward
from ikplan.kinematics.target import Target, pose_target
from ikplan.path import JointLeg, MoveLeg, Pose, ToolLeg, legs_of
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.limit_repairs import Survives, limit_repairs, offered
from ikplan.planning.plan_joint_path import plan_joint_path
from ikplan.planning.repair_kinds import (
    LONGEST_ASIDE,
    Repair,
    boxed,
    by_joint_motion,
    moved_aside,
    rounded,
    smaller_clearance,
)
from ikplan.planning.task_freedom import counts_orientation, freedom_of
from ikplan.planning.tool_leg import path_tracker
from ikplan.planning.tracking.start_copies import StartCopies, distinct_modulo_turns
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.unit_mistake import in_millimetres, name_unit_mistake
from ikplan.planning.waypoints.stack import stack_targets

__all__ = ["find_repairs"]

Refusal = Unreachable | Disconnected | InCollision | TimingFailed

_MOST_BRANCHES = 12
_SAMPLES = 12
"""Places on each tool path at which a shift of the path is tried first; of the targets that are out
of reach, how many a round of it examines."""
_ROUNDS = 8
_FARTHEST = 0.5
"""Longest shift that is offered [m]."""
_CLOSEST_RESTARTS = 10
"""Seeds, besides the start and the closest approach to the target before, from which the arm gets
as near as it can to a target that is out of reach."""
_EXACT = 1e-6
"""Error of a target that is reached after all [m and rad]."""
_FARTHER = (1.0, 1.5, 2.5)
"""How much farther than the shift that the places looked at need is tried."""


def find_repairs(
    problem: JointPathProblem,
    error: Refusal,
    survives: Survives | None = None,
    clearance: float = 0.0,
    limits: LimitOptions | None = None,
    most: int | None = None,
) -> list[dict[str, Any]]:
    """Return changes of the request that make the path feasible.

    Coordinates in millimetres where all are far beyond reach, of which the error then tells too;
    else another branch to start in, a box, rounded corners, a free tool axis, free orientation;
    for what is out of reach the smallest shift of the path frame found, else one along an axis; a
    joint motion through the waypoints; where bodies touch, a smaller clearance; where there is no
    timing, a smaller payload or the robot's own torque limits where torques bind, and a smaller
    speed of the tool: a joint path does not depend on speeds. Each kind has a fixed number of
    attempts. Every one was planned before it is offered; none is, when the time budget is used up.

    Args:
        problem: The path that has no plan.
        error: Why.
        survives: Tells whether a change still holds once it is timed, sampled and certified;
            None: a joint path is enough.
        clearance: The gap asked for between bodies [m].
        limits: The limits of the request; None: as the robot's.
        most: Ends the search once so many are found; None: never.

    Returns:
        Repairs as ``{"change": fields of the request, "detail": in words}``, one of each kind at
        most, in the order above.
    """
    quick = replace(problem, explain=False)
    kinds = _kinds(quick, error, clearance, limits or LimitOptions())
    return offered(kinds, survives, most)


def _lays(problem: JointPathProblem) -> bool:
    """Whether there is a route."""
    try:
        plan_joint_path(problem)
    except (Unreachable, Disconnected, InCollision, InvalidRequest, TrackingFailed):
        return False
    return True


def _kinds(
    problem: JointPathProblem, error: Refusal, clearance: float, limits: LimitOptions
) -> Iterator[Iterator[Repair]]:
    """Yield, kind by kind in order of price, changes with which the path was laid."""
    if isinstance(error, Unreachable) and name_unit_mistake(problem, error):
        yield _in_millimetres(problem)
        return
    if isinstance(error, TimingFailed):
        yield from limit_repairs(error, limits)
    if not isinstance(error, Unreachable):  # what is out of reach is so in every branch
        yield _other_branch(problem)
    yield boxed(problem, _lays)
    if not isinstance(error, Unreachable):  # a blend keeps what a corner cannot reach out of reach
        yield rounded(problem, _legs(problem), _lays)
    yield _free_orientation(problem)
    if not isinstance(error, Unreachable):
        yield moved_aside(problem, _moved, _lays)
    elif error.position_error <= _FARTHEST:
        yield itertools.chain(_shifted(problem), _aside(problem, error))
    if not isinstance(error, TimingFailed):
        yield by_joint_motion(problem, _lays)
    if isinstance(error, InCollision):
        yield smaller_clearance(error, clearance)


def _aside(problem: JointPathProblem, error: Unreachable) -> Iterator[Repair]:
    """A shift along an axis, where one of those tried is as long as what the arm lacks."""
    if error.position_error <= LONGEST_ASIDE:
        yield from moved_aside(problem, _moved, _lays)


def _in_millimetres(problem: JointPathProblem) -> Iterator[Repair]:
    """The coordinates as millimetres."""
    path = in_millimetres(problem.path)
    if path is not None and _lays(replace(problem, path=path)):
        kind = "waypoints" if path.waypoints is not None else "segments"
        change = path.model_dump(mode="json", include={kind, "begin"}, exclude_unset=True)
        yield Repair({"path": change}, "read the coordinates as millimetres")


def _other_branch(problem: JointPathProblem) -> Iterator[Repair]:
    """The same tool pose at the start, in another branch, where a tool path begins there."""
    leg = _legs(problem)[0]
    if problem.start_free or not isinstance(leg, ToolLeg):
        return
    arm = problem.solver.arm
    R, p = forward(arm.chain, problem.q_start)
    found = sample_ik_solutions(
        arm.chain,
        stack_targets([pose_target(p, R)]),
        np.empty((1, 0, arm.dof)),
        problem.q_start,
        arm.lower,
        arm.upper,
        40,
        100,
        0,
        0.5,
        1e-9,
        arm.closed_form,
    )
    branches = distinct_modulo_turns(arm, found.q[0, : found.counts[0]])
    order = np.argsort(lengths_of(branches - problem.q_start), kind="stable")
    tracker, copies = path_tracker(problem), StartCopies(problem.q_start, True, problem.posture)
    starts: list[Array] = []
    for q in branches[order][:_MOST_BRANCHES]:
        with contextlib.suppress(TrackingFailed):
            # Of all copies of the branch, the nearest that gets to the end of the tool path.
            tracked = tracker.track(leg.path, q[None], np.zeros(1), copies)
            starts.append(np.ascontiguousarray(tracked.q[0]))
    for q in sorted(starts, key=lambda start: float(np.linalg.norm(start - problem.q_start))):
        if np.abs(q - problem.q_start).max() < 1e-3:
            continue
        attempt = replace(problem, q_start=q)
        if _lays(attempt):
            detail = "start with the tool at the same pose in another branch of the arm"
            yield Repair({"start": q.tolist()}, detail)


def _free_orientation(problem: JointPathProblem) -> Iterator[Repair]:
    """A free tool axis, or else free orientation."""
    path = problem.path
    if path.orientation_free is not None or path.tolerance.box is not None:
        return
    document = path.model_dump(mode="json")
    freedoms: list[Any] = [{"about": f"tool_{axis}"} for axis in "zxy"]
    for freedom in [*freedoms, "all"]:
        free = PathRequest.model_validate({**document, "orientation_free": freedom})
        attempt = replace(problem, path=free)
        if _unreached(attempt, _targets(attempt)).size == 0 and _lays(attempt):
            what = (
                "any orientation" if freedom == "all" else f"a free turn about {freedom['about']}"
            )
            change = {"path": {"orientation_free": freedom}}
            yield Repair(change, f"allow {what}")


def _shifted(problem: JointPathProblem) -> Iterator[Repair]:
    """The smallest shift of the path frame found."""
    shift = np.zeros(3)
    for _ in range(_ROUNDS):
        step = _needed_shift(_moved(problem, shift))
        if step is None:
            break
        shift = shift + 1.05 * step
        if np.linalg.norm(shift) > _FARTHEST:
            return
    if not shift.any():
        return
    feasible, low = 1.0, 0.0
    # A little farther, the parts of a path that were not looked at may be within reach too.
    for farther in _FARTHER:
        if np.linalg.norm(farther * shift) <= _FARTHEST and _lays(_moved(problem, farther * shift)):
            shift = farther * shift
            break
    else:
        return
    for _ in range(5):
        middle = 0.5 * (low + feasible)
        if _lays(_moved(problem, middle * shift)):
            feasible = middle
        else:
            low = middle
    attempt = _moved(problem, feasible * shift)
    position = attempt.path.frame.position
    length = float(np.linalg.norm(feasible * shift))
    detail = f"move the path by {length * 1e3:.1f} mm in the base"
    yield Repair({"path": {"frame": {"position": position}}}, detail)


def _moved(problem: JointPathProblem, shift: Array) -> JointPathProblem:
    """The problem with its path frame moved in the base."""
    frame = problem.path.frame
    moved = Frame(
        position=[float(a + b) for a, b in zip(frame.position, shift, strict=True)],
        quaternion_xyzw=frame.quaternion_xyzw,
    )
    return replace(problem, path=problem.path.model_copy(update={"frame": moved}))


def _needed_shift(problem: JointPathProblem) -> Array | None:
    """The longest way that a target of the path is out of reach, shape (3,) [m], or None.

    A quick look from few seeds: what it passes is planned in full before it is offered.
    """
    arm = problem.solver.arm
    worst: Array | None = None
    targets = _targets(problem)
    unreached = _unreached(problem, targets)
    # The targets are along the path: where the arm is closest to one, it is near the next.
    near = problem.q_start
    # Those left out are looked at in the next round, if they are still out of reach by then.
    for k in unreached[:: -(-len(unreached) // _SAMPLES) or 1]:
        problem.clock.check()
        target = targets[k]
        closest, spent = explain_unreachable(
            arm, target, near, problem.q_start, restarts=_CLOSEST_RESTARTS
        )
        problem.clock.count(spent)
        near = closest.q
        if closest.position_error <= _EXACT and (closest.orientation_error or 0.0) <= _EXACT:
            continue
        _, p = forward(arm.chain, closest.q)
        way = p - target.p
        if worst is None or np.linalg.norm(way) > np.linalg.norm(worst):
            worst = np.asarray(way)
    return worst


def _unreached(problem: JointPathProblem, targets: list[Target]) -> NDArray[np.intp]:
    """Indices of the targets for which a quick look finds no configuration."""
    arm = problem.solver.arm
    if not targets:
        return np.zeros(0, dtype=np.int64)
    found = sample_ik_solutions(
        arm.chain,
        stack_targets(targets),
        np.empty((len(targets), 0, arm.dof)),
        problem.q_start,
        arm.lower,
        arm.upper,
        4,
        60,
        4,
        0.5,
        1e-9,
        arm.closed_form,
    )
    return np.flatnonzero(found.counts == 0)


def _legs(problem: JointPathProblem) -> list[Any]:
    def fk(q: Array) -> tuple[Array, Array]:
        R, p = forward(problem.solver.arm.chain, np.ascontiguousarray(q))
        return R, p

    start = None if problem.start_free else Pose(*fk(problem.q_start))
    return list(legs_of(problem.path, start, fk))


def _targets(problem: JointPathProblem) -> list[Target]:
    """The waypoints of the path, and places along its tool paths."""
    freedom = freedom_of(problem.path)
    counts = counts_orientation(problem.path)
    poses: list[tuple[Any, Array]] = []
    for leg in _legs(problem):
        if isinstance(leg, JointLeg):
            poses += [(t.pose.R, t.pose.p) for t in leg.waypoints if t.pose is not None]
            continue
        if isinstance(leg, MoveLeg):
            # Of several targets each may be out of reach.
            only = leg.targets[0].pose if len(leg.targets) == 1 else None
            poses += [] if only is None else [(only.R, only.p)]
            continue
        s = np.linspace(0.0, leg.path.length, _SAMPLES)
        R, p = leg.path.poses(s)
        mask = leg.path.orientation_mask(s)
        poses += [(R[k] if mask[k] else None, p[k]) for k in range(len(s))]
    return [pose_target(p, R if counts else None, freedom=freedom) for R, p in poses]
