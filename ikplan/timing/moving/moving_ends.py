"""What is asked for at the ends of a motion that begins or ends moving."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array

__all__ = ["MovingEnds"]


@dataclass(frozen=True, eq=False)
class MovingEnds:
    """Joint rates at both ends of a motion.

    Attributes:
        start_velocity: Joint velocities at the start, shape (dof,) [rad/s or m/s]; zero: at rest.
        start_acceleration: Joint accelerations there, shape (dof,); they count under jerk limits.
        end_velocity: Joint velocities at the end, shape (dof,); zero: at rest.
    """

    start_velocity: Array
    start_acceleration: Array
    end_velocity: Array

    @property
    def start_moves(self) -> bool:
        """Whether the motion begins moving."""
        return bool(self.start_velocity.any())

    @property
    def end_moves(self) -> bool:
        """Whether the motion ends moving."""
        return bool(self.end_velocity.any())

    @property
    def moving(self) -> bool:
        """Whether either end moves."""
        return self.start_moves or self.end_moves

    def scaled(self, start: float, end: float) -> MovingEnds:
        """Return the same ends, slower.

        Args:
            start: Factor of the start velocity; below 1, no acceleration is asked for there.
            end: Factor of the end velocity.
        """
        acceleration = self.start_acceleration if start == 1.0 else np.zeros_like(self.end_velocity)
        return replace(
            self,
            start_velocity=self.start_velocity * start,
            start_acceleration=acceleration,
            end_velocity=self.end_velocity * end,
        )
