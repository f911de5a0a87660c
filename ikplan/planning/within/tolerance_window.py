"""A short part of a path on which the tool leaves it within the tolerance.

Near a singularity exact tracking asks for joint motions without bounds, or ends. Between a
configuration before the place and one behind it, both on the path, the joints are led evenly
instead, as evenly as the errors of the points between allow
(see :mod:`ikplan.planning.within.even_motion`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.track_from import TrackedPart
from ikplan.planning.tracking.tracked_arm import TrackedArm
from ikplan.planning.tracking.tracking_kernels import errors_at
from ikplan.planning.within.even_motion import evened_motion
from ikplan.planning.within.window_kernels import linearised_errors

__all__ = ["Window", "bridge", "error_ratios", "led_between", "near_singular", "project_within"]


_WIDTHS = tuple(2.5e-4 * 2.0**k for k in range(10))
"""How far before and behind the place a window reaches [m]."""
_STEPS = 32
"""Steps of a window."""
_ACCEPTED = 0.85
"""Largest ratio of an error at a point of a window to the tolerance."""
_EVENNESS = tuple(10.0**k for k in range(12, 0, -1))
"""What evenness weighs against the errors, one after the other."""
_LONGER = 1.02
"""How much longer a more exact motion may be than the first that is within the tolerance."""
_GATE = 0.8
"""How far apart the ends of a window may be in a joint [rad or m]."""
_CANDIDATES, _SEEDS, _TRIED = 24, 40, 3
_SINGULAR = 0.05
"""Smallest singular value below which a configuration is near a singular one."""


@dataclass(frozen=True)
class Window:
    """A part of a path that is tracked within the tolerance only.

    Attributes:
        first: Index of the tracked point at which it begins.
        s: Path positions, from that of this point on, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
    """

    first: int
    s: Array
    q: Array


def near_singular(tracked: TrackedArm, reference: ReferencePath, s: float, q: Array) -> bool:
    """Return whether a configuration, shape (dof,), is near a singular one of its task."""
    at = tracked.targets_at(reference, np.array([s]))
    _, J = linearised_errors(tracked.arm.chain, at, q[None])
    J[0, 3:] /= max(float(at.weight[0]), 1e-9)
    rows = J[0][np.abs(J[0]).max(axis=1) > 0.0]
    values = np.linalg.svd(rows, compute_uv=False)
    return bool(values.min(initial=np.inf) < _SINGULAR)


def error_ratios(tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array) -> Array:
    """Return the ratio of each configuration's error to the tolerance, shape (m,)."""
    distance, angle = errors_at(tracked.arm.chain, tracked.targets_at(reference, s), q)
    tolerance = tracked.tolerance
    return np.maximum(distance / tolerance.position, angle / tolerance.orientation)


def project_within(
    tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array, most: float
) -> Array:
    """Return configurations brought just within the tolerance, with little joint motion.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        s: Path positions, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
        most: Largest ratio of the error to the tolerance that needs no step.
    """
    q, targets = q.copy(), tracked.targets_at(reference, s)
    damping = (0.05 * tracked.tolerance.position) ** 2
    for _ in range(8):
        over = np.flatnonzero(error_ratios(tracked, reference, s, q) > most)
        if len(over) == 0:
            break
        e, J = linearised_errors(tracked.arm.chain, targets, q)
        for k in over:
            A = J[k] @ J[k].T + damping * np.eye(6)
            q[k] += 0.5 * J[k].T @ np.linalg.solve(A, e[k])
        q = np.ascontiguousarray(np.clip(q, tracked.arm.lower, tracked.arm.upper))
    return q


