"""Timing of a joint path under joint limits."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.timing.engine import Engine, EngineFailed, ToppraEngine, natural_units
from ikplan.timing.excess import usage
from ikplan.timing.grid import curvature_grid
from ikplan.timing.joint_path import JointPath
from ikplan.timing.limits import JointLimits
from ikplan.timing.rows import Grid, joint_rows
from ikplan.timing.timed_path import TimedPath

__all__ = ["time_joint_path"]

Array = NDArray[np.float64]

# Kept below the limits, so that rounding in a sample cannot step over one.
_MARGIN = 1e-9


def time_joint_path(
    path: JointPath, limits: JointLimits, *, engine: Engine | None = None
) -> TimedPath:
    """Move along a path as fast as the limits allow, from rest to rest.

    Every span between rest points is solved on a grid on which joint accelerations are bounded
    over whole intervals; what the result uses of each limit is then computed exactly, interval by
    interval, and the span is slowed by the excess, so that no limit is exceeded at any time.

    Args:
        path: The path.
        limits: Joint limits.
        engine: Chooses the path speed; None: toppra.

    Returns:
        The timed path; duration 0 for a path of length zero.

    Raises:
        InvalidRequest: The limits are for another number of joints.
        TimingFailed: The path leaves the position limits, or no path speed was found; carries the
            place on the path, the joint and the limit.
    """
    if path.dof != limits.dof:
        raise InvalidRequest(
            f"limits are for {limits.dof} joints, the path has {path.dof}",
            field="limits",
            allowed=f"{path.dof} values each",
        )
    check_inside(path, limits)
    engine = engine or ToppraEngine()
    s, sdot, time = [np.zeros(1)], [np.zeros(1)], [np.zeros(1)]
    pieces = [np.zeros(0, dtype=np.int64)]
    if path.length > 0.0:
        for first, last in itertools.pairwise(path.rest_knots):
            grid = curvature_grid(path, first, last, limits, 300)
            velocities, times = _time_span(path, grid, limits, engine)
            s.append(grid.s[1:])
            pieces.append(grid.pieces)
            sdot.append(velocities[1:])
            time.append(times[1:] + time[-1][-1])
    return TimedPath(
        path=path,
        s=np.concatenate(s),
        pieces=np.concatenate(pieces),
        sdot=np.concatenate(sdot),
        node_times=np.concatenate(time),
    )


def check_inside(path: JointPath, limits: JointLimits) -> None:
    """Refuse a path that leaves the position limits between its waypoints.

    Args:
        path: The path.
        limits: Joint limits.

    Raises:
        TimingFailed: Names the joint.
    """
    low, high = path.extrema()
    # The extrema of a cubic carry rounding errors of their own.
    slack = 1e-12 * np.maximum(1.0, np.maximum(np.abs(low), np.abs(high)))
    bad = (low < limits.lower - slack) | (high > limits.upper + slack)
    if bad.any():
        j = int(np.argmax(bad))
        raise TimingFailed(
            f"joint {limits.joint_names[j]!r} leaves its position limits "
            f"[{limits.lower[j]:.9g}, {limits.upper[j]:.9g}]: the path reaches from {low[j]:.9g} "
            f"to {high[j]:.9g}",
            joint=limits.joint_names[j],
            limit="position",
        )


def _time_span(
    path: JointPath, grid: Grid, limits: JointLimits, engine: Engine
) -> tuple[Array, Array]:
    """Return path velocities and times at the nodes of one span."""
    rows = joint_rows(path, grid, limits)
    scaled, unit = natural_units(rows)
    try:
        x = engine.solve(scaled) * unit
    except EngineFailed as failure:
        raise _failed(path, grid, limits, failure.stage) from failure
    x[0] = x[-1] = 0.0
    sdot = np.sqrt(x)
    h = np.diff(grid.s)
    mean = 0.5 * (sdot[1:] + sdot[:-1])
    if not (mean > 0.0).all():
        raise _failed(path, grid, limits, int(np.argmin(mean)))
    v_share, a_share = usage(
        h,
        x,
        path.derivatives(grid.s[:-1], grid.pieces)[1],
        path.derivatives(grid.s[:-1], grid.pieces)[2],
        path.derivatives(grid.s[1:], grid.pieces)[2],
        limits.velocity,
        limits.velocity_lower,
        limits.acceleration,
        limits.acceleration_lower,
    )
    k = max(float(v_share.max()), float(np.sqrt(a_share.max()))) * (1.0 + _MARGIN)
    sdot = sdot / k
    return sdot, np.concatenate([[0.0], np.cumsum(k * h / mean)])


def _failed(path: JointPath, grid: Grid, limits: JointLimits, stage: int) -> TimingFailed:
    """Describe a failure: the joint whose acceleration the path asks most of there."""
    stage = min(max(stage, 0), len(grid.pieces) - 1)
    _, _, qss = path.derivatives(grid.s[stage : stage + 2], grid.pieces[[stage, stage]])
    share = np.maximum(qss / limits.acceleration, qss / limits.acceleration_lower).max(axis=0)
    j = int(np.argmax(share))
    where = float(grid.s[stage] / path.length)
    return TimingFailed(
        f"no path speed found at {where:.4f} of the path, where joint "
        f"{limits.joint_names[j]!r} needs the most of its acceleration limit",
        position=where,
        joint=limits.joint_names[j],
        limit="acceleration",
    )
