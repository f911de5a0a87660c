"""Limits used where no source gives one: few, and each with a name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

__all__ = [
    "ACCELERATION_DEFAULTS",
    "CAUTIOUS_ACCELERATION",
    "DEFAULT_ACCELERATION",
    "VELOCITY_DEFAULTS",
]

DEFAULT_ACCELERATION = "velocity-limit-reached-in-0.25-s"
CAUTIOUS_ACCELERATION = "velocity-limit-reached-in-0.6-s"
"""For new robots: below the median of what makers publish, 1.70 1/s over 305 joints of KUKA and
Doosan arms (velocity limit reached in 0.59 s)."""

ACCELERATION_DEFAULTS: Mapping[str, Callable[[float], float]] = MappingProxyType(
    {
        DEFAULT_ACCELERATION: lambda velocity: velocity / 0.25,
        CAUTIOUS_ACCELERATION: lambda velocity: velocity / 0.6,
    }
)
"""Acceleration limit [rad/s^2 or m/s^2] from the velocity limit [rad/s or m/s], by name."""

VELOCITY_DEFAULTS: Mapping[str, float] = MappingProxyType({"90-deg-per-s": math.radians(90.0)})
"""Velocity limit of a revolute joint [rad/s], by name."""
