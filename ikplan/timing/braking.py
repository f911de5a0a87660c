"""Limits of joints that slow down, by the way that they move on each piece of a path."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.joint_path.joint_path import JointPath
from ikplan.limits.joint_limits import JointLimits

__all__ = ["acceleration_bounds", "directions", "turning_points"]


_STANDS = 1e-9
"""A slope dq/ds of no more than this goes neither way."""


def turning_points(path: JointPath) -> list[float]:
    """Return the path positions inside pieces at which a joint turns back."""
    found: list[float] = []
    if path.length == 0.0:
        return found
    s, h = path.s_knots[:-1], np.diff(path.s_knots)
    start, first, end = _slopes(path)
    # dq/ds = start + first x + 0.5 change x^2 / h on a piece of length h.
    change = 2.0 * (end - start - first * h[:, None]) / h[:, None]
    for k in range(len(h)):
        for j in range(path.dof):
            roots = np.roots([0.5 * change[k, j] / h[k], first[k, j], start[k, j]])
            real = roots[np.abs(roots.imag) < 1e-12].real
            found += [float(s[k] + x) for x in real if 0.0 < x < h[k]]
    return sorted(found)


def directions(path: JointPath) -> tuple[Flags, Flags]:
    """Return whether each joint goes up, and whether it goes down, on each piece, (k, dof)."""
    start, first, end = _slopes(path)
    h = np.diff(path.s_knots)[:, None]
    change = 2.0 * (end - start - first * h) / h
    at = np.where(change != 0.0, -first / np.where(change != 0.0, change / h, 1.0), -1.0)
    inside = (at > 0.0) & (at < h)
    inner = np.where(inside, start + first * at + 0.5 * change / h * at * at, start)
    slopes = np.stack([start, inner, end])
    return np.asarray((slopes > _STANDS).any(axis=0)), np.asarray((slopes < -_STANDS).any(axis=0))


def acceleration_bounds(limits: JointLimits, up: Flags, down: Flags) -> tuple[Array, Array]:
    """Return the highest and lowest accelerations on pieces, shape (k, dof) each.

    Args:
        limits: Limits, with or without one for slowing down.
        up: Where each joint goes up, shape (k, dof).
        down: Where it goes down; where it does both, the strictest holds, and so it does nowhere.
    """
    highest = np.broadcast_to(limits.acceleration, up.shape)
    lowest = np.broadcast_to(limits.acceleration_lower, up.shape)
    slowing = limits.deceleration
    if slowing is None:
        return highest.copy(), lowest.copy()
    both = up & down
    upper = np.where(down, slowing, highest)
    lower = np.where(up, -slowing, lowest)
    return (
        np.where(both, np.minimum(highest, slowing), upper),
        np.where(both, np.maximum(lowest, -slowing), lower),
    )


def _slopes(path: JointPath) -> tuple[Array, Array, Array]:
    """dq/ds and d2q/ds2 at the begin of each piece, and dq/ds at its end, (k, dof) each."""
    pieces = np.arange(len(path.s_knots) - 1)
    _, start, first = path.derivatives(path.s_knots[:-1], pieces)
    _, end, _ = path.derivatives(path.s_knots[1:], pieces)
    return start, first, end
