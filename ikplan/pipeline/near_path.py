"""A smooth joint path within a tolerance of the polyline through joint waypoints."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.documents.poses import Tolerance
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.pipeline.polyline import Polyline, tool_apart
from ikplan.robots import Robot
from ikplan.smoothing import clusters_of, fit_within

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

__all__ = ["NearPath", "Nearness", "smooth_path"]


_SHARE = 0.9
"""Share of the tolerance that the fit may take; the joint spline through its points the rest."""
_TIGHTER = 0.7
_TRIES = 10
_BULGE = 0.3
"""A leg gets points on the way where a curve through its ends may leave it by more than this share
of the tolerance."""
_LOOK = 8.0
"""How far to both sides the direction of a corner is seen, in tolerances."""
_SHARP, _BACK = 0.8, 2.6
"""A change of direction by more than this is a sharp corner, and by more than that, a reversal, at
which the motion rests [rad]."""
_STRAIGHT_END = 0.05
"""How far a spline without bending at its end is off, by bending and the square of the span."""
_END_SHARE = 0.02
"""Share of the tolerance that this may take."""
_HALVINGS = 12
_BETWEEN = np.linspace(0.0, 1.0, 9)[:-1]


@dataclass(frozen=True, eq=False)
class Nearness:
    """How near to its polyline a motion has to be.

    Attributes:
        joint: Of each joint, shape (dof,) [rad or m]; None: of the tool.
        tool: Of the tool; None: of the joints.
    """

    joint: Array | None
    tool: Tolerance | None

    def first_half_widths(self, robot: Robot, q: Array) -> Array:
        """How far from the waypoints the joints may be, to begin with, shape (dof,)."""
        if self.joint is not None:
            return _SHARE * self.joint
        assert self.tool is not None
        some = q[np.unique(np.linspace(0, len(q) - 1, 64).astype(int))]
        J = np.abs(np.array([robot.jacobian(row) for row in some]))
        linear = np.linalg.norm(J[:, :3], axis=1).max(axis=0)
        angular = np.linalg.norm(J[:, 3:], axis=1).max(axis=0)
        most = min(
            self.tool.position / max(float(linear.sum()), 1e-12),
            self.tool.orientation / max(float(angular.sum()), 1e-12),
        )
        return np.full(q.shape[1], 2.0 * most)

    def ratio(self, robot: Robot, q: Array, polyline: Array) -> float:
        """How far configurations are from those of the polyline, as a ratio of what is allowed."""
        if self.joint is not None:
            return float((np.abs(q - polyline) / self.joint).max())
        assert self.tool is not None
        distance, angle = tool_apart(robot, q, polyline)
        ratio = max(distance.max() / self.tool.position, angle.max() / self.tool.orientation)
        return float(ratio)


@dataclass(frozen=True, eq=False)
class NearPath:
    """A joint path near joint waypoints.

    Attributes:
        path: The path; its waypoints are those of ``rows``.
        s: Path position of each waypoint asked for, shape (n,).
        sharp: Whether sharp corners are rounded.
    """

    path: JointPath
    s: Array
    sharp: bool


def smooth_path(
    asked: Array,
    robot: Robot,
    limits: JointLimits,
    nearness: Nearness,
    *,
    rest_at: Sequence[int] = (),
    rows: Sequence[int] = (),
    stop_at_sharp: bool = False,
) -> NearPath:
    """Return a smooth path within a tolerance of the polyline through waypoints.

    Args:
        asked: The waypoints, shape (n, dof), n >= 1 [rad or m].
        robot: The robot, with its tool.
        limits: Position limits to stay inside.
        nearness: How near the path has to be.
        rest_at: Waypoints that are passed exactly, at rest.
        rows: Waypoints that the path has to have as its own, in order.
        stop_at_sharp: Whether sharp corners are left as they are, at rest.
    """
    half = nearness.first_half_widths(robot, asked)
    for _ in range(_TRIES):
        rest, sharp = _rests(asked, half, rest_at, stop_at_sharp)
        found = _laid(asked, limits, half, rest, rows, sharp)
        if _off(found, asked, robot, nearness) <= 1.0:
            return found
        half = _TIGHTER * half
    # The polyline itself, with a stop at every waypoint.
    path = JointPath.through(asked, limits, rest_at=range(len(asked)))
    of_rows = path.knot_of_waypoint[list(rows)]
    own = JointPath(
        path.s_knots,
        path.q_knots,
        path.tangents_start,
        path.tangents_end,
        rest_knots=path.rest_knots,
        knot_of_waypoint=of_rows,
    )
    return NearPath(own, path.s_waypoints, False)


def _rests(
    asked: Array, half: Array, rest_at: Sequence[int], stop_at_sharp: bool
) -> tuple[list[int], bool]:
    """Waypoints at which the motion rests, and whether sharp corners are left to be rounded."""
    clusters = clusters_of(asked, half)
    u, middle = clusters.u, clusters.middle / half
    at = np.arange(len(u))
    before = np.searchsorted(u, u - _LOOK, "right") - 1
    after = np.searchsorted(u, u + _LOOK)
    inside = (before >= 0) & (after < len(u)) & (at > 0) & (at < len(u) - 1)
    before, after = np.maximum(before, 0), np.minimum(after, len(u) - 1)
    a, b = middle - middle[before], middle[after] - middle
    cosine = (a * b).sum(axis=1) / np.maximum(
        np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1), 1e-300
    )
    turn = np.where(inside, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)
    rest = {0, len(asked) - 1, *rest_at}
    sharp = False
    for k in np.flatnonzero(turn > _SHARP):
        near = np.abs(u - u[k]) <= _LOOK
        if turn[k] < turn[near].max() or k > np.flatnonzero(near & (turn == turn[k]))[0]:
            continue
        if turn[k] > _BACK or stop_at_sharp:
            own = np.flatnonzero(clusters.of_point == k)
            rest.add(int(own[len(own) // 2]))
        else:
            sharp = True
    return sorted(rest), sharp


def _laid(
    asked: Array,
    limits: JointLimits,
    half: Array,
    rest: list[int],
    rows: Sequence[int],
    sharp: bool,
) -> NearPath:
    """Lay a path with a fitted curve from each rest to the next."""
    points: list[Array] = [asked[:1]]
    rests, place = [0], np.zeros(len(asked))
    wanted: dict[int, Array] = {}
    count = 1
    for first, last in itertools.pairwise(rest):
        spline, u = _fitted(asked[first : last + 1], half)
        if spline is None:
            place[first : last + 1] = count - 1
            continue
        breaks = np.unique(spline.t)
        own = [u[row - first] for row in rows if first < row < last]
        at = _closer_at_ends(
            np.unique(np.concatenate([breaks, 0.5 * (breaks[1:] + breaks[:-1]), own])), spline, half
        )
        points.append(np.clip(spline(at[1:]), limits.lower, limits.upper))
        points[-1][-1] = asked[last]
        place[first : last + 1] = np.interp(u, at, count - 1 + np.arange(len(at)))
        wanted |= {row: spline(u[row - first]) for row in range(first + 1, last)}
        count += len(at) - 1
        rests.append(count - 1)
    path = JointPath.through(np.vstack(points), limits, rest_at=rests)
    s = _places(path, place, wanted)
    knots = np.array([round(place[row]) for row in rows], dtype=np.int64)
    own_path = JointPath(
        path.s_knots,
        path.q_knots,
        path.tangents_start,
        path.tangents_end,
        rest_knots=path.rest_knots,
        knot_of_waypoint=path.knot_of_waypoint[knots],
    )
    return NearPath(own_path, s, sharp)


def _closer_at_ends(at: Array, spline: BSpline, half: Array) -> Array:
    """Halve the spans at both ends until the joint spline keeps to the curve there.

    The joint spline is straight at its ends, where the curve bends: it is off by about 5 % of the
    bending times the square of the span.
    """
    added: list[float] = []
    for end, next_one in ((at[0], at[1]), (at[-1], at[-2])):
        span = float(next_one - end)
        bending = float((np.abs(spline(end, 2)) / half).max())
        for _ in range(_HALVINGS):
            if _STRAIGHT_END * bending * span * span <= _END_SHARE:
                break
            span *= 0.5
            added.append(float(end) + span)
    return np.unique(np.concatenate([at, added]))


def _places(path: JointPath, place: Array, wanted: dict[int, Array]) -> Array:
    """Path positions nearest to the fitted points, from places counted in points of the path."""
    s = np.interp(place, np.arange(len(path.s_waypoints)), path.s_waypoints)
    rows = np.array(sorted(wanted), dtype=np.int64)
    if len(rows) and path.length > 0.0:
        target = np.array([wanted[row] for row in rows])
        at = s[rows]
        for _ in range(3):
            q, dq, _ = path.derivatives(at)
            square = np.maximum((dq * dq).sum(axis=1), 1e-12)
            at = np.clip(at + ((target - q) * dq).sum(axis=1) / square, 0.0, path.length)
        moved = s.copy()
        moved[rows] = at
        moved = np.maximum.accumulate(moved)
        s = np.minimum(moved, s[-1])
    return s


def _fitted(rows: Array, half: Array) -> tuple[BSpline | None, Array]:
    """Fit a curve to rows; returns it, None if it has no length, and the parameter of each row."""
    points, of_row = _with_points_on_legs(rows / half)
    clusters = clusters_of(points * half, half)
    if len(clusters.u) < 2 or clusters.u[-1] <= 1e-6:
        return None, np.zeros(len(rows))
    spline = fit_within(clusters.u, clusters.middle, clusters.half_width)
    return spline, clusters.u[clusters.of_point[of_row]]


def _with_points_on_legs(scaled: Array) -> tuple[Array, Indices]:
    """Add points on the legs that a curve through their ends may leave.

    Args:
        scaled: The rows in tolerances, shape (n, dof).

    Returns:
        Points, and the index of each row among them, shape (n,).
    """
    steps = np.diff(scaled, axis=0)
    length = np.linalg.norm(steps, axis=1)
    unit = steps / np.maximum(length, 1e-300)[:, None]
    turn = np.linalg.norm(np.diff(unit, axis=0), axis=1)
    worst = np.maximum(np.append(turn, 0.0), np.append(0.0, turn))
    found, of_row = [scaled[0]], [0]
    for k, step in enumerate(steps):
        if length[k] * worst[k] / 8.0 > _BULGE:
            # From either end, each twice as far as the one before.
            half = [x / length[k] for x in 2.0 ** np.arange(60) if x < 0.4 * length[k]]
            shares = [*half, 0.5, *(1.0 - x for x in reversed(half))]
            found += [scaled[k] + share * step for share in shares]
        found.append(scaled[k + 1])
        of_row.append(len(found) - 1)
    return np.array(found), np.array(of_row)


def _off(found: NearPath, asked: Array, robot: Robot, nearness: Nearness) -> float:
    """How far a path is from the polyline, as a ratio of what is allowed."""
    path = found.path
    worst = nearness.ratio(robot, path(found.s), asked)
    if path.length == 0.0 or len(asked) < 2:
        return worst
    knots = path.s_knots
    s = (knots[:-1, None] + np.diff(knots)[:, None] * _BETWEEN).ravel()
    row = np.searchsorted(found.s, s, "right") - 1
    weight = np.ones(asked.shape[1]) if nearness.joint is None else nearness.joint
    near = Polyline(asked, weight).nearest(path(s), row)
    return max(worst, nearness.ratio(robot, path(s), near))
