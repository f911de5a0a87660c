"""When the points of a program are due, and where its corners are put."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.plans.programs.certificate import ProgramInterpolation
from ikplan.plans.programs.interpolation import blend_times, interpolate

__all__ = ["outwards", "slowed", "whole_microseconds"]

_ROUNDS = 12
_CLOSE = 1e-3
# How fast the slowing of steps fades along the motion [1/s].
_TAPER = 0.3
_PASSES = 6


def slowed(
    kind: ProgramInterpolation,
    due: Array,
    points: Array,
    limits: tuple[Array, Array],
    shortest: float = 0.0,
) -> Array:
    """Return times at which the motion keeps its limits, shape (n,) [s].

    Steps in which a speed or an acceleration is too high get longer, and those near them less
    so; what is left of an excess slows all steps alike. Where that alone takes less time, it is all
    that is done.

    Args:
        kind: What the controller does between points.
        due: When each point is due, shape (n,), the first at 0 [s].
        points: The points, shape (n, dof) [rad or m].
        limits: Joint velocities and accelerations, shape (dof,) each.
        shortest: Least time of a step [s].
    """
    tries = [due]
    h = np.diff(due)
    for _ in range(_ROUNDS):
        excess = np.maximum(_excess(kind, _from_steps(h), points, limits), shortest / h)
        if excess.max() <= 1.0 + _CLOSE:
            break
        h = h * np.exp(_spread(np.log(np.maximum(excess, 1.0)), h))
    tries.append(_from_steps(h))
    return min(
        (_whole(kind, times, points, limits, shortest) for times in tries),
        key=lambda t: float(t[-1]),
    )


def whole_microseconds(
    kind: ProgramInterpolation, due: Array, points: Array, limits: tuple[Array, Array]
) -> Array:
    """Return times whose steps are whole microseconds, at which the motion keeps its limits."""
    slow, more = due, 1e-5
    for _ in range(_ROUNDS):
        times = _from_steps(np.ceil(np.diff(slow) * 1e6 - 1e-3) / 1e6)
        kept = _whole(kind, times, points, limits)
        if kept is times:
            return times
        # Rounded again, steps of a few milliseconds may exceed the limits anew: twice as much.
        slow, more = kept * (1.0 + more), 2.0 * more
    return _whole(kind, times, points, limits)


def _whole(
    kind: ProgramInterpolation,
    times: Array,
    points: Array,
    limits: tuple[Array, Array],
    shortest: float = 0.0,
) -> Array:
    """Slow all steps by the least factor that keeps the limits."""
    speeds, changes = interpolate(kind, times, points).peaks()
    factor = max(float((speeds / limits[0]).max()), float((changes / limits[1]).max()) ** 0.5)
    factor = max(factor, shortest / float(np.diff(times).min()))
    # A hair more, so that rounding leaves the limits kept.
    return times * factor * (1.0 + 1e-12) if factor > 1.0 else times


def _spread(values: Array, h: Array) -> Array:
    """The largest of what each step has and of what those near it have, less by their distance.

    A step that alone gets longer has its neighbours change speed faster.
    """
    middle = np.cumsum(h) - h / 2.0
    found = np.array(values)
    for k in range(1, len(h)):
        found[k] = max(found[k], found[k - 1] - _TAPER * (middle[k] - middle[k - 1]))
    for k in range(len(h) - 2, -1, -1):
        found[k] = max(found[k], found[k + 1] - _TAPER * (middle[k + 1] - middle[k]))
    return found


def outwards(due: Array, q: Array) -> Array:
    """Return corners so that the motion rounded at them passes through points, shape (n, dof).

    Args:
        due: When each point is due, shape (n,) [s].
        q: The points, shape (n, dof) [rad or m].
    """
    tau = blend_times(due)
    at = np.array(due)
    at[0], at[-1] = due[0] + tau[0], due[-1] - tau[-1]
    points = np.array(q)
    for _ in range(_PASSES):
        v = np.diff(points, axis=0) / np.diff(at)[:, None]
        points[1:-1] = q[1:-1] - np.diff(v, axis=0) * (tau[1:-1] / 4.0)[:, None]
    return points


def _from_steps(h: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(h)])


def _excess(
    kind: ProgramInterpolation, due: Array, points: Array, limits: tuple[Array, Array]
) -> Array:
    """By how much each step is too short, shape (n - 1,); below 1 where it is not."""
    motion = interpolate(kind, due, points)
    c3, c2, c1, _ = motion.coefficients
    h = np.diff(motion.breaks)[:, None]
    speeds = np.maximum(np.abs(c1), np.abs(c1 + h * (2.0 * c2 + 3.0 * h * c3)))
    changes = np.maximum(np.abs(c2), np.abs(c2 + 3.0 * h * c3)) * 2.0
    pace = np.maximum((speeds / limits[0]).max(axis=1), np.sqrt((changes / limits[1]).max(axis=1)))
    # Each piece tells the steps that it lies in.
    first = np.searchsorted(due, motion.breaks[:-1] + 1e-9 * due[-1], side="right") - 1
    last = np.searchsorted(due, motion.breaks[1:] - 1e-9 * due[-1], side="left") - 1
    found = np.zeros(len(due) - 1)
    np.maximum.at(found, np.clip(first, 0, len(found) - 1), pace)
    np.maximum.at(found, np.clip(last, 0, len(found) - 1), pace)
    return found
