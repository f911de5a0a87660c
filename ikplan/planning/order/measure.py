"""What a joint motion costs in the choice of an order: its length, or the time that it takes."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ikplan.arrays import Array
from ikplan.limits import JointLimits

__all__ = ["JointMotion", "LeastTime", "Measure"]


class Measure(Protocol):
    """Measures joint motions."""

    def straight(self, steps: Array) -> Array:
        """Return the cost of straight motions, shape (..., dof) [rad or m], shape (...)."""

    def way(self, q: Array) -> float:
        """Return the cost of a way through configurations, shape (k, dof) [rad or m]."""


class JointMotion:
    """Joint distance [rad or m]."""

    def straight(self, steps: Array) -> Array:
        """Return the joint distances of straight motions."""
        return np.asarray(np.linalg.norm(steps, axis=-1))

    def way(self, q: Array) -> float:
        """Return the joint distance along a way."""
        return float(self.straight(np.diff(q, axis=0)).sum())


class LeastTime:
    """The time of a motion from rest to rest at the limits of the slowest joint [s].

    A joint speeds up by its acceleration, goes on at its velocity, and slows down.

    Args:
        limits: The limits.
    """

    def __init__(self, limits: JointLimits) -> None:
        self._velocity, self._acceleration = limits.velocity, limits.acceleration

    def straight(self, steps: Array) -> Array:
        """Return the times of straight motions."""
        v, a = self._velocity, self._acceleration
        d = np.abs(steps)
        times = np.where(d < v * v / a, 2.0 * np.sqrt(d / a), d / v + v / a)
        return np.asarray(times.max(axis=-1))

    def way(self, q: Array) -> float:
        """Return the time of a way, were its joints led to and fro without regard to each other."""
        return float(self.straight(np.abs(np.diff(q, axis=0)).sum(axis=0)))
