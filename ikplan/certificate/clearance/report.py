"""From findings of a search to the document of a certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.clearance.curve import JointCurve
from ikplan.certificate.clearance.search import GROUPS, Findings
from ikplan.certificate.clearance.shapes import PieceArrays, PiecePairs
from ikplan.certificate.clearance.windows import Window
from ikplan.documents.clearance import (
    AllowedPair,
    BodySource,
    Clearance,
    NearestPlace,
    SegmentClearance,
)
from ikplan.scene.body import CollisionModel

__all__ = ["Report"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(eq=False)
class Report:
    """Collects the findings of windows.

    Attributes:
        model: The bodies.
        pieces: Their pieces.
        pairs: Their pairs of pieces.
        obstacle: Whether one of them is an obstacle, for each pair of bodies, shape (n,).
        curve: The motion.
        tolerance: Tolerance of the search [m].
    """

    model: CollisionModel
    pieces: PieceArrays
    pairs: PiecePairs
    obstacle: NDArray[np.bool_]
    curve: JointCurve
    tolerance: float
    _segments: list[SegmentClearance] = field(default_factory=list)
    _checked: set[int] = field(default_factory=set)

    def add(self, window: Window, out: Findings, rows: Ints) -> None:
        """Add what was found in a window.

        Args:
            window: The window.
            out: Its findings.
            rows: Rows of the model's pairs that were looked at.
        """
        self._checked |= set(rows.tolist())
        if window.own is not None:
            place = self._place(out, range(GROUPS), len(rows))
            self._segments.append(SegmentClearance(**place, begin=window.begin, end=window.end))

    def document(self, whole: Findings) -> Clearance:
        """Return the document of the whole motion."""
        checked = len(self._checked)
        scene = int(self.obstacle[sorted(self._checked)].sum())
        return Clearance(
            **self._place(whole, range(GROUPS), checked),
            clearance=self.model.clearance,
            interpolation=self.curve.interpolation,
            self_=NearestPlace(**self._place(whole, [0], checked - scene)),
            scene=NearestPlace(**self._place(whole, [1], scene)),
            segments=self._segments,
            allowed=[AllowedPair(pair=[a, b], reason=why) for a, b, why in self.model.allowed],
            sources=[
                BodySource(body=body.name, source=body.source, excess=body.excess)
                for body in self.model.bodies
                if body.source
            ],
            unchecked=list(self.model.unchecked),
        )

    def _place(self, out: Findings, groups: Any, checked: int) -> dict[str, Any]:
        """Fields of the nearest place of some groups."""
        present = [g for g in groups if out.pair[g] >= 0]
        fields: dict[str, Any] = {
            "proven": True, "least": None, "found": None, "time": None, "pair": None,
            "points": None, "tolerance": self.tolerance, "pairs_checked": checked,
        }  # fmt: skip
        if not present:
            return fields
        g = min(present, key=lambda group: float(out.found[group]))
        found = max(float(out.found[g]), 0.0)
        least = min(max(float(out.least[group]), 0.0) for group in present)
        least = min(least, found)
        undecided = any(out.undecided[group] > 0 for group in present)
        asked = self.model.clearance
        enough = least > 0.0 and least >= asked
        k = int(out.pair[g])
        pieces = int(self.pairs.first[k]), int(self.pairs.second[k])
        return fields | {
            "proven": bool(enough and not undecided),
            "least": least,
            "found": found,
            "time": self.curve.time(float(out.at[g])),
            "pair": [self.model.bodies[int(self.pieces.body[i])].name for i in pieces],
            "points": _surface_points(out.points[g], tuple(self.pieces.radius[[*pieces]].tolist())),
            "undecided": undecided,
        }


def _surface_points(points: Array, radii: tuple[float, float]) -> list[list[float]]:
    """Move the points of two hulls along their line onto the surfaces at the radii around them.

    Radii that overlap by more than the distance of the hulls meet in between.
    """
    first, second = points.tolist()
    line = [b - a for a, b in zip(first, second, strict=True)]
    length = math.hypot(*line)
    if length == 0.0:
        return [first, second]
    whole = radii[0] + radii[1]
    share = min(1.0, length / whole) if whole > 0.0 else 1.0
    ahead, back = (share * radius / length for radius in radii)
    return [
        [a + ahead * x for a, x in zip(first, line, strict=True)],
        [b - back * x for b, x in zip(second, line, strict=True)],
    ]
