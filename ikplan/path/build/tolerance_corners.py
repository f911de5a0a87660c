"""Corners rounded within a share of the tolerance, so that they are passed without a stop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ikplan.arrays import Array, Flags, clamped
from ikplan.documents.path import PathRequest
from ikplan.path.build.corners import Junctions
from ikplan.path.build.found_corners import FoundCorners
from ikplan.path.build.items import PathItem
from ikplan.path.pieces.blend import Blend, blend_corner
from ikplan.path.pieces.piece import PathDerivatives, Piece, dot
from ikplan.path.rotation.so3 import angle_between
from ikplan.path.tolerance_shares import ROUNDING, SMOOTHING, Rounding

__all__ = ["MIDDLE", "CornerTolerance", "may_round", "rounded_corners"]


MIDDLE = 3.0 / 16.0
"""A quintic between lines passes its corner at this share of ``reach |b - a|``."""
_SHORTER = 0.7
_ROUNDING = 1.0 + 1e-6
_TRIES = 12
_PLACES = np.linspace(0.0, 1.0, 17)
_LEAST = 1e-9
"""A corner with less room than this is left exact [m]."""
_HALF = 0.5 * (1.0 - 1e-12)


@dataclass(frozen=True)
class CornerTolerance:
    """How far from the sharp path the tool may be about a corner.

    Attributes:
        position: Distance [m].
        orientation: Angle [rad].
        lever: What a rotation of the target moves the box of freedom that turns with it [m].
        slight_only: Whether sharp corners stay exact.
        share: Which share of the tolerance of the request this is.
    """

    position: float
    orientation: float
    lever: float
    slight_only: bool = False
    share: float = ROUNDING

    @classmethod
    def of(cls, path: PathRequest, rounding: Rounding) -> CornerTolerance | None:
        """Return what a path allows; None: its corners are exact or have a blend."""
        if path.blend is not None or path.corners == "exact" or rounding == "none":
            return None
        tolerance, box = path.tolerance, path.tolerance.box
        lever = 0.0
        if box is not None and box.frame == "tool":
            lever = float(np.linalg.norm(box.position))
        share = SMOOTHING if rounding == "smooth" else ROUNDING
        return cls(
            share * tolerance.position,
            share * tolerance.orientation,
            lever,
            rounding == "slight",
            share,
        )

    def scaled(self, share: float) -> CornerTolerance:
        """Return the same within another share of the tolerance."""
        ratio = share / self.share
        return replace(
            self,
            position=ratio * self.position,
            orientation=ratio * self.orientation,
            share=share,
        )

    def ratio(self, distance: Array, angle: Array) -> float:
        """Return the largest ratio of what is off to what is allowed."""
        off = np.maximum((distance + self.lever * angle) / self.position, angle / self.orientation)
        return float(off.max())


def rounded_corners(
    items: Sequence[PathItem],
    junctions: Junctions,
    blends: Sequence[Blend | None],
    allowed: CornerTolerance,
    found: FoundCorners,
) -> list[Blend | None]:
    """Round the corners that ask for no radius of their own as far as the tolerance allows.

    A corner stays exact where the path turns back, where the tool turns on the spot, and where
    the orientation is free on one side only.

    Args:
        items: The items of the path.
        junctions: The junctions between them.
        blends: The corners that are rounded within radii asked for.
        allowed: How far from the sharp path the tool may be.
        found: Corners rounded before.
    """
    wanted = [bool(may) for may in may_round(items, junctions)]
    if allowed.slight_only:
        wanted = [may and not sharp for may, sharp in zip(wanted, junctions.sharp, strict=True)]
    rooms = _rooms(items, blends, wanted)
    return [
        _rounded(a.piece, b.piece, rooms[k], allowed, found) if wanted[k] else blends[k]
        for k, (a, b) in enumerate(pairwise(items))
    ]


def may_round(items: Sequence[PathItem], junctions: Junctions) -> Flags:
    """Return which junctions are corners that may be rounded within the tolerance, shape (n,)."""
    own = np.array([item.blend is not None for item in items[:-1]], dtype=bool)
    oriented = np.array([item.piece.oriented for item in items])
    alike = oriented[1:] == oriented[:-1]
    return np.asarray(junctions.jump & ~junctions.back & ~junctions.spot & ~own & alike)


def _rooms(
    items: Sequence[PathItem], blends: Sequence[Blend | None], wanted: Sequence[bool]
) -> list[float]:
    """How much of either side each corner may replace [m]."""
    rooms = [np.inf] * len(wanted)
    for k, item in enumerate(items):
        length = item.piece.length
        inside = [w.s for w in item.waypoints if 0.0 < w.s < length] + list(item.piece.folds)
        first, last = min(inside, default=length), length - max(inside, default=0.0)
        begin, end = k - 1, k
        taken_begin, taken_end = (
            0.0 if not 0 <= j < len(blends) or (blend := blends[j]) is None else blend.reach
            for j in (begin, end)
        )
        both = begin >= 0 and end < len(wanted) and wanted[begin] and wanted[end]
        share = _HALF * length if both else length
        if begin >= 0 and wanted[begin]:
            rooms[begin] = min(rooms[begin], first, share, length - taken_end)
        if end < len(wanted) and wanted[end]:
            rooms[end] = min(rooms[end], last, share, length - taken_begin)
    return rooms


def _rounded(
    before: Piece, after: Piece, room: float, allowed: CornerTolerance, found: FoundCorners
) -> Blend | None:
    """Round one corner; None: there is no room for it."""
    a = before.evaluate(np.array([before.length]))
    b = after.evaluate(np.zeros(1))
    bend = max(float(np.linalg.norm(b.v - a.v)), 1e-12)
    reach = min(room, allowed.position / (MIDDLE * bend))
    bounds = reach, allowed.position, allowed.orientation, allowed.lever
    return found.between(before, after, bounds, lambda: _shrunk(before, after, reach, allowed))


def _shrunk(before: Piece, after: Piece, reach: float, allowed: CornerTolerance) -> Blend | None:
    """Round one corner by a reach that shrinks until the curve is within the tolerance."""
    for _ in range(_TRIES):
        if reach < _LEAST:
            return None
        blend = blend_corner(before, after, reach)
        ratio = _off(before, after, blend, allowed)
        if ratio <= _ROUNDING:
            return blend
        reach *= max(min(_SHORTER, 0.98 / ratio), 0.05)
    return None


def _off(before: Piece, after: Piece, blend: Blend, allowed: CornerTolerance) -> float:
    """How far a rounded corner is from its sharp sides, as a ratio of what is allowed."""
    places = np.append(_PLACES * blend.piece.length, blend.nearest)
    curve = blend.piece.evaluate(places)
    first = places <= blend.nearest
    worst = 0.0
    for side, here, low, high in (
        (before, first, before.length - blend.reach, before.length),
        (after, ~first, 0.0, blend.reach),
    ):
        if here.any():  # a curve that is nearest to its corner at its end has no second side
            past = places[here]
            guess = low + past if side is before else high - blend.piece.length + past
            sharp = _nearest(side, curve, here, clamped(guess, low, high), low, high)
            worst = max(worst, _ratio(allowed, curve, here, sharp, blend.piece.oriented))
        if side is before:
            # The pose nearest to the corner is held to the corner itself: a waypoint may be there.
            at = side.evaluate(np.array([side.length]))
            nearest = np.zeros(len(places), dtype=bool)
            nearest[-1] = True
            worst = max(worst, _ratio(allowed, curve, nearest, at, blend.piece.oriented))
    return worst


def _nearest(
    side: Piece, curve: PathDerivatives, here: Flags, s: Array, low: float, high: float
) -> PathDerivatives:
    """The places of a side that are nearest to places of the curve: steps along the tangent."""
    sharp = side.evaluate(s)
    for _ in range(3):
        s = clamped(s + dot(curve.p[here] - sharp.p, sharp.v), low, high)
        sharp = side.evaluate(s)
    return sharp


def _ratio(
    allowed: CornerTolerance,
    curve: PathDerivatives,
    here: Flags,
    sharp: PathDerivatives,
    oriented: bool,
) -> float:
    distance = np.linalg.norm(curve.p[here] - sharp.p, axis=1)
    angle = np.zeros(len(distance))
    if oriented:
        angle = np.asarray(angle_between(curve.R[here], sharp.R), dtype=np.float64)
    return allowed.ratio(distance, angle)
