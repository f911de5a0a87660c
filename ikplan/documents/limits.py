"""The documents of a motion's limits and samples.

SI units: metres, radians, seconds, newtons, newton metres, kilograms.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from ikplan.documents import Document, IfGiven, Number, Vec3, as_list

__all__ = [
    "LimitOptions",
    "OwnLimits",
    "Payload",
    "SamplingOptions",
    "SegmentLimits",
    "ToolAcceleration",
    "ToolRate",
]

MAX_RATE_HZ = 10_000.0

LEAST = 1e-6
"""The least limit of a rate."""
Positive = Annotated[float, Field(ge=1e-6, le=1e9)]
Negative = Annotated[float, Field(ge=-1e9, le=-1e-6)]


def _tag(value: Any) -> str:
    if isinstance(value, bool):
        return "[flag]"
    if isinstance(value, list):
        return "[values]"
    return "[object]" if isinstance(value, dict | Document) else "[number]"


def _zero_or_more(value: float) -> float:
    """Refuse a limit between 0 and the least there is.

    Raises:
        ValueError: It is neither 0 nor at least ``LEAST``.
    """
    if 0.0 < value < LEAST:
        raise ValueError(f"must be 0, of a joint that does not move, or at least {LEAST:g}")
    return value


OrZero = Annotated[float, Field(ge=0, le=1e9), AfterValidator(_zero_or_more)]
# Tagged, so that an error names the form that the user wrote, not both.
_PositiveList = Annotated[list[Positive], Field(min_length=1, max_length=1000), Tag("[values]")]
_OrZeroList = Annotated[list[OrZero], Field(min_length=1, max_length=1000), Tag("[values]")]
_NegativeList = Annotated[list[Negative], Field(min_length=1, max_length=1000), Tag("[values]")]
PerJoint = Annotated[
    Annotated[Positive, Tag("[number]")] | _OrZeroList,
    Discriminator(lambda v: "[values]" if isinstance(v, list) else "[number]"),
    BeforeValidator(as_list),
]
PerJointBelow = Annotated[
    Annotated[Negative, Tag("[number]")] | _NegativeList,
    Discriminator(lambda v: "[values]" if isinstance(v, list) else "[number]"),
    BeforeValidator(as_list),
]
WholeJerk = Annotated[
    Annotated[Positive, Tag("[number]")] | _OrZeroList | Annotated[Literal[False], Tag("[flag]")],
    Discriminator(lambda v: tag if (tag := _tag(v)) in ("[values]", "[flag]") else "[number]"),
    BeforeValidator(as_list),
]
Torque = Annotated[
    Annotated[bool, Tag("[flag]")] | _PositiveList,
    Discriminator(lambda v: "[values]" if isinstance(v, list) else "[flag]"),
    BeforeValidator(as_list),
]


class ToolRate(Document):
    """A limit of the norms of a linear and an angular rate of the tool frame."""

    linear: Positive | None = Field(None, description="Linear [m/s or m/s^2]; null: no limit.")
    angular: Positive | None = Field(
        None, description="Angular [rad/s or rad/s^2]; null: no limit."
    )


class ToolAcceleration(ToolRate):
    """A limit of the norms of the tool frame's accelerations, and of how its speed changes."""

    linear: Positive | None = Field(
        None,
        description="Norm of the linear acceleration, its centripetal share in curves included "
        "[m/s^2]; null: no limit.",
    )
    angular: Positive | None = Field(
        None, description="Norm of the angular acceleration [rad/s^2]; null: no limit."
    )
    tangential: Annotated[Positive | None, IfGiven()] = Field(
        None,
        description="Tangential linear acceleration: the rate at which the speed of the tool "
        "changes, speeding up and slowing down, whatever its way curves [m/s^2]; null: no limit.",
    )


ToolLimit = Annotated[
    Annotated[Positive, Tag("[number]")] | Annotated[ToolRate, Tag("[object]")],
    Discriminator(lambda v: "[object]" if _tag(v) == "[object]" else "[number]"),
]
ToolAccelerationLimit = Annotated[
    Annotated[Positive, Tag("[number]")] | Annotated[ToolAcceleration, Tag("[object]")],
    Discriminator(lambda v: "[object]" if _tag(v) == "[object]" else "[number]"),
]


class Payload(Document):
    """A mass that the tool carries, taken as a point."""

    mass: float = Field(ge=0, le=1e4, description="Mass [kg].")
    position: Vec3 = Field([0.0, 0.0, 0.0], description="Its centre, in the tool frame [m].")