def bridge(tracked: TrackedArm, reference: ReferencePath, part: TrackedPart) -> Window | None:
    """Return a window over the place where exact tracking ends, None where none was found.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        part: The path as far as it was tracked.
    """
    place = float(part.s[-1])
    corners = np.concatenate([[0.0], reference.corners, [reference.length]])
    low = float(corners[corners <= place].max())
    above = corners[corners > place]
    if len(above) == 0:
        return None
    found: list[tuple[float, Window]] = []
    done: set[tuple[int, float]] = set()
    for width in _WIDTHS:
        behind = min(place + width, float(above.min()))
        inside = np.flatnonzero(part.s <= max(place - width, low, float(part.s[0])))
        first = int(inside[-1])
        if part.s[first] < low or (first, behind) in done:
            continue
        done.add((first, behind))
        tracked.clock.check()
        for q_behind in _behind(tracked, reference, part, first, behind):
            led = led_between(
                tracked, reference, (float(part.s[first]), behind), part.q[first], q_behind
            )
            if led is not None:
                window = Window(first, *led)
                found.append((_cost(part, window, place + _WIDTHS[-1]), window))
                break
    return min(found, key=lambda rated: rated[0])[1] if found else None


def _cost(part: TrackedPart, window: Window, end: float) -> float:
    """Joint motion up to a common end, which is gone on to as fast as over the window."""
    until = _length(part.q[: window.first + 1]) + _length(window.q)
    way = float(window.s[-1] - window.s[0])
    on = float(np.linalg.norm(window.q[-1] - window.q[0])) / way
    return until + max(end - float(window.s[-1]), 0.0) * on


def _length(q: Array) -> float:
    return joint_path_length(np.ascontiguousarray(q), np.ascontiguousarray(q[0]), True)


def _behind(
    tracked: TrackedArm, reference: ReferencePath, part: TrackedPart, first: int, s: float
) -> Iterator[Array]:
    """Configurations on the path behind the place, those nearest to going straight on first."""
    q = part.q[first]
    seeds = [q, part.q[-1]]
    if first >= 2 and part.s[first] > part.s[first - 2]:
        ahead = (s - part.s[first]) / (part.s[first] - part.s[first - 2])
        seeds.append(q + ahead * (q - part.q[first - 2]))
    arm = tracked.arm
    solutions = sample_ik_solutions(
        arm.chain,
        tracked.targets_at(reference, np.array([s])),
        np.ascontiguousarray(np.clip(np.array(seeds), arm.lower, arm.upper))[None],
        np.ascontiguousarray(q),
        arm.lower,
        arm.upper,
        _CANDIDATES,
        _SEEDS,
        0,
        0.5,
        min(tracked.met),
    )
    rows = solutions.q[0, : int(solutions.counts[0])]
    away = np.abs(rows - seeds[-1]).max(axis=1, initial=0.0)
    apart = np.abs(rows - q).max(axis=1, initial=0.0)
    for k in np.argsort(np.minimum(away, apart), kind="stable")[:_TRIED]:
        if min(away[k], apart[k]) <= _GATE:
            yield rows[k]


def led_between(
    tracked: TrackedArm,
    reference: ReferencePath,
    span: tuple[float, float],
    q_begin: Array,
    q_end: Array,
    steps: int = _STEPS,
) -> tuple[Array, Array] | None:
    """Lead the joints from one configuration to another as evenly as the tolerance allows.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        span: The path positions of the two.
        q_begin: Where the motion begins, shape (dof,) [rad or m].
        q_end: Where it ends, shape (dof,) [rad or m].
        steps: How many; waypoints between are met besides.

    Returns:
        Path positions, shape (m,), and configurations, shape (m, dof) [rad or m]; None where
        the motions tried are not within the tolerance.
    """
    s = np.linspace(*span, steps + 1)
    inside = reference.waypoint_s[(reference.waypoint_s > s[0]) & (reference.waypoint_s < s[-1])]
    s = np.unique(np.concatenate([s, inside]))
    share = ((s - s[0]) / (s[-1] - s[0]))[:, None]
    q = np.ascontiguousarray(q_begin + share * (q_end - q_begin))
    arm, tolerance = tracked.arm, tracked.tolerance
    found = evened_motion(
        arm.chain, tracked.targets_at(reference, s), q, arm.lower, arm.upper, np.array(_EVENNESS),
        tolerance.position, tolerance.orientation, _ACCEPTED, _LONGER,
    )  # fmt: skip
    return (s, q) if found else None
