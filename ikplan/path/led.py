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

from ikplan.path.geodesic import shortest_turn
from ikplan.path.items import Item, Mark
from ikplan.path.piece import Pose
from ikplan.path.rotation import exp
from ikplan.path.steady import line

__all__ = ["lead_to_orientations"]

Array = NDArray[np.float64]

_AT = 1e-9
"""Path lengths this near to one another are one place [m]."""


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
    for item in (part for whole in items for part in _cut(whole)):
        if item.piece.oriented:
            led += stretch
            stretch = []
            led.append(item)
            R0, name = item.piece.pose(1.0)[0], _end_name(item, name)
            continue
        stretch.append(item)
        end = next((m for m in item.marks if m.pose.R is not None), None)
        if end is None or end.pose.R is None:
            continue
        if R0 is None:
            R0, turn = end.pose.R, np.zeros(3)
        else:
            turn = shortest_turn(
                R0, end.pose.R, (name, end.name), free_axis=free_axis, field=end.name
            )
        led += _turning(stretch, R0, turn)
        stretch = []
        R0, name = end.pose.R, end.name
    return led + stretch


def _cut(item: Item) -> list[Item]:
    """Cut a free item at the poses inside it that have an orientation."""
    if item.piece.oriented:
        return [item]
    length = item.piece.length
    cuts = [m.s for m in item.marks if m.pose.R is not None and _AT < m.s < length - _AT]
    if not cuts:
        return [item]
    parts = []
    marks = list(item.marks)
    for a, b in zip([0.0, *cuts], [*cuts, length], strict=True):
        last = b == length
        inside: list[Mark] = [m for m in marks if last or m.s <= b]
        marks = marks[len(inside) :]
        parts.append(
            Item(
                item.piece.trimmed(a, b),
                [replace(m, s=m.s - a) for m in inside],
                item.field,
                item.blend if last else 0.0,
            )
        )
    return parts


def _turning(stretch: Sequence[Item], R0: Array, turn: Array) -> list[Item]:
    """Return the items with an orientation that turns evenly over all of them."""
    total = sum(item.piece.length for item in stretch)
    if total <= _AT:
        # No way to turn on: turn on the spot, then stay.
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


def _end_name(item: Item, name: str) -> str:
    return item.marks[-1].name if item.marks else name
