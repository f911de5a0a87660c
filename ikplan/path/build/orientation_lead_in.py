"""Stretches of a tool path without an orientation that end at a pose with one.

The tool has to arrive there turned as it is asked to be, so that its orientation cannot be left
free up to that point: it turns evenly over the whole stretch, from the last orientation there was.
A stretch that no orientation follows stays free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ikplan.path.build.items import Item
from ikplan.path.coincidence import COINCIDENT
from ikplan.path.pieces.piece import Pose
from ikplan.path.pieces.steady import line
from ikplan.path.rotation.geodesic import shortest_turn
from ikplan.path.rotation.so3 import exp

__all__ = ["lead_to_orientations"]

Array = NDArray[np.float64]


def lead_to_orientations(
    items: Sequence[Item], begin: Pose, name: str, free_axis: int | None
) -> list[Item]:
    """Return items whose free stretches lead to the orientations that come after them.

    Args:
        items: The items of a path.
        begin: Where the path begins.
        name: What the request calls that pose.
        free_axis: Axis of the tool (0, 1, 2) about which its orientation is free; None: none.

    Raises:
        InvalidRequest: Two orientations are 180 degrees apart and nothing tells which way to turn.
    """
    led: list[Item] = []
    stretch: list[Item] = []
    R0 = begin.R

    def lead(R1: Array, to: str) -> None:
        turn = np.zeros(3)
        if R0 is not None:
            turn = shortest_turn(R0, R1, (name, to), free_axis=free_axis, field=to)
        led.extend(_turning(stretch, R1 if R0 is None else R0, turn))
        stretch.clear()

    for item in items:
        end = item.marks[-1] if item.marks else None
        to = name if end is None else end.name
        if item.piece.oriented:
            if stretch:
                lead(item.piece.pose(0.0)[0], to)
            led.append(item)
            R0, name = item.piece.pose(1.0)[0], to
            continue
        stretch.append(item)
        if end is not None and end.pose.R is not None:
            lead(end.pose.R, to)
            R0, name = end.pose.R, to
    return led + stretch


def _turning(stretch: Sequence[Item], R0: Array, turn: Array) -> list[Item]:
    """Return the items with an orientation that turns evenly over all of them."""
    total = sum(item.piece.length for item in stretch)
    if total == 0.0:
        # No way to turn on: turn on the spot, then stay.
        if np.linalg.norm(turn) <= COINCIDENT:
            turn = np.zeros(3)
        first, *others = stretch
        p = first.piece.pose(0.0)[1]
        spot = line(p, p, R0, turn)
        marks = [replace(m, s=spot.length) for m in first.marks]
        R1 = R0 @ exp(turn)
        return [
            replace(first, piece=spot, marks=marks),
            *(replace(o, piece=o.piece.with_turning(R1, np.zeros(3))) for o in others),
        ]
    rate, so_far, turned = turn / total, 0.0, []
    for item in stretch:
        piece = item.piece.with_turning(R0 @ exp(so_far * rate), rate)
        so_far += piece.length
        turned.append(replace(item, piece=piece))
    return turned
