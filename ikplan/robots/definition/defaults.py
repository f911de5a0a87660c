"""Limits used where no source gives one: few, and each with a name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

__all__ = [
    "ACCELERATION_DEFAULTS",
    "DEFAULT_ACCELERATION",
    "FIRST_ACCELERATION",
    "VELOCITY_DEFAULTS",
]

FIRST_ACCELERATION = "velocity-limit-reached-in-0.25-s"
"""The default of the first robots of the catalogue, and of the uploads of that time."""
DEFAULT_ACCELERATION = "velocity-limit-reached-in-0.6-s"
"""The default of all others.

Of 305 joints of 51 arms whose makers publish both (KUKA's and Doosan's own repositories), the
median acceleration limit is 1.70 times the velocity limit per second: reached in 0.59 s.
"""

ACCELERATION_DEFAULTS: Mapping[str, Callable[[float], float]] = MappingProxyType(
    {
        FIRST_ACCELERATION: lambda velocity: velocity / 0.25,
        DEFAULT_ACCELERATION: lambda velocity: velocity / 0.6,
    }
)
"""Acceleration limit [rad/s^2 or m/s^2] from the velocity limit [rad/s or m/s], by name."""

VELOCITY_DEFAULTS: Mapping[str, float] = MappingProxyType({"90-deg-per-s": math.radians(90.0)})
"""Velocity limit of a revolute joint [rad/s], by name."""
