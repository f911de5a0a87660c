"""The shapes of a robot's links, as ``robot.yaml`` or a file beside it gives them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ikplan.robots.definition.strict import Number, Strict, Triple

__all__ = ["CollisionEntry", "CollisionFile", "FileOf", "LinkShape", "PieceEntry"]

_Metres = Annotated[Number, Field(ge=0, le=1e3)]


class FileOf(Strict):
    """A file of an installed package, or beside ``robot.yaml``."""

    package: Literal["example-robot-data"] | None = None
    path: str


class PieceEntry(Strict):
    """All points within a radius [m] of the convex hull of some points [m], in the link's frame."""

    points: Annotated[list[Triple], Field(min_length=1, max_length=1_000)]
    radius: _Metres = 0.0


class LinkShape(Strict):
    """The shape of a link: pieces whose union encloses it.

    Attributes:
        source: Where it comes from; absent: that of all links.
        excess: How far the pieces reach beyond the link, as measured [m]; None: not measured.
        pieces: The pieces.
    """

    source: str | None = None
    excess: _Metres | None = None
    pieces: Annotated[list[PieceEntry], Field(min_length=1, max_length=64)]


class CollisionFile(Strict):
    """Shapes made from meshes, in a JSON file beside ``robot.yaml``.

    Attributes:
        source: Where the meshes come from.
        licence: Their licence.
        method: How the pieces were made.
        links: The shape of each link, by name.
    """

    source: str
    licence: str
    method: str
    links: dict[str, LinkShape]


class CollisionEntry(Strict):
    """What ``robot.yaml`` says of the shapes of the links.

    A link takes its shape from ``links``, else from ``file``, else from the URDF.

    Attributes:
        source: Where the shapes in ``links`` come from.
        file: Name of a :class:`CollisionFile` beside ``robot.yaml``.
        srdf: An SRDF whose pairs of links may touch.
        links: The shape of each link, by name.
        allow: Pairs of links that may touch, and why.
    """

    source: str = ""
    file: Annotated[str, Field(pattern=r"^[a-z0-9_]+\.json$")] | None = None
    srdf: FileOf | None = None
    links: dict[str, LinkShape] = Field(default_factory=dict)
    allow: list[tuple[str, str, str]] = Field(default_factory=list)
