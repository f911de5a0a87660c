"""The documents of poses and tolerances, shared by every request.

SI units: metres, radians. Quaternions are ``xyzw``.
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BeforeValidator, Field, field_validator

from ikplan.documents import Document, Vec3, as_list

__all__ = ["Frame", "Quaternion", "Tolerance", "Waypoint", "unit_quaternion"]

Quaternion = Annotated[list[float], BeforeValidator(as_list), Field(min_length=4, max_length=4)]


def unit_quaternion(quaternion: list[float] | None) -> list[float] | None:
    """Normalise a quaternion whose norm is within 1e-3 of 1.

    Raises:
        ValueError: The norm is farther from 1.
    """
    if quaternion is None:
        return None
    norm = math.sqrt(sum(c * c for c in quaternion))
    if not abs(norm - 1.0) <= 1e-3:
        raise ValueError(f"must be a unit quaternion (x, y, z, w); this one has norm {norm:.6g}")
    # A quaternion that is unit to rounding is kept as it is, so that the id does not change.
    return quaternion if abs(norm - 1.0) < 1e-15 else [c / norm for c in quaternion]


class Frame(Document):
    """A frame given by its origin and orientation in another frame."""

    position: Vec3 = Field([0.0, 0.0, 0.0], description="Origin [m].")
    quaternion_xyzw: Quaternion = Field(
        [0.0, 0.0, 0.0, 1.0], description="Orientation, unit quaternion (x, y, z, w)."
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)


class Waypoint(Document):
    """A pose of the tool, in the path frame."""

    position: Vec3 = Field(description="Tool position [m].")
    quaternion_xyzw: Quaternion | None = Field(
        None,
        description="Tool orientation, unit quaternion (x, y, z, w); absent: any orientation.",
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)


class Tolerance(Document):
    """How far from a waypoint or the path the tool may be."""

    position: float = Field(1e-4, ge=1e-8, le=1, description="Position tolerance [m].")
    orientation: float = Field(1e-3, ge=1e-8, le=3.2, description="Orientation tolerance [rad].")
