"""The document of a certificate: what the check measured on a finished trajectory."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE
from ikplan.documents.clearance import Clearance

__all__ = ["Certificate", "LimitPlace", "RegionCertificate", "Result", "SegmentCertificate"]


class Result(BaseModel):
    """A part of an answer."""

    # Results of a newer service may carry more than this version knows: a client ignores it.
    model_config = ConfigDict(
        frozen=True, extra="ignore", defer_build=AT_FIRST_USE, arbitrary_types_allowed=True
    )


class LimitPlace(Result):
    """Where a limit is approached most."""

    joint: str = Field(description="Name of the joint.")
    time: float = Field(description="Time of the sample [s].")


class SegmentCertificate(Result):
    """What the check measured on a segment that has limits of its own; null: not limited there."""

    field: str = Field(description="What of the request asks for them.")
    begin: float = Field(description="When the segment begins [s].")
    end: float = Field(description="When it ends [s].")
    velocity_limit_ratio: float | None = Field(
        None, description="Largest joint speed over its limit; <= 1; null: no sample falls in it."
    )
    velocity_limit_at: LimitPlace | None = Field(None, description="Where.")
    acceleration_limit_ratio: float | None = Field(
        None, description="Largest joint acceleration over its limit; <= 1."
    )
    acceleration_limit_at: LimitPlace | None = Field(None, description="Where.")
    jerk_limit_ratio: float | None = Field(
        None, description="Largest joint jerk between samples over its limit; <= 1."
    )
    jerk_limit_at: LimitPlace | None = Field(None, description="Where.")
    torque_limit_ratio: float | None = Field(
        None, description="Largest joint torque over its limit; <= 1."
    )
    torque_limit_at: LimitPlace | None = Field(None, description="Where.")
    tool_speed_ratio: float | None = Field(
        None, description="Largest linear or angular tool speed over its limit; <= 1."
    )
    tool_speed_time: float | None = Field(None, description="Time of that sample [s].")
    tool_acceleration_ratio: float | None = Field(
        None, description="Largest linear or angular tool acceleration over its limit; <= 1."
    )
    tool_acceleration_time: float | None = Field(None, description="Time of that sample [s].")


class RegionCertificate(Result):
    """The proof that the tool stays in the region of a move; null: none of that kind is asked."""

    field: str = Field(description="The move in the request.")
    begin: float = Field(description="When it begins [s].")
    end: float = Field(description="When it ends [s].")
    cone_left: float | None = Field(
        description="At every instant, the axis of the tool is inside the cone by this at least "
        "[rad]."
    )
    box_left: float | None = Field(
        description="At every instant, the tool is inside the box by this at least [m]."
    )


class Certificate(Result):
    """What an independent check by Pinocchio measured on the finished samples."""

    valid: bool = Field(description="Every promise is kept; a plan without it is never returned.")
    max_position_error: float | None = Field(
        description="Largest distance at a waypoint [m]; null: the waypoints are joint values."
    )
    max_orientation_error: float | None = Field(
        description="Largest rotation at a waypoint [rad]; null: no waypoint gives an orientation."
    )
    max_path_deviation: float | None = Field(
        description="Largest distance from the path between waypoints [m]; of a timing, of the "
        "tool from where the polyline through the joint waypoints has it; null for joint segments."
    )
    max_orientation_deviation: float | None = Field(
        description="Largest rotation from the path between waypoints [rad]; of a timing, as the "
        "distance; null for joint segments."
    )
    max_path_deviation_time: float | None = Field(None, description="When [s].")
    max_orientation_deviation_time: float | None = Field(None, description="When [s].")
    max_joint_deviation: float | None = Field(
        None,
        description="Of a timing: largest distance of a joint from the polyline through the joint "
        "waypoints [rad or m]; null: a plan.",
    )
    max_joint_deviation_at: LimitPlace | None = Field(None, description="Where.")
    position_limit_ratio: float = Field(
        description="Largest distance from mid-range over half the range, of any joint; <= 1."
    )
    position_limit_at: LimitPlace | None = Field(description="Where; null: no joint has limits.")
    velocity_limit_ratio: float = Field(description="Largest joint speed over its limit; <= 1.")
    velocity_limit_at: LimitPlace = Field(description="Where.")
    acceleration_limit_ratio: float = Field(
        description="Largest joint acceleration over its limit; <= 1."
    )
    acceleration_limit_at: LimitPlace = Field(description="Where.")
    jerk_limited: bool = Field(
        False, description="Whether jerks are limited; if not, accelerations may jump."
    )
    jerk_limit_ratio: float | None = Field(
        None, description="Largest joint jerk between samples over its limit; null: no limit."
    )
    jerk_limit_at: LimitPlace | None = Field(None, description="Where.")
    torque_limit_ratio: float | None = Field(
        None,
        description="Largest joint torque over its limit, gravity and payload included; null: no "
        "limit.",
    )
    torque_limit_at: LimitPlace | None = Field(None, description="Where.")
    tool_speed_ratio: float | None = Field(
        None,
        description="Largest linear or angular tool speed over its limit; null: no limit.",
    )
    tool_speed_time: float | None = Field(None, description="Time of that sample [s].")
    tool_acceleration_ratio: float | None = Field(
        None,
        description="Largest linear or angular tool acceleration over its limit; null: no limit.",
    )
    tool_acceleration_time: float | None = Field(None, description="Time of that sample [s].")
    stops: list[float] = Field(
        [],
        description="Times at which the motion rests between its ends, by its samples [s].",
    )
    assumptions: list[str] = Field(
        [],
        description="Limits that no source gives and that were assumed, in words: the motion keeps "
        "them, the robot may have others. Empty: every limit has a source.",
    )
    segments: list[SegmentCertificate] = Field(
        [], description="The same of each segment that has limits of its own."
    )
    regions: list[RegionCertificate] = Field(
        [], description="Of each move with a region, the proof that the tool stays in it."
    )
    min_singular_value: float = Field(
        description="Smallest singular value of the tool Jacobian on the samples, in the rows that "
        "the target at that instant asks for [m and rad]."
    )
    min_singular_value_time: float = Field(description="Time of that sample [s].")
    elongation_sum: float = Field(
        description="Sum over the waypoints of the joint distance from the one before [rad or m]."
    )
    elongation_lower_bound: float = Field(
        description="No joint motion that passes the waypoints as exactly can be shorter "
        "[rad or m]."
    )
    clearance: Clearance | None = Field(
        None,
        description="How near bodies come to each other at any instant, proven between the "
        "samples too; null: nothing was checked.",
    )
