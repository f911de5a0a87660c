"""The documents of shapes. SI units: metres."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from ikplan.documents.base import Document, as_list

__all__ = [
    "MAX_COORDINATE",
    "MAX_POINTS",
    "BoxShape",
    "CapsuleShape",
    "ConvexShape",
    "CylinderShape",
    "MeshShape",
    "Metres3",
    "PointsShape",
    "Shape",
    "SphereShape",
    "point_count",
]

MAX_COORDINATE = 1_000.0
"""Farthest place and largest size of a shape [m]: a larger one is a mistake in the unit."""
MAX_POINTS = 100_000
"""Most points of all shapes of a scene."""


def _metres(value: float) -> float:
    if abs(value) > MAX_COORDINATE:
        raise ValueError(
            f"lengths are in metres, at most {MAX_COORDINATE:,.0f} m; {value:g} looks like "
            f"millimetres: {value / 1000:g} m"
        )
    return value


def _all_metres(values: list[float]) -> list[float]:
    for value in values:
        _metres(value)
    return values


def _points_metres(points: list[list[float]]) -> list[list[float]]:
    _metres(max((max(map(abs, point)) for point in points), default=0.0))
    return points


Length = Annotated[float, Field(gt=0), AfterValidator(_metres)]
Metres3 = Annotated[
    list[float],
    BeforeValidator(as_list),
    Field(min_length=3, max_length=3),
    AfterValidator(_all_metres),
]
"""A position [m]; the error of a coordinate that must be in millimetres says so."""
_Point = Annotated[list[float], BeforeValidator(as_list), Field(min_length=3, max_length=3)]
_Points = Annotated[
    list[_Point],
    Field(min_length=1, max_length=MAX_POINTS),
    BeforeValidator(as_list),
    AfterValidator(_points_metres),
]


class _Typed(Document):
    """A shape whose type is written wherever the shape is, also where Python left it out."""

    def model_post_init(self, _context: Any) -> None:
        """Count the type as given."""
        self.model_fields_set.add("type")


class BoxShape(_Typed):
    """A box, centred in its frame."""

    type: Literal["box"] = "box"
    size: Annotated[list[Length], BeforeValidator(as_list), Field(min_length=3, max_length=3)] = (
        Field(description="Full edges along x, y and z [m].")
    )


class SphereShape(_Typed):
    """A sphere, centred in its frame."""

    type: Literal["sphere"] = "sphere"
    radius: Length = Field(description="Radius [m].")


class CylinderShape(_Typed):
    """A cylinder about z, centred in its frame."""

    type: Literal["cylinder"] = "cylinder"
    radius: Length = Field(description="Radius [m].")
    length: Length = Field(description="Length along z [m].")


class CapsuleShape(_Typed):
    """A cylinder about z with round ends, centred in its frame."""

    type: Literal["capsule"] = "capsule"
    radius: Length = Field(description="Radius [m].")
    length: Length = Field(description="Length along z between the centres of the ends [m].")


class ConvexShape(_Typed):
    """The convex hull of points."""

    type: Literal["convex"] = "convex"
    points: _Points = Field(description="Points, shape (n, 3) [m].")


class PointsShape(_Typed):
    """Points that each stand for a sphere: a point cloud."""

    type: Literal["points"] = "points"
    points: _Points = Field(description="Centres, shape (n, 3) [m].")
    radius: Length = Field(description="Radius about each [m].")


class MeshShape(_Typed):
    """A mesh, of which the convex hull is taken."""

    type: Literal["mesh"] = "mesh"
    file: str = Field(
        min_length=1,
        max_length=4096,
        description="Path of an STL, OBJ or DAE file; in Python, the shell and the client only, "
        "which send its hull.",
    )
    scale: float = Field(
        1.0, gt=0, le=1000, description="Factor on its coordinates; 0.001 for millimetres."
    )


Shape = Annotated[
    BoxShape | SphereShape | CylinderShape | CapsuleShape | ConvexShape | PointsShape | MeshShape,
    Field(discriminator="type"),
]


def point_count(shape: Shape) -> int:
    """Return how many points a shape is given by; 0 for one given by its sizes."""
    return len(shape.points) if isinstance(shape, ConvexShape | PointsShape) else 0
