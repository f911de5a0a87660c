"""The request of a timing: a joint path of one's own, timed and certified without planning."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from ikplan.documents import (
    BUDGET_COUNTS,
    MAX_BUDGET_S,
    Document,
    Floats,
    IfGiven,
    as_list,
    content_hash,
)
from ikplan.documents.limits import LimitOptions, SamplingOptions, SegmentLimits
from ikplan.documents.poses import Tolerance
from ikplan.documents.scene import FixedJoints, GivenScene, ToolFrame

__all__ = ["PathNearness", "TimingRequest", "TimingSegment"]

Rows = Annotated[
    list[Floats], BeforeValidator(as_list), Field(min_length=1, max_length=20_000)
]  # fmt: skip
Index = Annotated[int, Field(ge=0)]


_Near = Annotated[float, Field(ge=1e-8, le=1000)]
_NearEach = Annotated[list[_Near], Field(min_length=1, max_length=1000), Tag("[values]")]


def _tolerance_tag(value: Any) -> str:
    if isinstance(value, list):
        return "[values]"
    return "[object]" if isinstance(value, dict | Document) else "[number]"


# Tagged, so that an error names the form that the user wrote, not all.
PathNearness = Annotated[
    Annotated[_Near, Tag("[number]")] | _NearEach | Annotated[Tolerance, Tag("[object]")],
    Discriminator(_tolerance_tag),
    BeforeValidator(as_list),
]


class TimingSegment(Document):
    """A part of the path, from one waypoint to a later one, with limits of its own."""

    first: Index = Field(description="Index of the waypoint at which it begins.")
    last: Index = Field(description="Index of the waypoint at which it ends.")
    limits: SegmentLimits

    @model_validator(mode="after")
    def _forward(self) -> TimingSegment:
        if not self.first < self.last:
            raise ValueError(f"last must be after first, not {self.last} after {self.first}")
        return self


class TimingRequest(Document):
    """A request for the timing of a joint path (v1)."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    waypoints: Rows = Field(
        description="Joint values that the motion passes, waypoints or samples of a path, shape "
        "(n, dof) [rad or m]."
    )
    rest_at: Annotated[list[Index], BeforeValidator(as_list)] = Field(
        [], description="Indices of waypoints where the motion stops and may turn a sharp corner."
    )
    tolerance: Annotated[PathNearness | None, IfGiven()] = Field(
        None,
        description="How far the motion may be from the polyline through the waypoints, and from "
        "each of them: of every joint, one value each or one for all [rad or m]; or of the tool, "
        "`position` [m] and `orientation` [rad]. Within it, the motion takes a smooth path, so "
        "that noise of the waypoints costs no time. null: a spline through the waypoints.",
    )
    times: Annotated[
        list[Annotated[float, Field(ge=0, le=1e6)] | None] | None,
        BeforeValidator(as_list),
        IfGiven(),
    ] = Field(
        None,
        description="When each waypoint is passed [s]; null in the list: whenever it suits. The "
        "first is 0, the last is given. Refused with the earliest feasible ones found. null: as "
        "soon as the limits allow.",
    )
    start_velocity: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint velocities at the start, shape (dof,) [rad/s or m/s], for a robot that "
        "moves already; null: at rest. Joint motions begin tangent to it; a tool path has to begin "
        "along it. What is not feasible is refused with the nearest that is.",
    )
    start_acceleration: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint accelerations at the start, shape (dof,) [rad/s^2 or m/s^2]; they count "
        "where jerks are limited. null: none.",
    )
    end_velocity: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint velocities at the end, shape (dof,) [rad/s or m/s]; null: at rest.",
    )
    tool: ToolFrame = Field(
        default_factory=ToolFrame,
        description="The tool frame (TCP), in the tip frame, and the shape of the tool.",
    )
    scene: Annotated[GivenScene | None, IfGiven()] = Field(
        None,
        description="What stands around the arm and what it carries, or the id of a scene that "
        "the service holds; null: no collisions are checked.",
    )
    fixed_joints: FixedJoints = Field(
        {},
        description="Values of joints beside the chain, such as a gripper's fingers [rad or m]; "
        "absent: as the robot's description has them.",
    )
    limits: LimitOptions = Field(default_factory=LimitOptions)
    segments: Annotated[list[TimingSegment], BeforeValidator(as_list), Field(max_length=10_000)] = (
        Field([], description="Parts of the path with limits of their own; the strictest holds.")
    )
    sampling: SamplingOptions = Field(default_factory=SamplingOptions)
    budget_s: float = Field(
        10.0, gt=0, le=MAX_BUDGET_S, description=f"Time budget [s]: {BUDGET_COUNTS}."
    )

    @model_validator(mode="after")
    def _one_clock(self) -> TimingRequest:
        if self.times is not None and (
            self.limits.duration is not None or self.tolerance is not None
        ):
            raise ValueError("times go neither with limits.duration nor with tolerance")
        return self

    def content_hash(self, *context: str) -> str:
        """Return the id of the timing: a hash of this request in canonical form and its context.

        Args:
            context: What else decides the timing: the robot's fingerprint and the version.

        Returns:
            32 hexadecimal digits.
        """
        return content_hash(self, *context)
