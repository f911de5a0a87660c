"""Rounds the corners of a way so that the motion need not stop there, and proves what comes out.

At a corner c, which it reaches in the direction u and leaves in v, a way becomes
``c + h (u (x - r(x)) + v r(x))``, x from -1 to 1, with ``3/4 (1 - x^2)`` the second derivative of
r: it leaves both straight parts in their direction and without curvature. The joint path is a
spline through places on it; what is proven to be free is that spline itself. Where it is not, its
corners are cut less, and in the end the motion stops there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.planning.moves.piece_check import PieceCheck

__all__ = ["RoundedWay", "round_way"]

_PLACES = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
_RAMP = 0.75 * (_PLACES**2 / 2.0 - _PLACES**4 / 12.0) + _PLACES / 2.0 + 3.0 / 16.0
"""r at the places."""
_LONGEST = 0.5
"""What share of the shorter part beside it a corner may take."""
_SHORTEST = 0.5**7
"""Share of that below which the motion stops at the corner instead."""
_SAME = 1e-9
"""Distance at which two places are one [rad or m]."""


@dataclass(frozen=True, eq=False)
class RoundedWay:
    """Configurations that a joint path passes.

    Attributes:
        q: Configurations, shape (k, dof) [rad or m].
        rest: Indices of those between the ends where the motion stops.
    """

    q: Array
    rest: list[int]

    @property
    def length(self) -> float:
        """Joint distance along its chords [rad or m]."""
        return float(np.linalg.norm(np.diff(self.q, axis=0), axis=1).sum())


def round_way(
    way: Array,
    limits: JointLimits,
    check: PieceCheck | None,
    extra: float = 0.0,
) -> RoundedWay:
    """Return a way with its corners rounded as far as it can be proven to be free.

    Args:
        way: Configurations, straight motions between which are free, shape (k, dof) [rad or m].
        limits: Position limits.
        check: Tells which pieces are not proven; None: nothing is in the way.
        extra: Gap asked for on top of that of the check [m].
    """
    steps = np.linalg.norm(np.diff(way, axis=0), axis=1)
    most = _LONGEST * np.minimum(steps[:-1], steps[1:])
    cuts = most.copy()
    while True:
        q, owner = _places(way, cuts)
        rest = [int(np.flatnonzero(owner == k)[0]) for k in np.flatnonzero(cuts == 0.0) + 1]
        rounded = RoundedWay(q, rest)
        if check is None or not cuts.any():
            return rounded
        path = JointPath.through(q, limits, rest_at=rest)
        slopes = (path.tangents_start, path.tangents_end)
        found = check(path.s_knots, path.q_knots, slopes, extra)
        if not found.any():
            return rounded
        # The corners nearest to the pieces in contact; beside a stop, the next ones.
        pieces = np.flatnonzero(found)
        blamed = np.unique(np.concatenate([owner[pieces], owner[pieces + 1]]))
        blamed = blamed[(blamed > 0) & (blamed < len(way) - 1)] - 1
        blamed = blamed[cuts[blamed] > 0.0]
        if len(blamed) == 0:
            blamed = np.flatnonzero(cuts)
        cuts[blamed] *= 0.5
        cuts[cuts < _SHORTEST * most] = 0.0


def _places(way: Array, cuts: Array) -> tuple[Array, Indices]:
    """Places on a rounded way, shape (m, dof), and the configuration of the way each is at."""
    rows, owner = [way[:1]], [np.zeros(1, dtype=np.int64)]
    for k, h in enumerate(cuts, start=1):
        corner = way[k]
        if h == 0.0:
            places = corner[None]
        else:
            u, v = corner - way[k - 1], way[k + 1] - corner
            u, v = u / np.linalg.norm(u), v / np.linalg.norm(v)
            places = corner + h * (np.outer(_PLACES - _RAMP, u) + np.outer(_RAMP, v))
        if np.linalg.norm(places[0] - rows[-1][-1]) <= _SAME:
            places = places[1:]
        rows.append(places)
        owner.append(np.full(len(places), k, dtype=np.int64))
    rows.append(way[-1:])
    owner.append(np.array([len(way) - 1], dtype=np.int64))
    return np.concatenate(rows), np.concatenate(owner)
