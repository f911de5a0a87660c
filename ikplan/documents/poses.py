"""The documents of poses, tolerances and preferred postures, shared by requests.

SI units: metres, radians. Quaternions are ``xyzw``.
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BeforeValidator, Field, field_validator, model_validator

from ikplan.documents import Document, Floats, Vec3, as_list

__all__ = [
    "Frame",
    "Posture",
    "PostureReport",
    "Quaternion",
    "Tolerance",
    "Waypoint",
    "unit_quaternion",
]

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


_Weights = Annotated[
    list[Annotated[float, Field(ge=1e-3, le=1e3)]],
    BeforeValidator(as_list),
    Field(min_length=1, max_length=1000),
]


class Posture(Document):
    """Which of the motions that do what is asked is preferred.

    The planner minimises the sum of the weighted joint distances plus ``pull`` times the mean
    weighted distance from the preferred configuration over the path.
    """

    q: Floats | None = Field(
        None,
        min_length=1,
        description="Preferred configuration, shape (dof,) [rad or m]: branches, full turns and "
        "self-motion near to it are preferred, and a free start begins near to it. null: none.",
    )
    weights: _Weights | None = Field(
        None,
        description="How much the motion of each joint counts, 0.001 to 1000, shape (dof,); null: "
        "1 each.",
    )
    lower: Floats | None = Field(
        None,
        min_length=1,
        description="Lower soft limits, shape (dof,) [rad or m]: a motion within the soft limits "
        "is taken wherever one is found. Joint values that the request gives count as inside. "
        "null: none.",
    )
    upper: Floats | None = Field(
        None, min_length=1, description="Upper soft limits, shape (dof,) [rad or m]; null: none."
    )
    pull: float = Field(
        1.0,
        ge=0,
        le=100,
        description="What the mean distance from the preferred configuration, or where there is "
        "none from the soft limits, counts against as much joint motion.",
    )

    @model_validator(mode="after")
    def _something(self) -> Posture:
        if all(field is None for field in (self.q, self.weights, self.lower, self.upper)):
            raise ValueError("a posture has at least one of q, weights, lower and upper")
        return self


class PostureReport(Document):
    """How far a motion keeps to the posture that its request prefers."""

    mean_distance: float | None = Field(
        description="Mean weighted distance of the samples from the preferred configuration "
        "[rad or m]; null: none was given."
    )
    soft_limits_kept: bool | None = Field(
        description="Whether every sample is within the soft limits; null: none were given."
    )
    outside: dict[str, float] = Field(
        description="Joints that leave their soft limits, and by how much at most [rad or m]."
    )
