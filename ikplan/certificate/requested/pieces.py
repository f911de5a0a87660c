"""The smooth pieces that a requested tool path is made of, over their own length s."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, length_of
from ikplan.certificate.requested.arc_length import ArcLength
from ikplan.certificate.requested.rotations import exp
from ikplan.certificate.requested.turning import EvenTurn, HeadingTurn, Turning

__all__ = ["TURN_LENGTH", "BendPiece", "CurvePiece", "End", "Piece", "helix", "line"]


TURN_LENGTH = 0.3
"""Length that a radian of a turn on the spot counts for [m/rad]; only to tell places apart."""
_ON_THE_SPOT = 1e-6
"""A move shorter than this [m] that turns by more than it moves is a turn on the spot."""


@dataclass(frozen=True, eq=False)
class End:
    """What a piece does at one place.

    Attributes:
        p: Position in the base, shape (3,) [m].
        v: dp/ds, shape (3,).
        bend: d2p/ds2, shape (3,) [1/m].
        R: Rotation, shape (3, 3); None: free.
        w: Angular rate in the base, shape (3,) [rad/m].
    """

    p: Array
    v: Array
    bend: Array
    R: Array | None
    w: Array


@dataclass(frozen=True, eq=False)
class BendPiece:
    """A line, arc, helix or turn on the spot: constant curvature, climb and angular rate.

    The chord of an arc of length s and curvature k has the length ``s sinc(k s / 2)`` and the
    direction of the arc's middle, which holds for lines (k = 0) too::

        p(s) = p0 + h s sinc(k s / 2) (t cos(k s / 2) + n sin(k s / 2)) + c s
        R(s) = R0 exp(s w)

    Attributes:
        p0: First point, shape (3,) [m].
        t: Unit direction at it, across the climb, shape (3,).
        n: Unit direction to the centre, shape (3,).
        c: Climb, shape (3,).
        h: Share of the length that is across the climb.
        k: Curvature of the projection by s [rad/m].
        length: Length [m]; of a turn on the spot, its angle times TURN_LENGTH.
        R0: Rotation at the begin, shape (3, 3); None: free.
        w: Angular rate in the frame of the tool, shape (3,) [rad/m].
        spot: Whether it is a turn on the spot.
    """

    p0: Array
    t: Array
    n: Array
    c: Array
    h: float
    k: float
    length: float
    R0: Array | None
    w: Array
    spot: bool = False

    @property
    def oriented(self) -> bool:
        """Whether an orientation is asked for."""
        return self.R0 is not None

    def end(self, s: float) -> End:
        """Return what the piece does at length s [m]."""
        half, whole = 0.5 * self.k * s, self.k * s
        chord = self.h * s * float(np.sinc(half / math.pi))
        p = self.p0 + chord * (math.cos(half) * self.t + math.sin(half) * self.n) + s * self.c
        ahead = math.cos(whole) * self.t + math.sin(whole) * self.n
        aside = math.cos(whole) * self.n - math.sin(whole) * self.t
        R = None if self.R0 is None else self.R0 @ exp(s * self.w[None])[0]
        w = np.zeros(3) if R is None else R @ self.w
        return End(p, self.h * ahead + self.c, self.h * self.k * aside, R, w)

    def part(self, begin: float, end: float) -> BendPiece:
        """Return the part between two lengths [m]."""
        at, turned = self.end(begin), self.k * begin
        t = math.cos(turned) * self.t + math.sin(turned) * self.n
        n = math.cos(turned) * self.n - math.sin(turned) * self.t
        return replace(self, p0=at.p, t=t, n=n, length=end - begin, R0=at.R)

    def turning(self, R0: Array, rate: Array) -> BendPiece:
        """Return the piece turning evenly from R0 at a rate in the tool's frame [rad/m]."""
        return replace(self, R0=R0, w=rate)

    def following(self, R0: Array, axis: Array) -> BendPiece:
        """Return the piece turning about a unit axis as its direction does."""
        about = math.copysign(1.0, float(axis @ np.cross(self.t, self.n))) * self.k
        return replace(self, R0=R0, w=about * (R0.T @ axis))


