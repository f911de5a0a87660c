"""The documents of a scene: what stands around an arm, and what it carries.

SI units: metres. Quaternions are ``xyzw``. Obstacles are given in the robot's base frame, the
geometry of a tool in the tip frame, attached bodies in the tool frame.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)

from ikplan.documents.base import Document, IfGiven, as_list
from ikplan.documents.poses import Frame, Quaternion, unit_quaternion
from ikplan.documents.shape import MAX_POINTS, Metres3, Shape, point_count

__all__ = [
    "UNCHECKED",
    "AttachedBody",
    "FixedJoints",
    "GivenScene",
    "Obstacle",
    "Scene",
    "ToolFrame",
    "ToolGeometry",
]

MAX_OBSTACLES = 2_000
MAX_ATTACHED = 100
MAX_TOOL_SHAPES = 100

Name = Annotated[str, Field(min_length=1, max_length=200)]
_Pair = Annotated[list[Name], BeforeValidator(as_list), Field(min_length=2, max_length=2)]


class _Placed(Document):
    """A shape at a pose."""

    name: Name = Field(description="Its name; no two bodies share one.")
    shape: Shape = Field(description="Its shape, in its frame.")
    position: Metres3 = Field([0.0, 0.0, 0.0], description="Position of the shape's frame [m].")
    quaternion_xyzw: Quaternion = Field(
        [0.0, 0.0, 0.0, 1.0], description="Its orientation, unit quaternion (x, y, z, w)."
    )
    padding: float = Field(
        0.0, ge=0, le=1, description="By how much the shape is enlarged on every side [m]."
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)


class Obstacle(_Placed):
    """Something that stands still, in the frame of the robot's base or of a link of its.

    Of a robot whose base moves, such as the plate of a positioner, what stands in the cell is
    given in the frame of a link that stands there.
    """

    link: Annotated[Name | None, IfGiven()] = Field(
        None, description="Link in whose frame it stands, and moves with; null: the base."
    )


class ToolGeometry(_Placed):
    """A part of the tool, in the tip frame."""


def _known_once(names: list[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ValueError(f"two bodies are named {name!r}; each needs a name of its own")
        seen.add(name)


def _tool_names(geometry: list[ToolGeometry]) -> list[ToolGeometry]:
    _known_once([g.name for g in geometry])
    return geometry


class ToolFrame(Frame):
    """The tool frame (TCP), in the tip frame, and the shape of the tool."""

    geometry: Annotated[
        list[ToolGeometry],
        BeforeValidator(as_list),
        Field(max_length=MAX_TOOL_SHAPES),
        AfterValidator(_tool_names),
        IfGiven(),
    ] = Field([], description="Shapes of the tool, in the tip frame, not in the tool frame.")


class AttachedBody(_Placed):
    """Something that the tool carries, in the tool frame."""

    first_segment: int | None = Field(
        None,
        ge=0,
        description="Index of the first segment on which it is carried; of waypoints, segment k "
        "ends at waypoint k. Null: from the start.",
    )
    last_segment: int | None = Field(
        None, ge=0, description="Index of the last such segment; null: to the end."
    )
    touches: Annotated[list[Name], BeforeValidator(as_list), Field(max_length=MAX_OBSTACLES)] = (
        Field([], description="Names of the links and obstacles that it may touch.")
    )

    @model_validator(mode="after")
    def _forward(self) -> AttachedBody:
        first, last = self.first_segment, self.last_segment
        if first is not None and last is not None and last < first:
            raise ValueError(f"last_segment must not be before first_segment: {last} < {first}")
        return self


class Scene(Document):
    """What stands around the arm, what it carries, and what must not touch."""

    obstacles: Annotated[
        list[Obstacle], Field(max_length=MAX_OBSTACLES), BeforeValidator(as_list)
    ] = Field([], description="What stands still, in the robot's base frame.")
    clearance: float = Field(
        0.0, ge=0, le=1, description="Least gap asked for between any two bodies checked [m]."
    )
    self_collision: bool = Field(
        True, description="Whether the arm is checked against itself as well."
    )
    allow: Annotated[list[_Pair], Field(max_length=10_000), BeforeValidator(as_list)] = Field(
        [], description="Pairs of names of bodies that may touch, in either order."
    )
    attached: Annotated[
        list[AttachedBody], Field(max_length=MAX_ATTACHED), BeforeValidator(as_list)
    ] = Field([], description="What the tool carries, in the tool frame.")
    leave_contact: Annotated[bool, IfGiven()] = Field(
        False,
        description="Whether a start in contact is left by a short straight joint motion, during "
        "which the bodies that touch at the start may touch; the certificate says which and until "
        "when. False: such a start is refused.",
    )

    @model_validator(mode="after")
    def _bounded(self) -> Scene:
        bodies = [*self.obstacles, *self.attached]
        _known_once([body.name for body in bodies])
        points = sum(point_count(body.shape) for body in bodies)
        if points > MAX_POINTS:
            raise ValueError(
                f"the shapes of a scene may have {MAX_POINTS:,} points in all, not {points:,}"
            )
        return self


# Made unchecked: what checks scenes is built at the first that a request has.
UNCHECKED = Scene.model_construct(self_collision=False)
"""The scene of a request that switches every check off."""


class SceneUpload(Scene):
    """A scene, and what it is called."""

    name: str | None = Field(
        None, min_length=1, max_length=200, description="What the scene is called, for people."
    )


def _scene_tag(value: Any) -> str:
    return "[id]" if isinstance(value, str) else "[scene]"


# Tagged, so that an error names the form that the user wrote, not both.
GivenScene = Annotated[
    Annotated[Scene, Tag("[scene]")]
    | Annotated[Annotated[str, Field(min_length=1, max_length=200)], Tag("[id]")],
    Discriminator(_scene_tag),
]
"""A scene, or the id of one that a service holds."""

FixedJoints = Annotated[
    dict[Name, Annotated[float, Field(ge=-1e3, le=1e3)]], Field(max_length=64), IfGiven()
]
"""Values of joints beside the chain, by name [rad or m]."""
