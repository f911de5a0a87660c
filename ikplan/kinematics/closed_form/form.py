"""Which closed form the inverse kinematics of a chain has, found from its axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import forward_into

__all__ = [
    "FIRST_MEET",
    "FIRST_PARALLEL",
    "NO_FORM",
    "SECOND_MEET",
    "SECOND_PARALLEL",
    "THREE_PARALLEL",
    "WITHOUT_FORM",
    "ClosedForm",
    "find_closed_form",
]

NO_FORM = 0
"""No closed form is known."""
THREE_PARALLEL = 1
"""Axes 2, 3 and 4 are parallel, 5 and 6 meet, as in the arms of Universal Robots."""
SECOND_PARALLEL = 2
"""Axes 4, 5 and 6 meet in one point, 2 and 3 are parallel: nearly every industrial arm."""
FIRST_MEET = 3
"""Axes 4, 5 and 6 meet in one point, 1 and 2 in another."""
SECOND_MEET = 4
"""Axes 4, 5 and 6 meet in one point, 2 and 3 in another."""
FIRST_PARALLEL = 5
"""Axes 4, 5 and 6 meet in one point, 1 and 2 are parallel."""

_PARALLEL = 1e-9
"""Largest sine of the angle between parallel axes."""
_MEET = 1e-9
"""Largest distance of axes that meet [m]."""


class ClosedForm(NamedTuple):
    """An arm as its closed form takes it, in the base, where not said, at joint values of zero.

    Attributes:
        kind: One of the constants of this module.
        h: Joint axes, shape (6, 3).
        v: Vectors between points on the axes, shape (5, 3) [m]: to axis 1 from the base, then from
            axis to axis, to the wrist centre at last; those behind it are zero. Where axes meet,
            the point is on both.
        sign: 1 or -1 of axes 3 and 4 that are parallel to axis 2, shape (2,).
        R: Rotation of the tool, shape (3, 3).
        centre: Wrist centre in the tool frame, shape (3,) [m]: where axes 5 and 6 meet.
    """

    kind: int
    h: Array
    v: Array
    sign: Array
    R: Array
    centre: Array


WITHOUT_FORM = ClosedForm(
    NO_FORM, np.zeros((6, 3)), np.zeros((5, 3)), np.zeros(2), np.eye(3), np.zeros(3)
)
"""The form of a chain without one."""


def find_closed_form(chain: Chain) -> ClosedForm:
    """Find the closed form of a chain.

    Args:
        chain: The chain.

    Returns:
        The form; one of the kind ``NO_FORM`` where none is known: the chain has not six joints,
        one slides, joints are coupled, or its axes are not of any of the kinds.
    """
    n = chain.prismatic.shape[0]
    if n != 6 or chain.coupled or chain.prismatic.any():
        return WITHOUT_FORM
    R, p, h, o = np.empty((3, 3)), np.empty(3), np.empty((6, 3)), np.empty((6, 3))
    forward_into(chain, np.zeros(6), R, p, h, o)
    parallel = [bool(np.linalg.norm(np.cross(h[i], h[i + 1])) <= _PARALLEL) for i in range(5)]
    met = [None if parallel[i] else _meeting(o[i], h[i], o[i + 1], h[i + 1]) for i in range(5)]
    wrist = met[4]
    if wrist is None:
        return WITHOUT_FORM
    points = o.copy()
    kind = NO_FORM
    if parallel[1] and parallel[2] and not parallel[0] and not parallel[3]:
        kind = THREE_PARALLEL
    elif met[3] is not None and not parallel[2] and _distance(wrist, o[3], h[3]) <= _MEET:
        if parallel[1] and not parallel[0]:
            kind = SECOND_PARALLEL
        elif met[0] is not None:
            kind = FIRST_MEET
            points[0] = points[1] = met[0]
        elif met[1] is not None and not parallel[0]:
            kind = SECOND_MEET
            points[1] = points[2] = met[1]
        elif parallel[0] and not parallel[1]:
            kind = FIRST_PARALLEL
    if kind == NO_FORM:
        return WITHOUT_FORM
    last = 4 if kind == THREE_PARALLEL else 3
    v = np.zeros((5, 3))
    v[:last] = np.diff(np.vstack([np.zeros(3), points[:last]]), axis=0)
    v[last] = wrist - points[last - 1]
    sign = np.sign([h[1] @ h[2], h[1] @ h[3]])
    return ClosedForm(kind, h, v, sign, R, R.T @ (wrist - p))


def _meeting(o: Array, h: Array, other_o: Array, other_h: Array) -> Array | None:
    """The point where two axes that are not parallel meet, shape (3,) [m], or None."""
    normal = np.cross(h, other_h)
    between = other_o - o
    if abs(between @ normal) > _MEET * np.linalg.norm(normal):
        return None
    along = float(np.cross(between, other_h) @ normal / (normal @ normal))
    point: Array = o + along * h
    return point


def _distance(point: Array, o: Array, h: Array) -> float:
    """Distance of a point from an axis [m]."""
    return float(np.linalg.norm(np.cross(point - o, h)))
