"""Why the arm cannot track a tool path to its end."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.poses import Tolerance
from ikplan.errors import Disconnected, Unreachable
from ikplan.ik.solve import NoSolution, PoseSolver, surest_solver, unreachable
from ikplan.kinematics.target import Target
from ikplan.path import ToolPath
from ikplan.path.rotation.so3 import log
from ikplan.planning.ladder.ik_candidates import target_at
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.waypoints.unreachable import met_within
from ikplan.robots import Robot

__all__ = ["explain_tracking_failure"]


_NEXT = 2e-4
"""How far along the path the next motion is reported, at most [m]."""
_AT_LIMIT = 1e-4
"""How near to its limit a joint is at it [rad or m]."""
_SINGULAR = 0.02
"""Smallest singular value below which a configuration is near a singular one."""
_PROBES = (2e-4, 1e-3, 5e-3, 2e-2)
"""Where past the last point another solution is looked for, as shares of the path."""


def explain_tracking_failure(
    robot: Robot, solver: PoseSolver, tracker: PathTracker, path: ToolPath, failure: TrackingFailed
) -> Unreachable | Disconnected:
    """Return why a tool path cannot be tracked past the point where tracking failed.

    Unreachable where the path leaves what the arm can reach in any branch; Disconnected where
    another branch goes on, with the jump it would take.

    Args:
        robot: The robot, with its tool.
        solver: Solves single targets.
        tracker: Tracked the path.
        path: The tool path.
        failure: Where tracking failed.
    """
    before, after = _neighbours(path, failure.s)
    end = next((w.s for w in path.waypoints if w.row == after), path.length)
    where = f"{failure.s * 1e3:.1f} mm of {path.length * 1e3:.1f} mm along the path"
    target = target_at(tracker.targets_at(path, np.array([end])), 0)
    try:
        _solved(solver, target, failure.q, tracker.tolerance)
    except NoSolution as verdict:
        subject = f"waypoint {after} (the path to it is feasible for {where})"
        return unreachable(robot, verdict.closest, after, subject, target)
    ahead = [failure.s + share * path.length for share in _PROBES]
    ahead = [s for s in ahead if s < path.length] or [path.length]
    others = [] if failure.beyond is None else [failure.beyond]
    for s in ahead:
        target = target_at(tracker.targets_at(path, np.array([s])), 0)
        try:
            solution = _solved(solver, target, failure.q, tracker.tolerance)
        except NoSolution as verdict:
            subject = f"the path to waypoint {after}, from {where} on,"
            return unreachable(robot, verdict.closest, after, subject, target)
        if failure.beyond is None:
            others.append(solution)
    # The nearest solutions ahead may still be of this branch, which ends a little later.
    gap = max((other - failure.q for other in others), key=lambda gap: float(np.abs(gap).max()))
    joint = int(np.argmax(np.abs(gap)))
    reason = _cause(robot, failure.q, _next_motion(robot, tracker, path, failure))
    return Disconnected(
        f"no continuous motion leads from {_name(before)} to {_name(after)}: the arm gets to "
        f"{where}, where {reason}; going on takes another branch, {robot.joint_names[joint]} "
        f"{gap[joint]:+.3f} {'m' if robot.prismatic[joint] else 'rad'} away",
        waypoints=[before, after],
        jump=float(np.abs(gap).max()),
        reason=reason,
        q=failure.q.tolist(),
    )


def _solved(solver: PoseSolver, target: Target, q_near: Array, tolerance: Tolerance) -> Array:
    """A solution of a target, or what is within the tolerance of it.

    Raises:
        NoSolution: The target is out of reach by more than the tolerance.
    """
    solver = surest_solver(solver, target)
    try:
        return np.asarray(solver.solve(target, q_near).q[0])
    except NoSolution as verdict:
        met = met_within(solver, target, verdict, q_near, tolerance)
        if met is None:
            raise
        return met


def _name(row: int) -> str:
    return "the start" if row < 0 else f"waypoint {row}"


def _neighbours(path: ToolPath, s: float) -> tuple[int, int]:
    """Rows of the waypoints before and after a place; -1 stands for the start."""
    behind = [w.row for w in path.waypoints if w.s <= s]
    ahead = [w.row for w in path.waypoints if w.s > s]
    before = behind[-1] if behind else (ahead[0] - 1 if ahead else -1)
    return before, ahead[0] if ahead else before


def _next_motion(
    robot: Robot, tracker: PathTracker, path: ToolPath, failure: TrackingFailed
) -> Array:
    """How the joints would have to move for the next bit of the path, shape (dof,) [rad or m]."""
    s = min(failure.s + min(_NEXT, 2.0**-12 * path.length), path.length)
    target = target_at(tracker.targets_at(path, np.array([s])), 0)
    T = robot.fk(failure.q)
    R = target.R if target.oriented else T.rotation
    rows = 6 if target.oriented else 3
    twist = np.concatenate([T.rotation.T @ (target.p - T.translation), log(T.rotation.T @ R)])
    return np.asarray(np.linalg.pinv(robot.jacobian(failure.q)[:rows], rcond=1e-6) @ twist[:rows])


def _cause(robot: Robot, q: Array, dq: Array) -> str:
    """What holds the arm: a joint limit, in reach of the motion dq, or a singularity."""
    smallest = float(np.linalg.svd(robot.jacobian(q), compute_uv=False)[-1])
    near = f"the smallest singular value is {smallest:.2g}"
    singular = smallest < _SINGULAR
    ahead = np.zeros(robot.dof) if singular else dq  # by a singularity it is without bounds
    held = [
        name
        for name, value, step, lower, upper in zip(
            robot.joint_names, q, ahead, robot.lower, robot.upper, strict=True
        )
        if min(value, value + step) <= lower + _AT_LIMIT
        or max(value, value + step) >= upper - _AT_LIMIT
    ]
    if held:
        is_at = "is at its" if len(held) == 1 else "are at their"
        return f"{', '.join(held)} {is_at} limit ({near})"
    return f"it is singular: {near}" if singular else f"its branch ends ({near})"
