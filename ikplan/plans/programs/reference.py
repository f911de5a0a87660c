"""The motion of a plan on a fine grid, and how far another motion is from its path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.plans.playback import evaluate

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["LEVER", "Reference", "lags", "looks"]

LEVER = 0.1
"""Length by which rotations count as distances where the nearest place of a path is sought [m]."""
_STEP = 0.002
_FEWEST = 64
_ROUNDS = 4


@dataclass(frozen=True)
class Reference:
    """A plan's motion at evenly spaced times.

    Attributes:
        time: Shape (m,), from 0 to the plan's duration [s].
        q: Shape (m, dof) [rad or m].
        jacobians: Of the tool in its own frame, shape (m, 6, dof).
        twist: Velocity of the tool in its own frame, shape (m, 6) [m/s, rad/s].
    """

    time: Array
    q: Array
    jacobians: Array
    twist: Array

    @classmethod
    def of(cls, plan: PlanDocument, robot: Robot) -> Reference:
        """Look at a plan at the times of :func:`looks`."""
        time = looks(plan.duration)
        q, dq, _ = evaluate(plan, time)
        jacobians = robot.jacobians(q)
        return cls(time, q, jacobians, np.einsum("mij,mj->mi", jacobians, dq))

    def errors(self, q: Array, near: Indices) -> tuple[Array, Array, Array]:
        """Return how far the tool is from the path, to first order at the nearest row found.

        Args:
            q: Joint values, shape (n, dof).
            near: The row near which each is expected, shape (n,).

        Returns:
            Distances [m] and rotations [rad] from the nearest place of the path, and by how long
            that is from where it is expected [s], shape (n,) each.
        """
        rows, last = near, len(self.time) - 1
        step = self.time[1] - self.time[0]
        for _ in range(_ROUNDS):
            error = np.einsum("mij,mj->mi", self.jacobians[rows], q - self.q[rows])
            lag = lags(error, self.twist[rows])
            rows = np.clip(rows + np.rint(lag / step).astype(np.int64), 0, last)
        error = np.einsum("mij,mj->mi", self.jacobians[rows], q - self.q[rows])
        lag = np.clip(lags(error, self.twist[rows]), -step, step)
        left = error - lag[:, None] * self.twist[rows]
        shift = np.abs((rows - near) * step + lag)
        return np.linalg.norm(left[:, :3], axis=1), np.linalg.norm(left[:, 3:], axis=1), shift


def looks(duration: float) -> Array:
    """Return even times from 0 to a duration, at least one each 2 ms and at least 65 [s]."""
    return np.linspace(0.0, duration, max(math.ceil(duration / _STEP), _FEWEST) + 1)


def lags(error: Array, twist: Array) -> Array:
    """Return by how long errors are ahead along a motion, shape (m,) [s]; 0 where it rests."""
    weight = np.array([1.0, 1.0, 1.0, LEVER**2, LEVER**2, LEVER**2])
    along = (error * twist * weight).sum(axis=1)
    square = (twist * twist * weight).sum(axis=1)
    # Below 0.1 mm/s the tool rests: a lag would be long and of no use.
    return np.asarray(np.where(square > 1e-8, along / np.maximum(square, 1e-8), 0.0))
