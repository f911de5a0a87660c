"""Distances between the bodies of a model at single configurations, by coal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from ikplan.scene.body import Body
from ikplan.scene.coal_pieces import CoalPiece, coal_pieces_of

__all__ = ["Contacts", "Nearest"]

Array = NDArray[np.float64]

COAL_TOLERANCE = 5e-6
"""By how much a distance of coal may be too large [m]; 2e-6 were seen in 86,138 queries."""


class Nearest(NamedTuple):
    """The nearest pair of bodies.

    Attributes:
        distance: Their distance [m]; negative: how deep they overlap.
        pair: Index of the pair.
        points: The nearest points on both, in the base frame, shape (2, 3) [m].
    """

    distance: float
    pair: int
    points: Array


class Contacts:
    """Bodies as shapes of coal, for many configurations. Not for several threads at once."""

    def __init__(self, bodies: Sequence[Body], pairs: NDArray[np.int64]) -> None:
        """Make the shapes.

        Args:
            bodies: The bodies.
            pairs: Indices of two bodies each, shape (n, 2).
        """
        self.pairs = pairs
        self._carrier = np.array([body.carrier for body in bodies], dtype=np.int64)
        self._pieces = [coal_pieces_of(body) for body in bodies]
        balls = [_ball(pieces) for pieces in self._pieces]
        self._centre = np.array([ball[0] for ball in balls]).reshape(-1, 3)
        self._radius = np.array([ball[1] for ball in balls])
        self._request = coal.DistanceRequest()
        self._request.enable_signed_distance = True
        self._result = coal.DistanceResult()

    def nearest(self, R: Array, p: Array) -> Nearest | None:
        """Return the nearest pair, None where there is no pair.

        Args:
            R: Rotations of the carriers in the base frame, shape (n, 3, 3).
            p: Their positions, shape (n, 3) [m].
        """
        gaps = self._gaps(R, p)
        best: Nearest | None = None
        for k in np.argsort(gaps, kind="stable"):
            if best is not None and gaps[k] >= best.distance:
                break
            distance, points = self._distance(int(k), R, p)
            if best is None or distance < best.distance:
                best = Nearest(distance, int(k), points)
        return best

    def touching(self, R: Array, p: Array, among: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Say which of some pairs touch or are too near to be told from it.

        Args:
            R: Rotations of the carriers in the base frame, shape (n, 3, 3).
            p: Their positions, shape (n, 3) [m].
            among: Indices of pairs.
        """
        gaps = self._gaps(R, p)
        found = [
            gaps[k] <= 0.0 and self._distance(int(k), R, p)[0] <= COAL_TOLERANCE for k in among
        ]
        return np.array(found, dtype=np.bool_)

    def _gaps(self, R: Array, p: Array) -> Array:
        """Distances of the balls around the bodies of each pair: lower bounds [m]."""
        centres = np.einsum("nij,nj->ni", R[self._carrier], self._centre) + p[self._carrier]
        a, b = self.pairs[:, 0], self.pairs[:, 1]
        apart = np.linalg.norm(centres[a] - centres[b], axis=1)
        gaps: Array = apart - self._radius[a] - self._radius[b]
        return gaps

    def _distance(self, pair: int, R: Array, p: Array) -> tuple[float, Array]:
        """Distance of the bodies of a pair and their nearest points."""
        a, b = (int(index) for index in self.pairs[pair])
        poses = [coal.Transform3s(R[self._carrier[i]], p[self._carrier[i]]) for i in (a, b)]
        least, points = np.inf, np.zeros((2, 3))
        for one in self._pieces[a]:
            T_one = poses[0] * one.pose
            for other in self._pieces[b]:
                self._result.clear()
                distance = coal.distance(
                    one.shape,
                    T_one,
                    other.shape,
                    poses[1] * other.pose,
                    self._request,
                    self._result,
                )
                if distance < least:
                    least = float(distance)
                    ends = (self._result.getNearestPoint1(), self._result.getNearestPoint2())
                    points = np.array(ends)
        return least, points


def _ball(pieces: Sequence[CoalPiece]) -> tuple[Array, float]:
    """A ball around the balls of the pieces of a body."""
    low = np.min([x.centre - x.radius for x in pieces], axis=0)
    high = np.max([x.centre + x.radius for x in pieces], axis=0)
    centre = 0.5 * (low + high)
    return centre, max(float(np.linalg.norm(x.centre - centre)) + x.radius for x in pieces)
