"""Limits used where no source gives one: few, and each with a name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

__all__ = ["ACCELERATION_DEFAULTS", "DEFAULT_ACCELERATION", "VELOCITY_DEFAULTS"]

DEFAULT_ACCELERATION = "velocity-limit-reached-in-0.25-s"

ACCELERATION_DEFAULTS: Mapping[str, Callable[[float], float]] = MappingProxyType(
    {DEFAULT_ACCELERATION: lambda velocity: velocity / 0.25}
)
"""Acceleration limit [rad/s^2 or m/s^2] from the velocity limit [rad/s or m/s], by name."""

VELOCITY_DEFAULTS: Mapping[str, float] = MappingProxyType({"90-deg-per-s": math.radians(90.0)})
"""Velocity limit of a revolute joint [rad/s], by name."""
