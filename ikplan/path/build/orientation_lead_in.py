"""Parts of a tool path without an orientation that end at a pose with one.

The tool has to arrive there turned as it is asked to be, so that its orientation cannot be left
free up to that point: it turns evenly over the whole part, from the last orientation there was.
A part that no orientation follows stays free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.path.build.items import PathItem
from ikplan.path.coincidence import COINCIDENT
from ikplan.path.pieces.piece import Piece, Pose
from ikplan.path.pieces.steady import line
from ikplan.path.rotation.geodesic import shortest_turn
from ikplan.path.rotation.so3 import exp

__all__ = ["lead_in_orientations"]


def lead_in_orientations(
    items: Sequence[PathItem], begin: Pose, name: str, free_axis: int | None
) -> list[PathItem]:
    """Return items whose free parts lead to the orientations that come after them.

    Args:
        items: The items of a path.
        begin: Where the path begins.
        name: What the request calls that pose.
        free_axis: Axis of the tool (0, 1, 2) about which its orientation is free; None: none.

    Raises:
        InvalidRequest: Two orientations are 180 degrees apart and nothing tells which way to turn.
    """
    turned_items: list[PathItem] = []
    free_items: list[PathItem] = []
    R0 = begin.R
    before: Piece | None = None  # what gave the last orientation, where R0 does not

    def lead(R1: Array, to: str) -> None:
        turn = np.zeros(3)
        last = R0 if before is None else before.pose(1.0)[0]
        if last is not None:
            turn = shortest_turn(last, R1, (name, to), free_axis=free_axis, field=to)
        turned_items.extend(_turning(free_items, R1 if last is None else last, turn))
        free_items.clear()

    for item in items:
        end = item.waypoints[-1] if item.waypoints else None
        to = name if end is None else end.name
        if item.piece.oriented:
            if free_items:
                lead(item.piece.pose(0.0)[0], to)
            turned_items.append(item)
            before, name = item.piece, to
            continue
        free_items.append(item)
        if end is not None and end.pose.R is not None:
            lead(end.pose.R, to)
            R0, before, name = end.pose.R, None, to
    return turned_items + free_items


def _turning(free_items: Sequence[PathItem], R0: Array, turn: Array) -> list[PathItem]:
    """Return the items with an orientation that turns evenly over all of them."""
    total = sum(item.piece.length for item in free_items)
    if total == 0.0:
        # No way to turn on: turn on the spot, then stay.
        if np.linalg.norm(turn) <= COINCIDENT:
            turn = np.zeros(3)
        first, *others = free_items
        p = first.piece.pose(0.0)[1]
        spot = line(p, p, R0, turn)
        waypoints = [replace(m, s=spot.length) for m in first.waypoints]
        R1 = R0 @ exp(turn)
        return [
            replace(first, piece=spot, waypoints=waypoints),
            *(replace(o, piece=o.piece.with_turning(R1, np.zeros(3))) for o in others),
        ]
    rate, so_far, turned = turn / total, 0.0, []
    for item in free_items:
        piece = item.piece.with_turning(R0 @ exp(so_far * rate), rate)
        so_far += piece.length
        turned.append(replace(item, piece=piece))
    return turned
