"""What a controller does between the points of a program, in closed form.

A motion is a piecewise polynomial of at most third degree in time, so its largest speeds and
accelerations are exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from ikplan.arrays import Array
from ikplan.plans.programs.certificate import ProgramInterpolation

__all__ = ["Motion", "blend_times", "blended", "interpolate", "spline"]


@dataclass(frozen=True)
class Motion:
    """Cubics of time between breaks.

    Attributes:
        breaks: Shape (k + 1,), increasing [s].
        coefficients: Shape (4, k, dof): those of powers 3, 2, 1, 0 of the time from the break.
    """

    breaks: Array
    coefficients: Array

    def at(self, times: Array) -> Array:
        """Return joint values at times, shape (m, dof) [rad or m]; held outside of the motion."""
        t = np.clip(times, self.breaks[0], self.breaks[-1])
        piece = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.breaks) - 2)
        x = (t - self.breaks[piece])[:, None]
        c3, c2, c1, c0 = self.coefficients[:, piece]
        return np.asarray(c0 + x * (c1 + x * (c2 + x * c3)))

    def peaks(self) -> tuple[Array, Array]:
        """Return the largest speeds and accelerations of each joint, shape (dof,) each."""
        c3, c2, c1, _ = self.coefficients
        h = np.diff(self.breaks)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(c3 != 0.0, -c2 / (3.0 * c3), 0.0)
        turn = np.clip(np.nan_to_num(turn), 0.0, h)
        speeds = [np.abs(c1 + x * (2.0 * c2 + 3.0 * x * c3)) for x in (0.0 * h, turn, h)]
        changes = [np.abs(2.0 * c2 + 6.0 * x * c3) for x in (0.0 * h, h)]
        return np.max(speeds, axis=(0, 1)), np.max(changes, axis=(0, 1))


def interpolate(kind: ProgramInterpolation, time: Array, q: Array) -> Motion:
    """Return the motion through or past the points of a program.

    Args:
        kind: "blended" or "spline"; "waypoints" are played by
            :mod:`ikplan.plans.programs.waypoints`.
        time: When each point is due, shape (n,), n >= 2, increasing [s].
        q: The points, shape (n, dof) [rad or m].
    """
    return blended(time, q) if kind == "blended" else spline(time, q)


def spline(time: Array, q: Array) -> Motion:
    """Return the cubic spline through points, at rest at both ends."""
    found = CubicSpline(time, q, axis=0, bc_type="clamped")
    return Motion(np.asarray(found.x), np.asarray(found.c))


def blend_times(time: Array) -> Array:
    """Return half of the time that each corner takes, shape (n,) [s].

    Half of the shorter move beside it. At the ends speeding up and slowing down take twice the
    returned time: two thirds of the move, in which half of its way is done.
    """
    h = np.diff(time)
    # At constant speed on half of the way, after a ramp over the other half, a move is done
    # in time at 1.5 times its mean speed: the last half of its way takes a third of its time.
    half = h / 2.0
    half[0], half[-1] = h[0] / 3.0, h[-1] / 3.0
    if len(h) == 1:
        return np.array([h[0] / 4.0, h[0] / 4.0])
    return np.concatenate([half[:1], np.minimum(half[:-1], half[1:]), half[-1:]])


def blended(time: Array, q: Array) -> Motion:
    """Return moves that are linear in the joints, with their corners rounded by parabolas."""
    tau = blend_times(time)
    # The arm waits at the first point, and again at the last: corners lie half a ramp inside.
    due = np.array(time, dtype=np.float64)
    due[0], due[-1] = time[0] + tau[0], time[-1] - tau[-1]
    v = np.diff(q, axis=0) / np.diff(due)[:, None]
    still = np.zeros((1, q.shape[1]))
    change = np.diff(np.vstack([still, v, still]), axis=0)
    begin, end = due - tau, due + tau
    count = len(due)
    breaks = np.empty(2 * count)
    breaks[0::2], breaks[1::2] = begin, end
    coefficients = np.zeros((4, 2 * count - 1, q.shape[1]))
    before = np.vstack([still, v])
    coefficients[1, 0::2] = change / (4.0 * tau[:, None])
    coefficients[2, 0::2] = before
    coefficients[3, 0::2] = q - before * tau[:, None]
    coefficients[2, 1::2] = v
    coefficients[3, 1::2] = q[:-1] + v * tau[:-1, None]
    # Where two corners meet, nothing is left of the move between them.
    kept = np.diff(breaks) > 1e-12 * max(float(time[-1]), 1.0)
    return Motion(np.concatenate([breaks[:-1][kept], breaks[-1:]]), coefficients[:, kept])
