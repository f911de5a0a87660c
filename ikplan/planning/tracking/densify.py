"""Stations along a tool path, as many as keep the joint spline through them on it."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest
from ikplan.joint_path import JointPath
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.path_deviation import deviation_ratios
from ikplan.planning.tracking.reference_path import ReferencePath, rest_stations, turn_between
from ikplan.planning.tracking.tracked_arm import EXACT, MOST_STATIONS, TrackedArm
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.tracking.tracking_kernels import project_onto_targets

__all__ = ["densify"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_JUMP, _JUMP_STEP, _JUMP_TURN = 2.0**-20, 1e-6, 1e-4
"""A joint motion on less than this share of the path, this length [m] and this turn [rad], that is
not on the path is a jump."""
_DEVIATION_SHARE = 0.5
"""Share of the tolerance that the joint spline may use up."""


def densify(
    led: TrackedArm, guide: ReferencePath, s: Array, q: Array
) -> tuple[Array, Array, list[int], int]:
    """Add stations until the joint spline through them stays on the path.

    Args:
        led: The arm, and what it has to keep.
        guide: The path.
        s: Path positions of the stations, shape (m,).
        q: Their configurations, shape (m, dof) [rad or m].

    Returns:
        Path positions, configurations, the indices of the stations where the motion rests, and
        evaluations spent.

    Raises:
        TrackingFailed: Between two stations the joints jump, or no configuration is on the path.
        InvalidRequest: The path takes more stations than there may be.
        BudgetExceeded: The time budget ran out.
    """
    targets_at = functools.partial(led.targets_at, guide)
    evaluations = 0
    while True:
        led.clock.check()
        rest = rest_stations(guide, s)
        path = JointPath.through(q, led.limits, rest_at=rest)
        off, spent = deviation_ratios(
            led.arm.chain, guide, targets_at, s, path, led.tolerance, _DEVIATION_SHARE
        )
        evaluations += spent
        wide = np.flatnonzero(off > _DEVIATION_SHARE)
        if len(wide) == 0:
            return s, q, rest, evaluations
        if len(s) > MOST_STATIONS:
            raise InvalidRequest(
                f"path: more than {MOST_STATIONS} joint stations are needed to keep the tool "
                f"within {led.tolerance.position:.6g} m and "
                f"{led.tolerance.orientation:.6g} rad of it; allow more, or send the path in "
                "parts",
                field="path.tolerance",
            )
        steps = s[wide + 1] - s[wide]
        at = int(wide[np.argmin(steps)])
        still = steps.min() < min(_JUMP * guide.length, _JUMP_STEP)
        if still and led.oriented:
            still = turn_between(guide, s[at], s[at + 1]) < _JUMP_TURN
        if still:
            # The joints move, the tool does not: a jump that the first steps went over.
            raise TrackingFailed(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
        middle, q_middle, bad, spent = _between(led, targets_at, s, path, wide)
        evaluations += spent
        if len(bad):
            at = int(bad[0])
            raise TrackingFailed(float(s[at]), q[at].copy(), evaluations, q[at + 1].copy())
        order = np.argsort(np.concatenate([s, middle]), kind="stable")
        s = np.concatenate([s, middle])[order]
        q = np.ascontiguousarray(np.vstack([q, q_middle])[order])


def _between(
    led: TrackedArm, targets_at: Callable[[Array], Targets], s: Array, path: JointPath, steps: Index
) -> tuple[Array, Array, Index, int]:
    """Find a station within each of some steps, about its middle.

    Returns:
        Path positions, configurations, the steps without one, and evaluations spent.
    """
    knots, lower, upper = path.s_waypoints, led.arm.lower, led.arm.upper
    middle, q = np.empty(len(steps)), np.empty((len(steps), led.arm.dof))
    evaluations, left = 0, np.arange(len(steps))
    # Where there is none in the very middle, as when just there the arm is singular: beside it.
    for share in (0.5, 0.4, 0.6):
        k = steps[left]
        middle[left] = s[k] + share * (s[k + 1] - s[k])
        tried = np.clip(path(knots[k] + share * (knots[k + 1] - knots[k])), lower, upper)
        off, spent = project_onto_targets(
            led.arm.chain, targets_at(middle[left]), tried, lower, upper
        )
        q[left] = tried
        evaluations += spent
        left = left[off > EXACT]
        if len(left) == 0:
            break
    return middle, q, steps[left], evaluations
