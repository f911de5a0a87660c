"""Bodies: rigid things of convex pieces, each carried by the base or by a joint of the chain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Body", "CollisionModel", "ConvexPiece"]


class ConvexPiece(NamedTuple):
    """All points within a radius of the convex hull of some points.

    A sphere is one point and its radius, a capsule two points, a box eight points without a
    radius. Curved shapes of other kinds are enclosed by such a piece.

    Attributes:
        points: Shape (n, 3), n >= 1 [m], in the frame of the body.
        radius: At least 0 [m]; padding is part of it.
    """

    points: NDArray[np.float64]
    radius: float


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body: a link of the robot, a tool, an attached part or an obstacle.

    Attributes:
        name: Its name; no two bodies of a model share one.
        carrier: What it moves with: 0 for the robot's base, k for serial joint k of the robot's
            model, counted from 1 as Pinocchio counts them.
        pieces: Their union encloses the body, in the frame of the carrier: the robot's base frame
            for 0, the frame of joint k of ``robot.model`` otherwise.
        kind: "link", "tool", "attached" or "obstacle".
        source: Where the shape is from, in words.
        excess: How far the pieces reach beyond the shape they enclose, as measured [m].
        first_segment: First segment at which an attached body is there; None: from the start.
        last_segment: Last such segment; None: to the end.
    """

    name: str
    carrier: int
    pieces: tuple[ConvexPiece, ...]
    kind: str = "link"
    source: str = ""
    excess: float = 0.0
    first_segment: int | None = None
    last_segment: int | None = None


@dataclass(frozen=True, eq=False)
class CollisionModel:
    """The bodies of a robot and its scene, and which pairs of them must not touch.

    Attributes:
        bodies: Every body, the robot's first.
        pairs: Indices of two bodies to be kept apart, shape (n, 2); never two with one carrier.
        clearance: Least gap asked for between them [m].
        allowed: Names of pairs that may touch, and why, in words.
        unchecked: Names of links that have no shape, so that nothing is known of them.
    """

    bodies: tuple[Body, ...]
    pairs: NDArray[np.int64]
    clearance: float
    allowed: tuple[tuple[str, str, str], ...] = ()
    unchecked: tuple[str, ...] = ()