class _Limits(Document):
    """What limits of the whole motion and of a segment have in common."""

    velocity_scale: float = Field(1.0, ge=1e-4, le=1, description="Share of the velocity limits.")
    acceleration_scale: float = Field(
        1.0,
        ge=1e-4,
        le=1,
        description="Share of the robot's acceleration limits, or of what replaces them.",
    )
    velocity: PerJoint | None = Field(
        None,
        description="Highest joint velocities, one each or one for all [rad/s or m/s]; 0 in a "
        "list, here as for accelerations and jerks: the joint must not move.",
    )
    velocity_lower: PerJointBelow | None = Field(
        None,
        description="Lowest joint velocities, negative [rad/s or m/s]; null: as far below zero "
        "as the highest ones are above.",
    )
    acceleration: PerJoint | None = Field(
        None,
        description="Highest joint accelerations, one each or one for all [rad/s^2 or m/s^2]. They "
        "replace limits of the robot that are only a named default, no source giving them, those "
        "of a segment not without those of the request; limits with a source hold as well, and "
        "where these are higher, `timing.hints` says so.",
    )
    acceleration_lower: PerJointBelow | None = Field(
        None,
        description="Lowest joint accelerations, negative [rad/s^2 or m/s^2], in place of named "
        "defaults as `acceleration`; null: as far below zero as the highest ones are above.",
    )
    deceleration: Annotated[PerJoint | None, IfGiven()] = Field(
        None,
        description="Highest rates at which joints may slow down, whichever way they move, one "
        "each or one for all [rad/s^2 or m/s^2], inside the robot's own limits unless these are "
        "named defaults; `acceleration` is then how fast they may speed up. null: as "
        "`acceleration`.",
    )
    torque: Torque = Field(
        False,
        description="true: keep the robot's torque limits; a list: the strictest of those and "
        "these, one each [N m or N]. Only for robots whose inertias have a source.",
    )
    payload: Payload | None = Field(
        None,
        description="What the tool carries, counted towards the torques; null: nothing, or on a "
        "segment, what it carries on the whole.",
    )
    tool_speed: ToolLimit | None = Field(
        None, description="Highest speed of the tool frame; a number is the linear one [m/s]."
    )
    tool_acceleration: ToolAccelerationLimit | None = Field(
        None,
        description="Highest acceleration of the tool frame; a number is the norm of the linear "
        "one, the centripetal share included [m/s^2].",
    )


class SegmentLimits(_Limits):
    """Limits of a segment of the motion, on top of those of the whole: the strictest holds."""

    jerk: PerJoint | None = Field(
        None,
        description="Highest joint jerks, both ways, one each or one for all [rad/s^3 or m/s^3]; "
        "null: none but those of the whole.",
    )


class OwnLimits(Document):
    """Limits of one joint, inside the robot's own; null: the robot's own."""

    lower: Number | None = Field(None, description="Lower position limit [rad or m].")
    upper: Number | None = Field(
        None,
        description="Upper position limit [rad or m]; the lower one again: the joint stands, "
        "within 1e-9.",
    )
    velocity: Positive | None = Field(None, description="Velocity limit [rad/s or m/s].")
    acceleration: Positive | None = Field(
        None, description="Acceleration limit [rad/s^2 or m/s^2]."
    )


class LimitOptions(_Limits):
    """Limits of the motion, on top of the robot's own: the strictest of all holds."""

    joints: Annotated[
        dict[Annotated[str, Field(min_length=1, max_length=200)], OwnLimits] | None, IfGiven()
    ] = Field(
        None,
        max_length=64,
        description="Limits of single joints by name, position limits among them, as if they were "
        "the robot's own: none may be wider, and scales are shares of these. null: the robot's.",
    )
    duration: Annotated[Annotated[float, Field(ge=1e-6, le=1e6)] | None, IfGiven()] = Field(
        None,
        description="How long the whole motion takes, dwells included [s]: it is slowed evenly; "
        "refused with the least duration where it needs more. Where this is no whole number of "
        "sampling periods, the last sample follows sooner. null: as little as the limits allow.",
    )
    jerk: WholeJerk | None = Field(
        None,
        description="Highest joint jerks, both ways, one each or one for all [rad/s^3 or m/s^3], "
        "on top of those that the maker publishes; null: the maker's, where published; false: no "
        "limit, accelerations may jump.",
    )


class SamplingOptions(Document):
    """The samples of the trajectory."""

    rate_hz: float | None = Field(
        None,
        ge=1,
        le=MAX_RATE_HZ,
        description="Samples per second [Hz]; null: one a cycle of the robot's controller, or 250 "
        "where none is known. The motion ends at a sample: it is slowed until its duration is a "
        "whole number of periods.",
    )
    form: Literal["samples", "knots", "polynomial"] = Field(
        "samples",
        description='"samples": at the rate; "knots": only where the path acceleration changes; '
        '"polynomial": samples, and the motion that any time can be evaluated from.',
    )
