"""The smooth curve past the points of a run of lines, within a tolerance of the lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Indices, lengths_of
from ikplan.path.build.items import PathItem
from ikplan.path.build.tolerance_corners import CornerTolerance
from ikplan.path.pieces.steady import SteadyPiece
from ikplan.path.rotation.so3 import quaternion_of
from ikplan.smoothing import Clusters, clusters_of, fit_within

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = ["RunCurve", "RunPoints", "curve_past", "points_of"]


_BULGE = 0.1
"""Of a line whose middle is farther than this share of what is allowed from the arc over it, the
quarters are points too."""
_ANGLE = 0.5
"""Distance of unit quaternions, as a share of the angle between them."""
_WITHIN = 1.0 - 1e-9
"""Share of what is allowed that the curve takes: the rest is for rounding errors."""
_BETWEEN = (0.25, 0.5, 0.75)
_TIGHTER = 0.9
_TRIES = 4
"""How often the curve is held nearer to the points where it leaves the lines between them."""
_FEWEST = 3
"""Fewest points, after those as good as one are taken as one, that a curve is laid past."""


@dataclass(frozen=True, eq=False)
class RunPoints:
    """Points of a run: the ends of its lines, and where lines are long, points between.

    Attributes:
        p: Positions, shape (n, 3) [m].
        q: Unit quaternions, each on the side of the one before, shape (n, 4).
        ends: Index of the point at the begin and at the end of each line, shape (lines + 1,).
    """

    p: Array
    q: Array
    ends: Indices


def points_of(run: Sequence[PathItem], allowed: CornerTolerance) -> RunPoints:
    """Return the points of a run of lines.

    Args:
        run: The lines, joined end to end.
        allowed: How far from them the tool may be: it says which lines are long.
    """
    p, q, ends = [], [], [0]
    before = None
    for item in run:
        piece = item.piece
        assert isinstance(piece, SteadyPiece)
        bend = 0.0 if before is None else float(np.linalg.norm(piece.t - before.t))
        shares = [0.0]
        if piece.length * bend / 8.0 > _BULGE * allowed.position or before is None:
            shares = [0.0, 0.25, 0.5, 0.75]
        here = piece.evaluate(np.array(shares) * piece.length)
        p += list(here.p)
        q += list(quaternion_of(here.R))
        ends.append(len(p))
        before = piece
    last = run[-1].piece.evaluate(np.array([run[-1].piece.length]))
    p.append(last.p[0])
    q.append(quaternion_of(last.R)[0])
    quaternions = np.array(q)
    dots = (quaternions[1:] * quaternions[:-1]).sum(axis=1)
    quaternions[1:] *= np.cumprod(np.where(dots < 0.0, -1.0, 1.0))[:, None]
    return RunPoints(np.array(p), quaternions, np.array(ends))


@dataclass(frozen=True, eq=False)
class RunCurve:
    """A smooth curve past points.

    Attributes:
        spline: Position, and where the orientation changes a quaternion, by a parameter.
        turns: Whether the orientation changes.
        clusters: The points, those as good as one taken as one.
    """

    spline: BSpline
    turns: bool
    clusters: Clusters

    @property
    def effort(self) -> float:
        """What the curve takes of the time of a motion, but for a factor.

        Where accelerations limit it, the tool passes a place at a speed of about one by the root
        of the curvature: the integral of that root. Curves past the same points compare.
        """
        at = np.linspace(self.clusters.u[0], self.clusters.u[-1], 4 * len(self.spline.t))
        bending = lengths_of(self.spline(at, 2))
        return float(np.sqrt(bending).mean() * (at[-1] - at[0]))


def curve_past(points: RunPoints, allowed: CornerTolerance, *, oriented: bool) -> RunCurve | None:
    """Return a smooth curve past points; None: none was found within the tolerance.

    Args:
        points: The points.
        allowed: How far from the lines between them the tool may be.
        oriented: Whether the orientation counts.
    """
    turns = oriented and bool(np.abs(np.diff(points.q, axis=0)).max() > 1e-12)
    rows, together, half = points.p, [3], np.full(3, allowed.position)
    if turns:
        angle = min(allowed.orientation, allowed.position / max(allowed.lever, 1e-12))
        rows, together = np.hstack([points.p, points.q]), [3, 4]
        half = np.append(half, np.full(4, _ANGLE * angle))
        half *= 0.5 if allowed.lever else 1.0
    share = _WITHIN
    for _ in range(_TRIES):
        clusters = clusters_of(rows, share * half, together)
        if len(clusters.u) < _FEWEST:
            return None
        spline = fit_within(clusters.u, clusters.middle, clusters.half_width, together)
        found = RunCurve(spline, turns, clusters)
        if _off(found, points, allowed) <= 1.0:
            return found
        share *= _TIGHTER
    return None


def _off(curve: RunCurve, points: RunPoints, allowed: CornerTolerance) -> float:
    """How far a curve is from its lines, as a ratio of what is allowed."""
    spline, turns = curve.spline, curve.turns
    u, of_point = curve.clusters.u, curve.clusters.of_point
    starts = np.flatnonzero(np.append(True, np.diff(of_point) > 0))
    lasts = np.append(starts[1:], len(of_point)) - 1
    a, b = points.p[lasts[:-1]], points.p[starts[1:]]
    along = b - a
    square = np.maximum((along * along).sum(axis=1), 1e-300)
    worst = 0.0
    checks = [(u[:-1] + share * np.diff(u), lasts[:-1], starts[1:]) for share in _BETWEEN]
    for at, before, after in checks:
        y = spline(at)
        share = np.clip(((y[:, :3] - a) * along).sum(axis=1) / square, 0.0, 1.0)[:, None]
        distance = lengths_of(y[:, :3] - a - share * along)
        angle = np.zeros(len(at))
        if turns:
            q = points.q[before] + share * (points.q[after] - points.q[before])
            angle = _angle(y[:, 3:], q)
        worst = max(worst, allowed.ratio(distance, angle))
    y = spline(u[of_point])
    distance = lengths_of(y[:, :3] - points.p)
    angle = _angle(y[:, 3:], points.q) if turns else np.zeros(len(distance))
    return max(worst, allowed.ratio(distance, angle))


def _angle(a: Array, b: Array) -> Array:
    """Angles between the rotations of quaternions of about unit length, shape (m,) [rad]."""
    a = a / lengths_of(a)[:, None]
    b = b / lengths_of(b)[:, None]
    chord = np.minimum(lengths_of(a - b), lengths_of(a + b))
    return np.asarray(4.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))
