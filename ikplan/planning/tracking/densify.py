"""Path points along a tool path, as many as keep the joint spline through them on it."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.planning.tracking.path_deviation import deviation_ratios
from ikplan.planning.tracking.reference_path import ReferencePath, rest_points, turn_between
from ikplan.planning.tracking.tolerance_bounds import has_bounds
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm, most_points
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.tracking.tracking_kernels import project_onto_targets
from ikplan.planning.within.tolerance_window import error_ratios, project_within
from ikplan.planning.within.track_within import SpanList

__all__ = ["densify"]


_JUMP, _JUMP_STEP, _JUMP_TURN = 2.0**-20, 1e-6, 1e-4
"""A joint motion on less than this share of the path, this length [m] and this turn [rad], that is
not on the path is a jump."""
_INSIDE_WINDOW = 0.8
"""Ratio of the error to the tolerance to which points added in a window are brought."""
_ON_PATH = 1e-3
"""Ratio of a point's error to the tolerance up to which it counts as exact."""
_BESIDE = 8
"""A point more changes the spline in so many steps on either side; beyond, by 1e-4 of that."""


def densify(
    tracked: TrackedArm,
    reference: ReferencePath,
    s: Array,
    q: Array,
    windows: SpanList | None = None,
) -> tuple[Array, Array, list[int]]:
    """Add points until the joint spline through them stays on the path.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        s: Path positions of the points, shape (m,).
        q: Their configurations, shape (m, dof) [rad or m].
        windows: Parts of the path on which the points are within the tolerance only.

    Returns:
        Path positions, configurations, and the indices of the points where the motion rests.

    Raises:
        TrackingFailed: Between two points the joints jump, or no configuration is on the path.
        InvalidRequest: The path takes more points than there may be.
        BudgetExceeded: The time budget ran out.
    """
    most = most_points(len(s))
    beside: Indices | None = None
    while True:
        tracked.clock.check()
        rest = rest_points(reference, s)
        path = JointPath.through(q, tracked.limits, rest_at=rest)
        wide = _wide_steps(tracked, reference, s, q, path, windows or [], beside)
        if len(wide) == 0 and beside is not None:
            wide = _wide_steps(tracked, reference, s, q, path, windows or [], None)
        if len(wide) == 0:
            return s, q, rest
        if len(s) > most:
            raise InvalidRequest(
                f"path: more than {most} path points are needed to keep the tool "
                f"within {tracked.tolerance.position:.6g} m and "
                f"{tracked.tolerance.orientation:.6g} rad of it; allow more, or send the path in "
                "parts",
                field="path.tolerance",
            )
        lengths = s[wide + 1] - s[wide]
        at = int(wide[np.argmin(lengths)])
        still = lengths.min() < min(_JUMP * reference.length, _JUMP_STEP)
        if still and tracked.oriented:
            still = turn_between(reference, s[at], s[at + 1]) < _JUMP_TURN
        if still:
            # The joints move, the tool does not: a jump that the first steps went over.
            raise TrackingFailed(float(s[at]), q[at].copy(), q[at + 1].copy())
        middle, q_middle, bad = _between(tracked, reference, s, path, wide, windows or [])
        if len(bad):
            at = int(bad[0])
            raise TrackingFailed(float(s[at]), q[at].copy(), q[at + 1].copy())
        order = np.argsort(np.concatenate([s, middle]), kind="stable")
        beside = _beside(np.flatnonzero(order >= len(s)), len(order))
        s = np.concatenate([s, middle])[order]
        q = np.ascontiguousarray(np.vstack([q, q_middle])[order])


def _wide_steps(
    tracked: TrackedArm,
    reference: ReferencePath,
    s: Array,
    q: Array,
    path: JointPath,
    windows: SpanList,
    steps: Indices | None,
) -> Indices:
    """Return the steps in which the joint spline leaves the path, of some or, closely, of all."""
    off, spent = deviation_ratios(
        tracked.arm.chain,
        reference,
        functools.partial(tracked.targets_at, reference),
        s,
        path,
        tracked.tolerance,
        tracked.deviation_share,
        bounded=has_bounds(tracked.freedom),
        steps=steps,
    )
    tracked.clock.count(spent)
    looked = np.arange(len(s) - 1) if steps is None else steps
    return looked[off > _allowed(tracked, reference, s, q, windows)[looked]]


def _beside(points: Indices, count: int) -> Indices:
    """Return the steps beside some of so many points, each by the point it begins at."""
    change = np.zeros(count + 1, dtype=np.int64)
    np.add.at(change, np.maximum(points - _BESIDE, 0), 1)
    np.add.at(change, np.minimum(points + _BESIDE, count), -1)
    return np.flatnonzero(np.cumsum(change[: count - 1]) > 0)


def _allowed(
    tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array, windows: SpanList
) -> Array:
    """Largest ratio of the deviation to the tolerance in each step: more where it is needed."""
    if not tracked.within:
        return np.full(len(s) - 1, tracked.deviation_share)
    off = error_ratios(tracked, reference, s, q) > _ON_PATH
    needed = off[1:] | off[:-1]
    for begin, end in windows:
        needed |= (s[:-1] >= begin) & (s[1:] <= end)
    return np.where(needed, tracked.deviation_share, replace(tracked, within=False).deviation_share)


def _between(
    tracked: TrackedArm,
    reference: ReferencePath,
    s: Array,
    path: JointPath,
    steps: Indices,
    windows: SpanList,
) -> tuple[Array, Array, Indices]:
    """Find a point within each of some steps, about its middle.

    Returns:
        Path positions, configurations, and the steps without one.
    """
    s_points, lower, upper = path.s_waypoints, tracked.arm.lower, tracked.arm.upper
    middle, q = np.empty(len(steps)), np.empty((len(steps), tracked.arm.dof))
    left = np.arange(len(steps))
    # Where there is none in the very middle, as when just there the arm is singular: beside it.
    for share in (0.5, 0.4, 0.6):
        k = steps[left]
        middle[left] = s[k] + share * (s[k + 1] - s[k])
        tried = np.clip(path(s_points[k] + share * (s_points[k + 1] - s_points[k])), lower, upper)
        free = np.array([any(a <= at <= b for a, b in windows) for at in middle[left]], dtype=bool)
        exact = tried.copy()
        off, spent = project_onto_targets(
            tracked.arm.chain, tracked.targets_at(reference, middle[left]), exact, lower, upper
        )
        if free.any():
            tried[free] = project_within(
                tracked, reference, middle[left][free], tried[free], _INSIDE_WINDOW
            )
        tried[~free] = exact[~free]
        q[left] = tried
        tracked.clock.count(spent)
        met = off <= EXACT
        if tracked.within:
            ratio = error_ratios(tracked, reference, middle[left], tried)
            met = ratio <= tracked.deviation_share
        left = left[~met]
        if len(left) == 0:
            break
    return middle, q, steps[left]