@dataclass(frozen=True, eq=False)
class CurvePiece:
    """A part of a curve that has no closed arc length.

    Attributes:
        arc: The whole curve.
        begin: Arc length at which the piece begins [m].
        length: Length [m].
        law: How the tool turns, by the arc length of the whole curve; None: free.
    """

    arc: ArcLength
    begin: float
    length: float
    law: Turning | None = None
    spot: bool = False

    @property
    def oriented(self) -> bool:
        """Whether an orientation is asked for."""
        return self.law is not None

    def derivatives(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Return the piece at lengths s, shape (m,) [m].

        Returns:
            Rotations (m, 3, 3), positions (m, 3) [m], dp/ds (m, 3) and angular rates in the base
            (m, 3) [rad/m]; unturned where the orientation is free.
        """
        along = self.begin + s
        t = self.arc.parameter(along)
        p, first, _ = self.arc.curve.derivatives(t)
        speed = np.sqrt((first * first).sum(axis=1))
        v = first / np.where(speed > 0.0, speed, 1.0)[:, None]
        if self.law is None:
            return np.tile(np.eye(3), (len(s), 1, 1)), p, v, np.zeros_like(p)
        R, w = self.law.turned(along, t)
        return R, p, v, w

    @property
    def nodes(self) -> Array:
        """Lengths between which the curve is smooth and alike, shape (k,) [m]."""
        inside = self.arc.s - self.begin
        return inside[(inside > 0.0) & (inside < self.length)]

    def end(self, s: float) -> End:
        """Return what the piece does at length s [m]."""
        R, p, v, w = (found[0] for found in self.derivatives(np.array([s])))
        t = self.arc.parameter(np.array([self.begin + s]))
        _, first, second = (d[0] for d in self.arc.curve.derivatives(t))
        bend = (second - float(v @ second) * v) / float(first @ first)
        return End(p, v, bend, None if self.law is None else R, w)

    def part(self, begin: float, end: float) -> CurvePiece:
        """Return the part between two lengths [m]."""
        return replace(self, begin=self.begin + begin, length=end - begin)

    def turning(self, R0: Array, rate: Array) -> CurvePiece:
        """Return the piece turning evenly from R0 at a rate in the tool's frame [rad/m]."""
        return replace(self, law=EvenTurn(self.begin, R0, rate))

    def following(self, R0: Array, axis: Array) -> CurvePiece:
        """Return the piece turning about a unit axis as its direction does."""
        t0 = float(self.arc.parameter(np.array([self.begin]))[0])
        return replace(self, law=HeadingTurn(self.arc, t0, R0, axis))


Piece = BendPiece | CurvePiece


def line(p0: Array, p1: Array, R0: Array | None = None, turn: Array | None = None) -> BendPiece:
    """Return a straight line, or the turn on the spot where both ends are one place.

    Args:
        p0: First point, shape (3,) [m].
        p1: Last point, shape (3,) [m].
        R0: Rotation at the begin, shape (3, 3); None: free.
        turn: Turn over the whole line in the frame of the tool, shape (3,) [rad]; None: none.
    """
    step, zero = p1 - p0, np.zeros(3)
    turn = zero if turn is None else turn
    distance = length_of(step)
    turned = TURN_LENGTH * length_of(turn)
    spot = distance <= _ON_THE_SPOT and turned > distance
    length = turned if spot else distance
    scale = 1.0 / length if length > 0.0 else 0.0
    return BendPiece(p0, step * scale, zero, zero, 1.0, 0.0, length, R0, turn * scale, spot)


def helix(p0: Array, spoke: Array, axis: Array, angle: float, rise: float) -> BendPiece:
    """Return the helix that turns about an axis; an arc where nothing rises.

    Args:
        p0: First point, shape (3,) [m].
        spoke: From the axis to p0, at right angles to the axis, shape (3,) [m].
        axis: Unit direction of the axis, shape (3,).
        angle: Angle turned, signed [rad].
        rise: Way along the axis [m].
    """
    radius = float(np.linalg.norm(spoke))
    around = radius * abs(angle)
    length = math.hypot(around, rise)
    inward = -spoke / radius
    t = math.copysign(1.0, angle) * np.cross(inward, axis)
    c = (rise / length) * axis
    return BendPiece(
        p0, t, inward, c, around / length, abs(angle) / length, length, None, np.zeros(3)
    )
