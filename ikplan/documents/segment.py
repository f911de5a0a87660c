"""The segments of a path: lines, arcs, splines, joint motions and moves around obstacles.

A segment begins where the one before ended; the first at the start of the path. Poses are of the
tool frame in the path frame, in metres and radians. The named curves are in
:mod:`ikplan.documents.curve`.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    SerializationInfo,
    SerializerFunctionWrapHandler,
    Tag,
    field_validator,
    model_serializer,
    model_validator,
)

from ikplan.documents import HASHED, Document, Floats, IfGiven, Vec3
from ikplan.documents.limits import SegmentLimits
from ikplan.documents.poses import Frame, Quaternion, Waypoint, unit_quaternion
from ikplan.documents.shape import Metres3

__all__ = [
    "UPWARDS",
    "ArcSegment",
    "BaseSegment",
    "EndOrientation",
    "JointSegment",
    "JointTarget",
    "LineSegment",
    "MoveRegion",
    "MoveSegment",
    "MoveTarget",
    "OrientationRule",
    "RegionBox",
    "SplineSegment",
    "ToolCone",
    "ToolSegment",
]

MAX_SPLINE_POSES = 20_000
MAX_MOVE_TARGETS = 100

UPWARDS = (0.0, 0.0, 1.0)
"""The axis of an arc by centre and angle that names none."""


def direction(vector: list[float] | None) -> list[float] | None:
    """Refuse an axis too short to have a direction.

    Raises:
        ValueError: The vector is shorter than 1e-9.
    """
    if vector is not None and not math.hypot(*vector) >= 1e-9:
        raise ValueError("an axis needs a length")
    return vector


class EndOrientation(Document):
    """The orientation to be reached at the end of a curve."""

    quaternion_xyzw: Quaternion = Field(
        description="Tool orientation at the end, unit quaternion (x, y, z, w); the tool turns to "
        "it along the shortest arc, evenly over the length."
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)


def _orientation_tag(value: Any) -> str:
    return "[rule]" if isinstance(value, str) else "[end]"


# Tagged, so that an error names the form that the user wrote, not both.
OrientationRule = Annotated[
    Annotated[Literal["constant", "follow", "free"], Tag("[rule]")]
    | Annotated[EndOrientation, Tag("[end]")],
    Discriminator(_orientation_tag),
]


class BaseSegment(Document):
    """What every segment has."""

    limits: SegmentLimits | None = Field(
        None,
        description="Limits of the motion on this segment, its rounded corners included, on top "
        "of those of the request: the strictest holds; null: none of its own.",
    )
    dwell: Annotated[float, Field(ge=0, le=3600), IfGiven()] = Field(
        0.0,
        description="How long the motion stands at the end of the segment [s]; the corner there is "
        "exact then.",
    )

    @model_validator(mode="before")
    @classmethod
    def _exact_where_it_stands(cls, value: Any) -> Any:
        if not isinstance(value, dict) or not value.get("dwell") or "blend" not in cls.model_fields:
            return value
        if value.get("blend"):
            raise ValueError("dwell: a corner that is rounded by a blend has no place to stand at")
        return {**value, "blend": 0.0}


class ToolSegment(BaseSegment):
    """What every segment led by the tool has."""

    blend: float | None = Field(
        None,
        ge=0,
        le=10,
        description="Radius of the ball around the corner at the end of the segment within which "
        "the corner is rounded [m]; 0: exact, the motion stops there; null: as the path says, and "
        "exact where a joint motion follows.",
    )


class LineSegment(ToolSegment):
    """A straight line of the tool; with the same position, a turn on the spot."""

    type: Literal["line"] = Field(description="A straight line.")
    to: Waypoint = Field(description="Pose at the end; without orientation: free on the way.")
    turn_axis: Vec3 | None = Field(
        None,
        description="The tool turns about the one of the two possible axes that is nearer to this "
        "one, in the path frame (right-hand rule); null: along the shortest arc. Needed where the "
        "orientations are 180 degrees apart.",
    )

    _axis = field_validator("turn_axis")(direction)


class ArcSegment(ToolSegment):
    """A circular arc: through ``via`` to ``to``, or about ``centre`` by ``angle`` or to ``to``."""

    type: Literal["arc"] = Field(description="A circular arc.")
    via: Vec3 | None = Field(None, description="A point the arc passes on its way to `to` [m].")
    to: Waypoint | None = Field(
        None,
        description="Pose at the end, with `via` or `centre`; without orientation: free on the "
        "way.",
    )
    centre: Vec3 | None = Field(
        None,
        description="With `angle`: a point of the axis that the arc turns about; with `to`: the "
        "centre of the circle, which the arc follows the shorter way, less than half a turn, or, "
        "with `axis`, right-handed about it [m].",
    )
    angle: float | None = Field(
        None, ge=-200.0, le=200.0, description="Angle turned about the axis, signed [rad]."
    )
    axis: Vec3 | None = Field(
        None,
        description="Direction of the axis through `centre`, in the path frame. Null: z with "
        "`angle`; with `to`, whichever makes the shorter way.",
    )
    orientation: OrientationRule = Field(
        "constant",
        description='With `angle`: "constant", "follow" (the tool turns with the arc), "free", or '
        "the orientation at the end.",
    )
    turn_axis: Vec3 | None = Field(
        None, description="As for a line: settles about which axis the tool turns."
    )

    _axes = field_validator("axis", "turn_axis")(direction)

    @model_serializer(mode="wrap")
    def _written(
        self, write: SerializerFunctionWrapHandler, info: SerializationInfo
    ) -> dict[str, Any]:
        """Write the arc; for its hash, an axis as before one could be left out."""
        written: dict[str, Any] = write(self)
        if info.context and info.context.get(HASHED):
            if self.axis is None:
                written["axis"] = list(UPWARDS)
            elif self.angle is None:
                written["right_handed"] = True
        return written

    @model_validator(mode="after")
    def _one_form(self) -> ArcSegment:
        fields = ("via", "to", "centre", "angle")
        given = {field for field in fields if getattr(self, field) is not None}
        if given not in ({"via", "to"}, {"centre", "angle"}, {"centre", "to"}):
            raise ValueError(
                "an arc is given by via and to, or by centre and angle, or by centre and to"
            )
        if self.angle is None and self.orientation != "constant":
            raise ValueError("orientation belongs to an arc given by centre and angle")
        if self.centre is None and self.axis is not None:
            raise ValueError("axis belongs to an arc given by its centre")
        if self.angle is not None and abs(self.angle) < 1e-12:
            raise ValueError("an arc needs an angle other than 0")
        return self


class SplineSegment(ToolSegment):
    """A curve of continuous curvature through poses (C2: a cubic spline over the chord length).

    The orientation is led through every run of poses that have one, and free elsewhere. Where a
    position is repeated the curve ends and a new one begins.
    """

    type: Literal["spline"] = Field(description="A C2 curve through poses.")
    through: list[Waypoint] = Field(
        min_length=1,
        max_length=MAX_SPLINE_POSES,
        description="Poses passed, in order, after the end of the segment before.",
    )


class JointSegment(BaseSegment):
    """A joint motion; the tool's path is what follows from it.

    Neighbouring joint segments are one joint spline through their ends, passed without a stop.
    """

    type: Literal["joint"] = Field(description="A joint motion.")
    q: Floats | None = Field(
        None, min_length=1, description="Joint values at the end, shape (dof,) [rad or m]."
    )
    to: Waypoint | None = Field(None, description="Or the pose of the tool at the end.")
    blend: Annotated[Annotated[float, Field(ge=0, le=10)] | None, IfGiven()] = Field(
        None,
        description="Radius of the ball around the corner to the tool's path that follows, within "
        "which the corner is rounded [m]; null or 0: exact, the motion stops there.",
    )

    @model_validator(mode="after")
    def _one_target(self) -> JointSegment:
        if (self.q is None) == (self.to is None):
            raise ValueError("a joint motion is to q or to a pose: exactly one of q and to")
        return self


class JointTarget(Document):
    """Joint values that a move may go to."""

    q: Floats = Field(min_length=1, description="Joint values, shape (dof,) [rad or m].")


def _target_tag(value: Any) -> str:
    given = value.get("q") if isinstance(value, dict) else getattr(value, "q", None)
    return "[pose]" if given is None else "[q]"


# Tagged, so that an error names the form that the user wrote, not both.
MoveTarget = Annotated[
    Annotated[JointTarget, Tag("[q]")] | Annotated[Waypoint, Tag("[pose]")],
    Discriminator(_target_tag),
]


_Direction = Annotated[Vec3, AfterValidator(direction)]


class ToolCone(Document):
    """A cone that an axis of the tool stays in."""

    axis: Literal["tool_x", "tool_y", "tool_z"] = Field("tool_z", description="Axis of the tool.")
    direction: _Direction = Field(description="Axis of the cone, in the path frame.")
    angle: float = Field(gt=0, le=3.141592653589793, description="Half angle of the cone [rad].")


class RegionBox(Document):
    """A box that the tool stays in."""

    frame: Frame = Field(description="Its middle and its axes, in the path frame.")
    size: Metres3 = Field(description="Its full edges [m].")

    @field_validator("size")
    @classmethod
    def _wide(cls, size: list[float]) -> list[float]:
        if min(size) <= 0.0:
            raise ValueError("the edges of a box are above 0")
        return size


class MoveRegion(Document):
    """Where the tool stays on a move."""

    cone: ToolCone | None = Field(
        None, description="A cone that an axis of the tool stays in, to keep it upright; null: any."
    )
    box: RegionBox | None = Field(
        None, description="A box that the tool's position stays in; null: anywhere."
    )

    @model_validator(mode="after")
    def _one_at_least(self) -> MoveRegion:
        if self.cone is None and self.box is None:
            raise ValueError("give a cone, a box or both")
        return self


class MoveSegment(BaseSegment):
    """A joint motion around what is in the way; it begins and ends at rest.

    Where a straight joint motion is free of contact it is taken.
    """

    type: Literal["move"] = Field(description="A joint motion around obstacles.")
    q: Floats | None = Field(
        None, min_length=1, description="Joint values at the end, shape (dof,) [rad or m]."
    )
    to: Waypoint | None = Field(
        None,
        description="Or the pose of the tool at the end: any configuration that meets it, over "
        "full turns of the joints and the self-motion of the arm.",
    )
    any: list[MoveTarget] | None = Field(
        None,
        min_length=1,
        max_length=MAX_MOVE_TARGETS,
        description="Or several poses and joint values, of which the move goes to the one with "
        "the shortest way found. What follows is a move or a joint motion: a tool path would not "
        "know where it begins.",
    )

    within: MoveRegion | None = Field(
        None,
        description="Where the tool stays on the way, proven along the timed motion; null: "
        "anywhere.",
    )

    @model_serializer(mode="wrap")
    def _written(
        self, write: SerializerFunctionWrapHandler, info: SerializationInfo
    ) -> dict[str, Any]:
        """Write the move; for its hash, one without a region as before there were regions."""
        written: dict[str, Any] = write(self)
        if info.context and info.context.get(HASHED) and self.within is None:
            del written["within"]
        return written

    @model_validator(mode="after")
    def _one_target(self) -> MoveSegment:
        if sum(target is not None for target in (self.q, self.to, self.any)) != 1:
            raise ValueError(
                "a move is to q, to a pose or to any of several: exactly one of q, to and any"
            )
        return self
