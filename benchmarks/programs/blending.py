"""Moves linear in the joints with rounded corners, played as the certificates name them.

Corners are parabolas in time over half of the shorter move beside them; half of the way of the
first and of the last move is its ramp.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Motion", "played"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """What the arm does.

    Attributes:
        points: Joint values of the points as the program counts them, shape (n, 6) [deg].
        steps: Times of the moves, shape (n - 1,) [s].
        time: Cycles of the controller, the end included, shape (m,) [s].
        degrees: Joint values then, as the program counts them, shape (m, 6) [deg].
    """

    points: Array
    steps: Array
    time: Array
    degrees: Array


def played(points: Array, steps: Array, cycle: float) -> Motion:
    """Integrate the speeds: constant on moves, changing evenly in corners.

    Args:
        points: Joint values, shape (n, 6) [deg].
        steps: Times of the moves, shape (n - 1,) [s].
        cycle: The controller's cycle [s].
    """
    due = np.concatenate([[0.0], np.cumsum(steps)])
    half = steps / 2.0
    # Half of the way is done at constant speed in a third of the time, the rest is the ramp's.
    half[[0, -1]] = steps[[0, -1]] / (4.0 if len(steps) == 1 else 3.0)
    reach = np.array([half[0], *np.minimum(half[:-1], half[1:]), half[-1]])
    corner = np.array(due)
    corner[0], corner[-1] = due[0] + reach[0], due[-1] - reach[-1]
    speed = np.diff(points, axis=0) / np.diff(corner)[:, None]
    still = np.zeros((1, points.shape[1]))
    before, after = np.vstack([still, speed]), np.vstack([speed, still])
    knots = np.empty(2 * len(corner))
    knots[0::2], knots[1::2] = corner - reach, corner + reach
    rates = np.empty((2 * len(corner), points.shape[1]))
    rates[0::2], rates[1::2] = before, after
    count = int(np.ceil(due[-1] / cycle - 1e-9))
    time = np.minimum(np.arange(count + 1) * cycle, due[-1])
    moments = np.union1d(knots, time)
    velocity = np.stack([np.interp(moments, knots, column) for column in rates.T], axis=1)
    moved = np.diff(moments)[:, None] * (velocity[1:] + velocity[:-1]) / 2.0
    q = points[0] + np.vstack([still, np.cumsum(moved, axis=0)])
    return Motion(points, steps, time, q[np.searchsorted(moments, time)])
