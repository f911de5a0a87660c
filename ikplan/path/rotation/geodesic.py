"""The shortest turn from one orientation to another."""

from __future__ import annotations

import math

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.errors import InvalidRequest
from ikplan.path.rotation.so3 import log

__all__ = ["AMBIGUOUS", "refuse_half_turn", "shortest_turn"]


AMBIGUOUS = 1e-6
"""Turns this near to 180 degrees go either way [rad]."""


def shortest_turn(
    R0: Array,
    R1: Array,
    names: tuple[str, str],
    *,
    turn_axis: Array | None = None,
    free_axis: int | None = None,
    field: str = "",
    turn: Array | None = None,
) -> Array:
    """Return the rotation vector, in the tool frame, that turns R0 to R1.

    Args:
        R0: Rotation at the begin, shape (3, 3).
        R1: Rotation at the end, shape (3, 3); the same array: no turn, to the last digit.
        names: What the request calls the two poses.
        turn_axis: Unit direction in the base, shape (3,): turn about the one of the two possible
            axes that is nearer to this one, be it the longer way; None: the shorter way.
        free_axis: Axis of the tool (0, 1, 2) about which its orientation is free; a half turn
            about it is as good one way as the other.
        field: Field of the request to be named in an error.
        turn: The shorter way, where it is known already.

    Raises:
        InvalidRequest: The orientations are 180 degrees apart and nothing tells which way.
    """
    if R1 is R0:
        return np.zeros(3)
    turn = log(R0.T @ R1) if turn is None else turn
    angle = length_of(turn)
    if turn_axis is not None:
        if angle < AMBIGUOUS:
            return turn
        cosine = float((R0 @ turn) @ turn_axis) / angle
        if abs(cosine) < 1e-6:
            raise InvalidRequest(
                f"{field}.turn_axis: {names[0]} and {names[1]} are turned about an axis at right "
                "angles to it, so that it does not tell which way",
                field=f"{field}.turn_axis",
                allowed=f"a direction nearer to {np.round(R0 @ turn / angle, 6).tolist()} of the "
                "base, or to its opposite",
            )
        return turn if cosine > 0.0 else turn * (1.0 - 2.0 * math.pi / angle)
    if angle > math.pi - AMBIGUOUS:
        about = turn / angle
        if free_axis is None or abs(abs(about[free_axis]) - 1.0) > AMBIGUOUS:
            refuse_half_turn(names, field)
    return turn


def refuse_half_turn(names: tuple[str, str], field: str) -> None:
    """Refuse two orientations that are 180 degrees apart.

    Raises:
        InvalidRequest: Always.
    """
    raise InvalidRequest(
        f"{field}: the orientations of {names[0]} and {names[1]} are 180 degrees apart, and the "
        "tool could turn either way; put a pose between them, or use a line or arc segment with "
        "turn_axis",
        field=field,
        allowed="orientations less than 180 degrees apart",
    )
