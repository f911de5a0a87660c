"""The geometric joint path: a cubic spline over joint arc length."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Indices, lengths_of, steps_of
from ikplan.errors import InvalidRequest
from ikplan.joint_path.evaluation import evaluate_path, slopes_on
from ikplan.joint_path.spline import hermite_extrema, tangents_between
from ikplan.limits.joint_limits import JointLimits

__all__ = ["JointPath"]


# Waypoints closer than this share of the whole length count as one: below it, the direction
# between them is made of rounding errors. Those of a planned path are at distinct places of the
# tool; the joints may still stand, or all but stand, as the tool turns about an axis left free.
_MERGE = 1e-10
# A piece of less than this share of the length, over which the curvature changes, is a jump of it.
_SHORT = 1e-5


class JointPath:
    """A joint path q(s), cubic between knots, s the chord length along the waypoints.

    The path passes every waypoint exactly. Its first derivative is continuous, and so is the
    second except where the spline had to be bent to stay inside the position limits; at declared
    rest points both may jump.

    Attributes:
        s_knots: Knots [rad, m, or their mixed 2-norm], shape (k + 1,), from 0 to ``length``.
        q_knots: Joint positions at the knots, shape (k + 1, dof) [rad or m].
        tangents_start: dq/ds at the start of each piece, shape (k, dof).
        tangents_end: dq/ds at the end of each piece, shape (k, dof).
        rest_knots: Indices of the knots where the motion stops, first and last included.
        knot_of_waypoint: Knot of each waypoint, shape (n,).
    """

    def __init__(
        self,
        s_knots: Array,
        q_knots: Array,
        tangents_start: Array,
        tangents_end: Array,
        *,
        rest_knots: Sequence[int] = (),
        knot_of_waypoint: Indices | None = None,
    ) -> None:
        self.s_knots = s_knots
        self.q_knots = q_knots
        self.tangents_start = tangents_start
        self.tangents_end = tangents_end
        last = len(s_knots) - 1
        self.rest_knots = tuple(sorted({0, last, *rest_knots}))
        if knot_of_waypoint is None:
            knot_of_waypoint = np.arange(len(s_knots))
        self.knot_of_waypoint = knot_of_waypoint
        for array in (s_knots, q_knots, tangents_start, tangents_end, knot_of_waypoint):
            array.setflags(write=False)

    @classmethod
    def through(
        cls,
        waypoints: ArrayLike,
        limits: JointLimits | None = None,
        *,
        rest_at: Sequence[int] = (),
    ) -> JointPath:
        """Lay a spline through waypoints.

        The spline is natural (no curvature at its ends) with continuous second derivative, over
        chord length. Waypoints nearer to each other than 1e-10 of the whole length share a knot;
        the last one is kept exactly. Where the spline would leave the position limits, which is
        found from the extrema of each cubic and not by sampling, tangents are shortened until it
        stays inside.

        Args:
            waypoints: Joint positions, shape (n, dof), n >= 1 [rad or m].
            limits: Position limits to stay inside; None: no limits.
            rest_at: Indices of waypoints where the motion stops and the path may have a corner.

        Returns:
            The path.

        Raises:
            InvalidRequest: The waypoints have the wrong shape, are not finite or are outside the
                limits (names the row and the joint), or a rest index does not exist.
        """
        q = np.array(waypoints, dtype=np.float64)
        if q.ndim != 2 or 0 in q.shape:
            raise InvalidRequest(
                f"waypoints must have shape (n, dof) with n, dof >= 1, not {q.shape}",
                field="waypoints",
            )
        if limits is not None:
            limits.check_positions(q, "waypoints")
        elif not np.isfinite(q).all():
            row = int(np.argmax(~np.isfinite(q).all(axis=1)))
            raise InvalidRequest(
                f"waypoints[{row}] is not finite", field=f"waypoints[{row}]", allowed="numbers"
            )
        for index in rest_at:
            if not 0 <= index < len(q):
                raise InvalidRequest(
                    f"rest_at: there is no waypoint {index}",
                    field="rest_at",
                    allowed=f"0 to {len(q) - 1}",
                )
        kept, knot_of_waypoint = _distinct(q)
        q_knots = q[kept]
        s_knots = np.concatenate([[0.0], np.cumsum(lengths_of(steps_of(q_knots)))])
        rests = sorted({0, len(kept) - 1, *(int(knot_of_waypoint[i]) for i in rest_at)})
        lower, upper = (
            (np.full(q.shape[1], -np.inf), np.full(q.shape[1], np.inf))
            if limits is None
            else (limits.lower, limits.upper)
        )
        start, end = tangents_between(s_knots, q_knots, np.array(rests), lower, upper)
        return cls(
            s_knots, q_knots, start, end, rest_knots=rests, knot_of_waypoint=knot_of_waypoint
        )

    def with_knots(self, s: Sequence[float]) -> JointPath:
        """Return the same path with knots at more places.

        Args:
            s: Path positions; those outside the path, or within 1e-9 of its length of a knot,
                are left out.

        Returns:
            The path, its pieces divided.
        """
        slack = 1e-9 * self.length
        nearest = [float(np.abs(self.s_knots - value).min()) for value in s]
        inside = [v for v, d in zip(s, nearest, strict=True) if 0.0 < v < self.length and d > slack]
        more = np.unique(np.array(inside, dtype=np.float64))
        if not len(more):
            return self
        more = more[np.append(True, steps_of(more) > slack)]
        q, m, _ = self.derivatives(more)
        at = np.searchsorted(self.s_knots, more)
        moved = np.arange(len(self.s_knots)) + np.searchsorted(more, self.s_knots)
        return JointPath(
            np.insert(self.s_knots, at, more),
            np.insert(self.q_knots, at, q, axis=0),
            np.insert(self.tangents_start, at, m, axis=0),
            np.insert(self.tangents_end, at - 1, m, axis=0),
            rest_knots=[int(moved[i]) for i in self.rest_knots],
            knot_of_waypoint=moved[self.knot_of_waypoint],
        )

    @property
    def dof(self) -> int:
        """Number of joints."""
        return int(self.q_knots.shape[1])

    @property
    def length(self) -> float:
        """Length of the path, along the chords between its waypoints [rad or m]."""
        return float(self.s_knots[-1])

    @property
    def s_waypoints(self) -> Array:
        """Path positions of the waypoints, shape (n,)."""
        return self.s_knots[self.knot_of_waypoint]

    def __call__(self, s: ArrayLike, order: int = 0) -> Array:
        """Evaluate the path or a derivative by s.

        Args:
            s: Path positions, shape (m,); clipped to [0, length].
            order: 0 for q, 1 for dq/ds, 2 for d2q/ds2; at a knot, of the piece that begins there.

        Returns:
            Shape (m, dof).
        """
        at = np.atleast_1d(np.asarray(s, dtype=np.float64))
        return self.derivatives(at)[order]

    def derivatives(self, s: Array, pieces: Indices | None = None) -> tuple[Array, Array, Array]:
        """Evaluate q, dq/ds and d2q/ds2.

        Args:
            s: Path positions, shape (m,).
            pieces: Piece of each, shape (m,), which decides the side at a knot; None: the piece
                that begins at or before it.

        Returns:
            Three arrays of shape (m, dof).
        """
        if len(self.s_knots) == 1:
            q = np.repeat(self.q_knots, len(s), axis=0)
            return q, np.zeros_like(q), np.zeros_like(q)
        if pieces is None:
            pieces = np.full(len(s), -1)
        return evaluate_path(
            self.s_knots, self.q_knots, self.tangents_start, self.tangents_end, pieces, s
        )

    def slopes_on(self, s: Array, pieces: Indices) -> tuple[Array, Array, Array]:
        """Evaluate the derivatives at both ends of the intervals of a grid.

        Args:
            s: Nodes, shape (n + 1,).
            pieces: Piece of each interval, shape (n,).

        Returns:
            dq/ds at the starts, d2q/ds2 at the starts and d2q/ds2 at the ends, each of shape
            (n, dof).
        """
        return slopes_on(
            self.s_knots, self.q_knots, self.tangents_start, self.tangents_end, pieces, s
        )

    @functools.cached_property
    def third_derivatives(self) -> Array:
        """d3q/ds3 of every piece, which is constant there, shape (k, dof)."""
        pieces = np.arange(len(self.s_knots) - 1)
        s = self.s_knots.copy()  # one compiled kind of arrays
        _, _, start = self.derivatives(s[:-1], pieces)
        _, _, end = self.derivatives(s[1:], pieces)
        third: Array = (end - start) / steps_of(self.s_knots)[:, None]
        return third

    def curvature_jumps(self) -> Indices:
        """Return the knots, rest points apart, where d2q/ds2 jumps.

        It does where the spline was bent to stay inside limits, and, for all that a motion can
        do about it, over a piece between two waypoints that nearly coincide.
        """
        if self.length == 0.0:
            return np.zeros(0, dtype=np.int64)
        pieces = np.arange(len(self.s_knots) - 1)
        s = self.s_knots.copy()  # one compiled kind of arrays
        _, _, start = self.derivatives(s[:-1], pieces)
        _, _, end = self.derivatives(s[1:], pieces)
        # A line has no curvature but rounding; dq/ds is about one.
        size = max(
            float(np.abs(start).max(initial=0.0)),
            float(np.abs(end).max(initial=0.0)),
            1.0 / self.length,
        )
        jump = np.abs(start[1:] - end[:-1]).max(axis=1, initial=0.0) > 1e-6 * size
        change = np.abs(end - start).max(axis=1, initial=0.0)
        short = steps_of(self.s_knots) < _SHORT * self.length
        found = np.union1d(np.flatnonzero(jump) + 1, np.flatnonzero(short & (change > 0.01 * size)))
        return found[~np.isin(found, self.rest_knots)]

    def stopping_at(self, knots: Indices) -> JointPath:
        """Return the same path with more rest points.

        Args:
            knots: Indices of knots.

        Returns:
            The path.
        """
        return JointPath(
            self.s_knots,
            self.q_knots,
            self.tangents_start,
            self.tangents_end,
            rest_knots=[*self.rest_knots, *(int(i) for i in knots)],
            knot_of_waypoint=self.knot_of_waypoint,
        )

    def extrema(self) -> tuple[Array, Array]:
        """Return the least and greatest joint positions anywhere on the path, shape (dof,) each."""
        if len(self.s_knots) == 1:
            return self.q_knots[0], self.q_knots[0]
        low, high = hermite_extrema(
            self.s_knots, self.q_knots, self.tangents_start, self.tangents_end
        )
        return low.min(axis=0), high.max(axis=0)


def _distinct(q: Array) -> tuple[Indices, Indices]:
    """Return the rows to keep and, for each row, the number of the kept row it belongs to."""
    steps = lengths_of(steps_of(q))
    smallest = _MERGE * steps.sum()
    if (steps > smallest).all():
        return np.arange(len(q)), np.arange(len(q))
    kept = [0]
    knot_of_row = np.zeros(len(q), dtype=np.int64)
    for row in range(1, len(q)):
        if np.linalg.norm(q[row] - q[kept[-1]]) > smallest:
            kept.append(row)
        knot_of_row[row] = len(kept) - 1
    # The first and the last waypoint are exact; what is merged with them is near them.
    if len(kept) > 1:
        kept[-1] = len(q) - 1
    while len(kept) > 2 and np.linalg.norm(q[-1] - q[kept[-2]]) <= smallest:
        del kept[-2]
    return np.array(kept), np.minimum(knot_of_row, len(kept) - 1)
