"""Where the tool is on its paths, sample by sample, and how far it is off them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ikplan.arrays import Array, Flags, Indices, clamped, lengths_of, steps_of
from ikplan.certificate.claim import Claim
from ikplan.certificate.matching import Samples, match_samples
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedMotion, RequestedPath, ToolLeg

__all__ = ["MatchedLeg", "TimedLeg", "Tool", "match_legs", "timed_legs"]


@dataclass(frozen=True, eq=False)
class Tool:
    """Poses of the tool in the base, by Pinocchio.

    Attributes:
        R: Rotations at the samples, shape (m, 3, 3).
        p: Positions at the samples, shape (m, 3) [m].
        R_waypoint: Rotations at the waypoints, shape (n, 3, 3).
        p_waypoint: Positions at the waypoints, shape (n, 3) [m].
    """

    R: Array
    p: Array
    R_waypoint: Array
    p_waypoint: Array

    @classmethod
    def of(cls, claim: Claim, samples: bool) -> Tool:
        """Return the poses of a claim; those at the samples only where they are asked for."""
        q = np.vstack([claim.q, claim.waypoint_q]) if samples else claim.waypoint_q
        R, p = claim.robot.poses(q)
        m = len(q) - len(claim.waypoint_q)
        return cls(R[:m], p[:m], R[m:], p[m:])


@dataclass(frozen=True, eq=False)
class TimedLeg:
    """A tool path and when the motion passes its waypoints.

    Attributes:
        path: The path.
        s: Path length of the begin and of each waypoint, shape (k,), k >= 2 [m].
        time: When each is passed, shape (k,) [s].
        row: Row of each waypoint, -1: the first sample, shape (k,).
        begin_ball: Length of its begin that need not be followed, within the ball about it [m].
        end_ball: The same of its end.
    """

    path: RequestedPath
    s: Array
    time: Array
    row: Indices
    begin_ball: float = 0.0
    end_ball: float = 0.0

    @property
    def followed(self) -> tuple[float, float]:
        """Path lengths between which the path itself is followed [m]."""
        return self.begin_ball, self.path.length - self.end_ball


@dataclass(frozen=True, eq=False)
class MatchedLeg:
    """Where the tool is on a path.

    Attributes:
        leg: The path and its times.
        sample: Indices of the samples on it, shape (j,).
        s: Path length of each, shape (j,) [m].
        oriented: Whether an orientation is asked for there, shape (j,).
        distance: How far each is outside what is allowed, shape (j,) [m].
        angle: The same of the orientation, shape (j,) [rad].
    """

    leg: TimedLeg
    sample: Indices
    s: Array
    oriented: Flags
    distance: Array
    angle: Array


def timed_legs(claim: Claim, motion: RequestedMotion) -> list[TimedLeg]:
    """Return the tool paths of a motion with the times that its trajectory claims."""
    return [_timed(claim, leg) for leg in motion.legs]


def _timed(claim: Claim, leg: ToolLeg) -> TimedLeg:
    begin = -1 if leg.begin_row is None else leg.begin_row
    s = np.array([0.0, *(s for s, _ in leg.path.waypoints)])
    row = np.array([begin, *(row for _, row in leg.path.waypoints)])
    time = np.where(row < 0, claim.time[0], claim.waypoint_time[row])
    return TimedLeg(leg.path, s, time, row, leg.begin_ball, leg.end_ball)


def match_legs(claim: Claim, legs: list[TimedLeg], tool: Tool) -> list[MatchedLeg]:
    """Find the tool on its paths, at every sample.

    Args:
        claim: The trajectory.
        legs: The paths and their times.
        tool: Poses of the tool.
    """
    if claim.path is None:
        return []
    allowance = Allowance(claim.path)
    matched = []
    for leg in legs:
        sample = np.flatnonzero((claim.time >= leg.time[0]) & (claim.time <= leg.time[-1]))
        if len(sample) == 0:
            continue
        balls = _in_balls(leg, tool.p[sample], allowance.position)
        on = np.isnan(balls.s)
        s, distance = balls.s, balls.distance
        oriented, angle = np.zeros(len(s), dtype=np.bool_), np.zeros(len(s))
        if not on.any():  # what is to be followed is left out as a whole
            distance[:] = max(leg.followed[1] - leg.followed[0], 0.0)
            matched.append(MatchedLeg(leg, sample, s, oriented, distance, angle))
            continue
        samples = _samples(leg, tool, claim.time[sample[on]], sample[on], allowance)
        match = match_samples(leg.path, allowance, samples)
        s[on], distance[on] = match.s, match.distance
        oriented[on], angle[on] = match.oriented, match.angle
        matched.append(MatchedLeg(leg, sample, s, oriented, distance, angle))
    return matched


class _Balls(NamedTuple):
    """The samples where a joint motion goes over into a path: those in the ball next to its end.

    Attributes:
        s: About where they are, nan of all others, shape (m,) [m].
        distance: How far they are outside of the ball, shape (m,) [m].
    """

    s: Array
    distance: Array


def _in_balls(leg: TimedLeg, p: Array, tolerance: float) -> _Balls:
    """Return which samples, shape (m, 3), are in the balls at both ends of a path."""
    found = _Balls(np.full(len(p), np.nan), np.zeros(len(p)))
    length = leg.path.length
    for place, radius, order in (
        (0.0, leg.begin_ball, np.arange(len(p))),
        (length, leg.end_ball, np.arange(len(p))[::-1]),
    ):
        if radius == 0.0:
            continue
        piece = leg.path.piece_at(np.array([place]))
        corner = leg.path.derivatives(piece, place - leg.path.begins[piece]).p
        away = lengths_of(p[order] - corner)
        out = np.flatnonzero(away > radius + tolerance)
        run = order[: out[0] if len(out) else len(order)]
        found.s[run] = abs(place - radius)
        found.distance[run] = np.maximum(away[: len(run)] - radius, 0.0)
    return found


def _samples(
    leg: TimedLeg, tool: Tool, time: Array, sample: Indices, allowance: Allowance
) -> Samples:
    """The samples with the path lengths at which they are expected.

    Between two waypoints the share of the way that is behind the tool is about the share of the
    path's own: of its length, on a turn on the spot of its angle, and on a path that turns faster
    than it moves, of both by their tolerances.
    """
    p, R = tool.p[sample], tool.R[sample]
    first = leg.row < 0
    p_passed = np.where(first[:, None], tool.p[:1], tool.p_waypoint[leg.row])
    R_passed = np.where(first[:, None, None], tool.R[:1], tool.R_waypoint[leg.row])
    step = clamped(np.searchsorted(leg.time, time, "right") - 1, 0, len(leg.s) - 2)
    # Waypoints and samples in the order in which they are passed, each waypoint before its samples.
    order = np.argsort(np.concatenate([leg.time, time]), kind="stable")
    nodes, progress = turning_progress(leg.path, allowance)
    way = _lengths(np.concatenate([p_passed, p])[order])
    if len(nodes) or leg.path.spots.any():
        turned = _angles(np.concatenate([R_passed, R])[order], allowance.free_axis)
        within = np.concatenate([np.arange(len(leg.s)) - 1, step])[order][1:]
        within = clamped(within, 0, len(leg.s) - 2)
        piece = leg.path.piece_at(0.5 * (leg.s[:-1] + leg.s[1:]))[within]
        if len(nodes):
            counts = np.where(leg.path.oriented[piece], turned, 0.0)
            way = way / allowance.position + counts / allowance.orientation
        else:
            way = np.where(leg.path.spots[piece], turned, way)
    gone = np.empty(len(order))
    gone[order] = np.concatenate([[0.0], np.cumsum(way)])
    at_waypoint, at_sample = gone[: len(leg.s)], gone[len(leg.s) :]
    whole = steps_of(at_waypoint)[step]
    share = (at_sample - at_waypoint[step]) / np.where(whole > 0.0, whole, 1.0)
    share = clamped(share, 0.0, 1.0)
    low, high = leg.s[step], leg.s[step + 1]
    if len(nodes):
        a, b = np.interp(low, nodes, progress), np.interp(high, nodes, progress)
        hint = clamped(np.interp(a + share * (b - a), progress, nodes), low, high)
    else:
        hint = low + share * (high - low)
    return Samples(p, R, hint, low, high)


def turning_progress(path: RequestedPath, allowance: Allowance) -> tuple[Array, Array]:
    """Return path lengths and how far a path has got there, moved and turned, in tolerances.

    Returns:
        Path lengths, shape (k,) [m], and the shares of the tolerances moved and turned through up
        to each, shape (k,); both empty where no curve turns faster than it moves.
    """
    if allowance.positions_only or not path.curved_and_oriented.any():
        return np.zeros(0), np.zeros(0)
    nodes = path.nodes
    piece = path.piece_at(0.5 * (nodes[1:] + nodes[:-1]))
    begin, step = path.begins[piece], steps_of(nodes)
    here, there = (
        path.derivatives(piece, nodes[:-1] - begin),
        path.derivatives(piece, nodes[1:] - begin),
    )
    stacked = np.stack([here.R, there.R], axis=1).reshape(-1, 3, 3)
    curve = _angles(stacked, allowance.free_axis)[::2]
    rate = here.w
    if allowance.free_axis is not None:
        rate = np.cross(rate, here.R[:, :, allowance.free_axis])
    even = np.sqrt((rate * rate).sum(axis=1)) * step
    turned = np.where(path.curved_and_oriented[piece], curve, even)
    turned = np.where(path.oriented[piece], turned, 0.0) / allowance.orientation
    moved = np.where(path.spots[piece], 0.0, step) / allowance.position
    if not (turned > moved)[path.curved_and_oriented[piece]].any():
        return np.zeros(0), np.zeros(0)
    return nodes, np.concatenate([[0.0], np.cumsum(moved + turned)])


def _lengths(p: Array) -> Array:
    steps = steps_of(p)
    return np.asarray(np.sqrt((steps * steps).sum(axis=1)))


def _angles(R: Array, free_axis: int | None) -> Array:
    """Angles between neighbouring rotations, or between their axes that may be turned about."""
    if free_axis is not None:
        steps = steps_of(R[:, :, free_axis])
        return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * lengths_of(steps), 1.0)))
    chords = np.sqrt(((R[1:] - R[:-1]) ** 2).sum(axis=(1, 2)) / 8.0)
    return np.asarray(2.0 * np.arcsin(np.minimum(chords, 1.0)))
