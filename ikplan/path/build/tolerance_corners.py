"""Corners rounded within a share of the tolerance, so that they are passed without a stop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.documents.path import PathRequest
from ikplan.path.build.corners import Junctions
from ikplan.path.build.found_corners import FoundCorners
from ikplan.path.build.items import PathItem
from ikplan.path.build.sharp_corners import SharpCorners
from ikplan.path.pieces.blend import Blend, blend_corner
from ikplan.path.tolerance_shares import ROUNDING, SMOOTHING, Rounding

__all__ = ["MIDDLE", "CornerTolerance", "may_round", "rounded_corners"]


MIDDLE = 3.0 / 16.0
"""A quintic between lines passes its corner at this share of ``reach |b - a|``."""
_SHORTER = 0.7
_ROUNDING = 1.0 + 1e-6
_TRIES = 12
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
        return float(self.ratios(distance, angle).max())

    def ratios(self, distance: Array, angle: Array) -> Array:
        """Return the ratios of what is off to what is allowed, shape (n,)."""
        return np.asarray(
            np.maximum((distance + self.lever * angle) / self.position, angle / self.orientation)
        )


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
    if not any(wanted):
        return list(blends)
    rooms = _rooms(items, blends, wanted)
    corners = SharpCorners.of([item.piece for item in items], wanted)
    reaches = np.minimum(
        np.array([room for room, may in zip(rooms, wanted, strict=True) if may]),
        allowed.position / (MIDDLE * np.maximum(corners.bends, 1e-12)),
    )
    bounds = allowed.position, allowed.orientation, allowed.lever
    asked = [(*corners.sides(k), (float(reach), *bounds)) for k, reach in enumerate(reaches)]
    rounded = found.of(asked, lambda new: _shrunk(corners, new, reaches, allowed))
    blends = list(blends)
    for row, blend in zip(corners.rows, rounded, strict=True):
        blends[row] = blend
    return blends


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


def _shrunk(
    corners: SharpCorners, rows: Sequence[int], reaches: Array, allowed: CornerTolerance
) -> list[Blend | None]:
    """Round some corners by reaches that shrink until their curves are within the tolerance."""
    found: dict[int, Blend] = {}
    reach = {k: float(reaches[k]) for k in rows}
    for _ in range(_TRIES):
        left = [k for k in rows if k not in found and reach[k] >= _LEAST]
        if not left:
            break
        tried = [blend_corner(*corners.sides(k), reach[k]) for k in left]
        ratios = corners.ratios_off(left, tried, allowed.ratios)
        for k, blend, ratio in zip(left, tried, ratios.tolist(), strict=True):
            if ratio <= _ROUNDING:
                found[k] = blend
            else:
                reach[k] *= max(min(_SHORTER, 0.98 / ratio), 0.05)
    return [found.get(k) for k in rows]
