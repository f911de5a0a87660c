"""The parts that a tool path is assembled from."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from ikplan.path.pieces.piece import Piece, Pose

__all__ = ["ItemWaypoint", "PathItem"]


@dataclass(frozen=True)
class ItemWaypoint:
    """A waypoint on an item.

    Attributes:
        s: Its length from the item's begin [m].
        row: Its row among the waypoints of the request.
        name: What the request calls it.
        pose: The pose asked for.
        exact: Whether the item passes it.
    """

    s: float
    row: int
    name: str
    pose: Pose
    exact: bool = True


@dataclass
class PathItem:
    """A piece with what belongs to it.

    Attributes:
        piece: The piece.
        waypoints: The waypoints on it, those at its end included.
        field: Field of the request that it comes from.
        blend: Radius of the corner at its end [m]; None: that of the path.
        empty: Fields of the request that lead nowhere, at its end.
    """

    piece: Piece
    waypoints: list[ItemWaypoint] = dataclasses.field(default_factory=list)
    field: str = ""
    blend: float | None = None
    empty: list[str] = dataclasses.field(default_factory=list)
