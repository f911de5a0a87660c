"""A joint path with its timing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Indices, clamped
from ikplan.joint_path.evaluation import evaluate_timed
from ikplan.joint_path.joint_path import JointPath
from ikplan.timing.jerk.cubic_kernels import evaluate_cubic, times_of
from ikplan.timing.jerk.jerk import Smoothed
from ikplan.timing.span import SpanTiming

__all__ = ["TimedPath"]


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A joint path with the motion of its parameter between nodes.

    The path acceleration is constant between nodes; in a jerk-limited motion, linear.

    Attributes:
        path: The geometric path.
        s: Path positions of the nodes, shape (n + 1,); without jerk limits, every knot of the
            path is one.
        pieces: Piece of the path of each interval, shape (n,); empty in a jerk-limited motion.
        sdot: Path velocities at the nodes [1/s of s], shape (n + 1,); zero at rest points.
        node_times: Times of the nodes [s], shape (n + 1,), strictly increasing from 0.
        spans: How each span between rest points was timed, jerk limits apart.
        sddot: Path accelerations at the nodes of a jerk-limited motion, shape (n + 1,), or None.
        smoothed: How each span was smoothed to keep jerk limits.
    """

    path: JointPath
    s: Array
    pieces: Indices
    sdot: Array
    node_times: Array
    spans: tuple[SpanTiming, ...]
    sddot: Array | None = None
    smoothed: tuple[Smoothed, ...] = ()

    @property
    def duration(self) -> float:
        """Duration [s]; 0 for a path of length zero."""
        return float(self.node_times[-1])

    @property
    def jerk_limited(self) -> bool:
        """Whether the motion keeps jerk limits; if not, accelerations jump."""
        return self.sddot is not None

    @property
    def unlimited_duration(self) -> float:
        """Duration that the same limits allow without those of the jerk [s].

        It is found on a grid, and no more than that of this motion, which keeps them too.
        """
        return min(float(sum(span.dt.sum() for span in self.spans)), self.duration)

    @property
    def times(self) -> Array:
        """Times of the waypoints [s], shape (n_waypoints,); equal for waypoints that coincide."""
        return self.times_at(self.path.s_waypoints)

    @property
    def stop_times(self) -> Array:
        """Times at which the motion rests between its ends, shape (k,) [s]."""
        rests = np.flatnonzero(self.sdot[1:-1] == 0.0) + 1
        # Where it stands for a while, a stop is when it arrives.
        begins = (self.s[rests] > self.s[rests - 1]) & (self.s[rests] < self.s[-1])
        return np.asarray(self.node_times[rests[begins]])

    def times_at(self, positions: Array) -> Array:
        """Return when knots of the path are passed [s]; of a jerk-limited motion, any positions.

        Args:
            positions: Path positions, shape (m,); clipped to the path.
        """
        positions = clamped(positions, 0.0, self.path.length)
        if self.sddot is None:
            after = np.searchsorted(self.s, positions)
            before = np.maximum(after - 1, 0)
            nearer = positions - self.s[before] < self.s[after] - positions
            return self.node_times[np.where(nearer, before, after)]
        return times_of(self.node_times, self.s, self.sdot, self.sddot, positions)

    def times_anywhere(self, positions: Array) -> Array:
        """Return when any positions of the path are passed [s], shape (m,).

        Args:
            positions: Path positions, shape (m,); clipped to the path.
        """
        if self.sddot is not None or len(self.s) == 1:
            return self.times_at(positions)
        positions = clamped(positions, 0.0, self.path.length)
        k = clamped(np.searchsorted(self.s, positions, "right") - 1, 0, len(self.s) - 2)
        whole = self.s[k + 1] - self.s[k]
        gone = positions - self.s[k]
        before, after = self.sdot[k] ** 2, self.sdot[k + 1] ** 2
        square = before + (after - before) * gone / np.where(whole > 0.0, whole, 1.0)
        mean = 0.5 * (self.sdot[k] + np.sqrt(np.maximum(square, 0.0)))
        since = np.where(mean > 0.0, gone / np.where(mean > 0.0, mean, 1.0), 0.0)
        return np.minimum(self.node_times[k] + since, self.node_times[k + 1])

    def evaluate(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Evaluate the motion, exact at both ends.

        Args:
            t: Times [s], shape (m,); clipped to [0, duration].

        Returns:
            Joint positions [rad or m], velocities and accelerations, each of shape (m, dof). At a
            node, the acceleration is of the interval that begins there; at the end, of the last.
        """
        at = np.atleast_1d(np.asarray(t, dtype=np.float64))
        path = self.path
        if len(path.s_knots) == 1:
            q = np.repeat(path.q_knots, len(at), axis=0)
            return q, np.zeros_like(q), np.zeros_like(q)
        if self.sddot is not None:
            return self._cubic(at)[:3]
        return evaluate_timed(
            path.s_knots,
            path.q_knots,
            path.tangents_start,
            path.tangents_end,
            self.pieces,
            self.node_times,
            self.s,
            self.sdot,
            at,
        )

    def positions_at(self, t: Array) -> Array:
        """Return the path positions of a jerk-limited motion, shape (m,).

        Args:
            t: Times [s], shape (m,); clipped to [0, duration].
        """
        return self._cubic(t)[3] if len(self.path.s_knots) > 1 else np.zeros(len(t))

    def _cubic(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """Evaluate a jerk-limited motion; see evaluate_cubic."""
        assert self.sddot is not None  # it is jerk-limited
        path = self.path
        return evaluate_cubic(
            path.s_knots,
            path.q_knots,
            path.tangents_start,
            path.tangents_end,
            self.node_times,
            self.s,
            self.sdot,
            self.sddot,
            t,
        )

    def slowed(self, factor: float) -> TimedPath:
        """Return the same motion, slower.

        Args:
            factor: How many times longer it takes, >= 1.

        Returns:
            The slower motion: velocities divided by factor, accelerations by its square.
        """
        sddot = None if self.sddot is None else self.sddot / factor**2
        return replace(
            self, sdot=self.sdot / factor, node_times=self.node_times * factor, sddot=sddot
        )

    def standing(self, places: Sequence[tuple[float, float]]) -> TimedPath:
        """Return the same motion, standing for a while at places where it rests.

        Args:
            places: Path positions, of rests, and how long it stands there [s].
        """
        timed = self
        for place, seconds in places:
            rests = np.flatnonzero(timed.sdot == 0.0)
            k = int(rests[np.argmin(np.abs(timed.s[rests] - place))])
            later = timed.node_times.copy()
            later[k + 1 :] += seconds
            piece = timed.pieces[min(k, len(timed.pieces) - 1) :][:1]
            sddot = timed.sddot
            timed = replace(
                timed,
                s=np.insert(timed.s, k + 1, timed.s[k]),
                sdot=np.insert(timed.sdot, k + 1, 0.0),
                node_times=np.insert(later, k + 1, timed.node_times[k] + seconds),
                pieces=np.insert(timed.pieces, min(k, len(timed.pieces)), piece),
                sddot=None if sddot is None else np.insert(sddot, k + 1, 0.0),
            )
        return timed

    def lasting(self, duration: float) -> TimedPath:
        """Return the same motion, slowed until it takes a given time exactly.

        Args:
            duration: The duration [s], > 0; less than that of this motion by rounding at most.
        """
        slower = self.slowed(max(duration / self.duration, 1.0))
        node_times = slower.node_times * (duration / slower.duration)
        node_times[-1] = duration
        return replace(slower, node_times=node_times)
