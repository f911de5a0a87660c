"""The path of a request: waypoints or segments, and what must hold along them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    SerializationInfo,
    SerializerFunctionWrapHandler,
    Tag,
    model_serializer,
    model_validator,
)

from ikplan.documents import HASHED, MAX_NUMBER, Document, IfGiven, as_list
from ikplan.documents.curve import (
    CircleSegment,
    HelixSegment,
    RoseSegment,
    SawtoothSegment,
    SinusoidSegment,
    TrapezoidSegment,
)
from ikplan.documents.poses import Frame, Tolerance, Waypoint
from ikplan.documents.segment import (
    ArcSegment,
    JointSegment,
    LineSegment,
    MoveSegment,
    SplineSegment,
)

__all__ = [
    "AxisFreedom",
    "Event",
    "OrientationFree",
    "PathRequest",
    "PathTolerance",
    "Segment",
    "ToleranceBox",
]

MAX_WAYPOINTS = 20_000
MAX_SEGMENTS = 20_000

Segment = Annotated[
    LineSegment
    | ArcSegment
    | SplineSegment
    | JointSegment
    | MoveSegment
    | CircleSegment
    | HelixSegment
    | RoseSegment
    | SinusoidSegment
    | SawtoothSegment
    | TrapezoidSegment,
    Field(discriminator="type"),
]

_Widths = Annotated[
    list[Annotated[float, Field(ge=0, le=1)]],
    BeforeValidator(as_list),
    Field(min_length=3, max_length=3),
]
_Angles = Annotated[
    list[Annotated[float, Field(ge=0, le=3.2)]],
    BeforeValidator(as_list),
    Field(min_length=3, max_length=3),
]


class ToleranceBox(Document):
    """A box around each target within which the tool may be wherever the joints move least.

    ``position`` and ``orientation`` of the tolerance say how exactly the box is kept.
    """

    position: _Widths = Field(
        [0.0, 0.0, 0.0], description="Half widths along x, y and z of the frame [m]."
    )
    orientation: _Angles = Field(
        [0.0, 0.0, 0.0],
        description="Half widths of the rotation vector from the target's orientation to the "
        "tool's, about x, y and z of the frame [rad].",
    )
    frame: Literal["tool", "path"] = Field(
        "tool",
        description='Whose axes: "tool": of the orientation asked for at the target, of the base '
        'where none is asked for, as with orientation_free "all"; "path": of the path frame.',
    )


class PathTolerance(Tolerance):
    """How far from the waypoints, and from the path between them, the tool may be."""

    box: ToleranceBox | None = Field(
        None, description="A box of freedom around each target; null: none."
    )


class AxisFreedom(Document):
    """Orientations that are as good as the one asked for."""

    about: Literal["tool_x", "tool_y", "tool_z"] = Field(
        description="Axis of the tool about which it may turn freely."
    )
    cone: float | None = Field(
        None,
        gt=0,
        le=3.141592653589793,
        description="Half angle of the cone around its direction asked for in which that axis may "
        "point [rad]; null: it points there within the orientation tolerance.",
    )


def _free_tag(value: Any) -> str:
    return "[name]" if isinstance(value, str) else "[axis]"


# Tagged, so that an error names the form that the user wrote, not both.
OrientationFree = Annotated[
    Annotated[Literal["all"], Tag("[name]")] | Annotated[AxisFreedom, Tag("[axis]")],
    Discriminator(_free_tag),
]


_Signed = Annotated[float, Field(ge=-MAX_NUMBER, le=MAX_NUMBER)]


class Event(Document):
    """A place or a time of the motion, such as that of an output: exactly one of both."""

    name: str = Field(min_length=1, max_length=200, description="Its name.")
    segment: Annotated[int, Field(ge=0)] | None = Field(
        None,
        description="Number of the segment that it is on, from 0; of waypoints, segment k ends at "
        "waypoint k. null: the whole motion.",
    )
    distance: _Signed | None = Field(
        None,
        description="Distance of the tool from the begin of the segment, along the path [m]; "
        "negative: from its end, backwards. On joint motions and moves, along the tool's own way.",
    )
    time: _Signed | None = Field(
        None,
        description="Time since the begin of the segment [s]; negative: before its end.",
    )

    @model_validator(mode="after")
    def _one(self) -> Event:
        if (self.distance is None) == (self.time is None):
            raise ValueError("give a distance or a time")
        return self


class PathRequest(Document):
    """The path of the tool: exactly one of ``waypoints`` and ``segments``."""

    frame: Frame = Field(default_factory=Frame, description="The path frame, in the robot's base.")
    waypoints: list[Waypoint] | None = Field(
        None,
        min_length=1,
        max_length=MAX_WAYPOINTS,
        description="Poses of the tool, in order; or segments instead.",
    )
    segments: list[Segment] | None = Field(
        None,
        min_length=1,
        max_length=MAX_SEGMENTS,
        description="Typed segments, each beginning where the one before ended; or waypoints "
        "instead.",
    )
    interpolation: Literal["joint", "line", "spline"] = Field(
        "joint",
        description='How waypoints are joined. "joint": a joint spline from the start through '
        'them; "line": the tool follows straight lines, its orientation the shortest arc; '
        '"spline": the tool follows a C2 curve. Between waypoints that do not both have an '
        "orientation it is free.",
    )
    begin: Waypoint | None = Field(
        None,
        description="Pose at which the first segment begins; null: the tool's pose at the start. "
        'Wanted where a line or an arc is first and the start is "free" or the approach "joint" '
        'or "move".',
    )
    approach: Literal["path", "joint", "move"] = Field(
        "path",
        description='How the path is reached from the start. "path": in the manner of the path, '
        'for segments by a line; "joint": by a joint motion; "move": by a joint motion around '
        "what is in the way.",
    )
    blend: float | None = Field(
        None,
        ge=0,
        le=10,
        description="Radius of the ball around each corner within which it is rounded [m], where "
        "its segment does not say otherwise; 0: exact corners, where the motion stops; null: as "
        "`corners` says. Corners that turn back, or at which the tool turns on the spot, stay "
        "exact.",
    )
    corners: Annotated[Literal["tolerance", "exact"], IfGiven()] = Field(
        "tolerance",
        description='Corners for which neither the path nor a segment gives a blend. "tolerance": '
        "rounded within the tolerance and passed without a stop; corners that turn back, at which "
        'the tool turns on the spot, or where its orientation becomes free stay exact. "exact": '
        "the motion stops there.",
    )
    orientation_free: OrientationFree | None = Field(
        None,
        description='Freedom of orientation: null: none; "all": only positions count; or about '
        "an axis of the tool, within a cone or not.",
    )
    tolerance: PathTolerance = Field(
        default_factory=PathTolerance, description="Deviation allowed from the path."
    )
    order: Annotated[Literal["given", "free"], IfGiven()] = Field(
        "given",
        description='"given": the path is passed as it is written; "free": its tasks are done in '
        "the fastest order found, which never takes longer, or moves the joints farther, than the "
        "given one. Waypoints "
        "with joint motions between them are a task each; of segments, a task begins at each move "
        "or joint motion, and what is carried keeps those it is carried over together.",
    )
    stay_last: Annotated[Annotated[int, Field(ge=0, le=MAX_SEGMENTS)], IfGiven()] = Field(
        0,
        description="How many of the last waypoints or segments stay the last ones where the "
        "order is free.",
    )

    @model_serializer(mode="wrap")
    def _written(
        self, write: SerializerFunctionWrapHandler, info: SerializationInfo
    ) -> dict[str, Any]:
        """Write the path; for its hash, a blend that is not given as before there were corners."""
        written: dict[str, Any] = write(self)
        if info.context and info.context.get(HASHED) and self.blend is None:
            written["blend"] = 0.0
            if self.segments is not None or self.interpolation == "line":
                written["corners"] = self.corners
        return written

    @model_validator(mode="after")
    def _one_form(self) -> PathRequest:
        if bool(self.waypoints) == bool(self.segments):
            given = "both" if self.waypoints else "neither"
            raise ValueError(f"give exactly one of waypoints and segments; got {given}")
        if self.segments and self.interpolation != "joint":
            raise ValueError("interpolation is for waypoints; segments say what they are")
        if self.waypoints and self.begin is not None:
            raise ValueError("begin is for segments; waypoints begin at the first of them")
        if self.waypoints and self.blend and self.interpolation != "line":
            raise ValueError('blend is for lines only: set interpolation to "line"')
        if self.order == "free" and self.waypoints and self.interpolation != "joint":
            raise ValueError(
                'the order of waypoints is free with interpolation "joint" only; '
                "write what belongs together as segments that begin with a move"
            )
        parts = len(self.waypoints or self.segments or ())
        if self.stay_last and (self.order == "given" or self.stay_last > parts):
            raise ValueError(
                f'stay_last is for order "free", and at most {parts}: how many of the last parts '
                "stay where they are"
            )
        return self
