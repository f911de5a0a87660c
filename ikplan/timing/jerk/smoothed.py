"""A jerk-limited motion of a span, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass

from ikplan.timing.jerk.cubic_motion import CubicMotion

__all__ = ["Smoothed"]


@dataclass(frozen=True, eq=False)
class Smoothed:
    """A jerk-limited motion, and how it was found.

    Attributes:
        motion: The motion.
        acceleration_fraction: Fraction of the acceleration that a swing over the duration would
            build up, to which accelerations were limited; None: they were not.
        window: The window, as a multiple of the time in which the jerk limits build up the
            acceleration limits where it is longest; inf: the duration; None: the motion is a
            closed form, or was played along its course.
    """

    motion: CubicMotion
    acceleration_fraction: float | None
    window: float | None

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.motion.time[-1])
