"""The junctions between the pieces of a path, and the radii within which they are rounded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, lengths_of
from ikplan.errors import InvalidRequest
from ikplan.path.build.items import PathItem
from ikplan.path.pieces.piece import TURN_LENGTH, dot
from ikplan.path.tool_path import ToolPath

__all__ = ["Junctions", "blend_radii"]


_JUMP = 1e-6
"""A change of direction, or of angular rate times TURN_LENGTH, by more than this is a corner."""
_BACK = 1e-3
"""Two directions this near to opposite turn back, and cannot be blended [rad]."""
_MAX_TURN = 0.9 * np.pi
"""How much both sides of a blend together may turn within its radius [rad]."""
_SHARP = 0.3
"""A change of direction, or of angular rate times TURN_LENGTH, by more than this is sharp."""
_ROUNDING = 1.0 + 1e-12


class Junctions(NamedTuple):
    """What the path does where its pieces meet, one row a junction.

    Attributes:
        jump: Whether direction or angular rate jump, so that the motion must stop.
        back: Whether the path turns back.
        spot: Whether the tool turns on the spot before or after it.
        rate: Angular rates of both sides added, 0 where one is free [rad/m].
        sharp: Whether direction or angular rate change by much.
    """

    jump: Flags
    back: Flags
    spot: Flags
    rate: Array
    sharp: Flags

    @classmethod
    def between(cls, items: Sequence[PathItem]) -> Junctions:
        """Return the junctions between items, in order."""
        if len(items) == 1:
            none = np.zeros(0, dtype=np.bool_)
            return cls(none, none, none, np.zeros(0), none)
        raw = ToolPath(tuple(item.piece for item in items))
        k = np.arange(len(items) - 1)
        before = raw.derivatives_on(k, np.array([item.piece.length for item in items])[:-1])
        after = raw.derivatives_on(k + 1, np.zeros(len(k)))
        oriented = np.array([item.piece.oriented for item in items])
        spots = np.array([item.piece.turns for item in items])
        both = oriented[1:] & oriented[:-1]
        turn = np.where(both, TURN_LENGTH * lengths_of(before.w - after.w), 0.0)
        across = lengths_of(np.cross(before.v, after.v))
        rates = lengths_of(before.w) + lengths_of(after.w)
        return cls(
            (lengths_of(before.v - after.v) > _JUMP) | (turn > _JUMP),
            np.arctan2(across, dot(before.v, after.v)) > np.pi - _BACK,
            spots[1:] | spots[:-1],
            np.where(both, rates, 0.0),
            (lengths_of(before.v - after.v) > _SHARP) | (turn > _SHARP),
        )


def blend_radii(
    items: Sequence[PathItem], junctions: Junctions, default: float, *, joint_after: bool = False
) -> list[float]:
    """Return the radius within which each junction is rounded [m]; 0: not at all.

    Args:
        items: The items of the path.
        junctions: The junctions between them.
        default: Radius of the corners that have none of their own [m]. Junctions that are no
            corners, turn back or belong to a turn on the spot are then left as they are.
        joint_after: Whether there is a corner at the end, to a joint motion.

    Raises:
        InvalidRequest: A radius does not fit, a corner cannot be rounded, or there is none.
    """
    radii = [_radius(item, junctions, k, default) for k, item in enumerate(items[:-1])]
    last = items[-1]
    same = [r for item, r in zip(items, radii, strict=False) if item.field == last.field]
    if last.blend and not any(same) and not joint_after:
        raise InvalidRequest(
            f"{last.field}.blend: there is no corner: the tool's path ends there",
            field=f"{last.field}.blend",
            allowed="0 or null",
        )
    around = [0.0, *radii, 0.0]
    for k, item in enumerate(items):
        _refuse_overlap(items, k, around[k], around[k + 1], item.blend == items[k - 1].blend)
    for k, radius in enumerate(radii):
        if radius * junctions.rate[k] > _MAX_TURN:
            _refuse_radius(items, k, radius, _MAX_TURN / float(junctions.rate[k]), items[k])
    return radii


def _radius(item: PathItem, junctions: Junctions, k: int, default: float) -> float:
    sharp = junctions.spot[k] or junctions.back[k]
    if item.blend is None:
        return 0.0 if sharp or not junctions.jump[k] else default
    if item.blend > 0.0 and sharp:
        why = (
            "the tool turns on the spot there" if junctions.spot[k] else "the path turns back there"
        )
        raise InvalidRequest(
            f"{item.field}.blend: this corner cannot be rounded: {why}",
            field=f"{item.field}.blend",
            allowed="0",
        )
    return item.blend


def _refuse_overlap(
    items: Sequence[PathItem], k: int, begin: float, end: float, alike: bool
) -> None:
    """Refuse radii at the begin and the end of an item that do not fit on it."""
    piece = items[k].piece
    length = piece.length
    # Waypoints and folds inside the item must stay on the path.
    inside = [m.s for m in items[k].waypoints if 0.0 < m.s < length] + list(piece.folds)
    rooms = min(inside, default=length), length - max(inside, default=0.0)
    shared = begin > 0.0 and end > 0.0 and begin + end > length * _ROUNDING
    for radius, other, room, junction in (
        (begin, end, rooms[0], k - 1),
        (end, begin, rooms[1], k),
    ):
        limit = room
        if shared:
            left = 0.5 * length if alike or other >= length else length - other
            limit = min(room, left)
        if radius > limit * _ROUNDING:
            _refuse_radius(items, junction, radius, limit, items[k])


def _refuse_radius(
    items: Sequence[PathItem], junction: int, radius: float, limit: float, item: PathItem
) -> None:
    before, after = items[junction], items[junction + 1]
    name = "path.blend" if before.blend is None else f"{before.field}.blend"
    raise InvalidRequest(
        f"{name}: {radius:.6g} m does not fit at the corner from {before.field} to {after.field}: "
        f"the largest radius that fits on {item.field} ({item.piece.length:.6g} m long) is "
        f"{limit:.6g} m",
        field=name,
        allowed=f"at most {limit:.9g}",
    )
