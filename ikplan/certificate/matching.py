"""Where on a requested path each sample of a motion is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags, Indices, clamped
from ikplan.certificate.offset_kernels import keep_better
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedPath

__all__ = ["Match", "Samples", "match_samples"]


_STEPS = 16
_SETTLED = 1e-4
"""Change of the ratio to a tolerance below which a search has arrived."""
_STARTS, _STARTS_BETWEEN = 33, 1025
"""Places that are begun at: about a hint, and between samples that were matched."""
_MUCH = 0.5
"""Ratio to the tolerance from which on nearer places are looked for."""
_DESCENTS = 12
"""Of those places, how many are matched to the nearest best."""
_WORST = 16
"""Samples that are looked for everywhere before the others are."""
_PAIRS = 200_000
"""Most pairs of a sample and a place to begin at that are looked at together."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Tool poses on the way along a path, with the waypoints between which they are.

    Attributes:
        p: Positions in the base, shape (m, 3) [m].
        R: Rotations in the base, shape (m, 3, 3).
        hint: Path length that each is about at, shape (m,) [m].
        low: Path length of the waypoint passed before, shape (m,) [m].
        high: Path length of the waypoint passed after, shape (m,) [m].
    """

    p: Array
    R: Array
    hint: Array
    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class Match:
    """The places of a path that samples are nearest to, in what the request allows.

    Attributes:
        s: Path lengths, shape (m,) [m].
        oriented: Whether an orientation is asked for there, shape (m,).
        distance: Distance outside what is allowed, shape (m,) [m].
        angle: Rotation outside what is allowed, shape (m,) [rad].
        ratio: Larger ratio to the tolerances, shape (m,).
    """

    s: Array
    oriented: Flags
    distance: Array
    angle: Array
    ratio: Array


def match_samples(path: RequestedPath, allowance: Allowance, samples: Samples) -> Match:
    """Find for each sample the place of the path between its waypoints that it keeps best to.

    One place bears out position and orientation together. It is looked for by Gauss-Newton steps
    from the hint, on the piece there and its neighbours; where that uses up more than the
    tolerance, from places spread about the hint, then between the samples that were matched.

    Args:
        path: The path.
        allowance: What is allowed.
        samples: The samples, in order of time.
    """
    search = _Search(path, allowance, samples)
    search.near_hints()
    search.look_about_hints()
    # The worst first: where one of them keeps to no place, the path is left, and that is enough.
    for left in (search.left()[:_WORST], search.left()):
        if len(left) == 0:
            break
        search.look_farther(left)
        if len(search.among(left)):
            break
    return search.match()


class _Search:
    """The best place known of each sample."""

    def __init__(self, path: RequestedPath, allowance: Allowance, samples: Samples) -> None:
        self._path, self._allowance, self._samples = path, allowance, samples
        m = len(samples.p)
        # A sample between two waypoints is on the pieces between them, also at the very waypoints.
        first, end = path.piece_at(samples.low), np.searchsorted(path.begins, samples.high) - 1
        self._first, self._last = first, np.maximum(first, end)
        self._piece = self._piece_at(np.arange(m), samples.hint)
        self._best = np.full((m, 4), np.inf)
        self._best[:, 0] = samples.hint
        self._s, self._ratio, self._distance, self._angle = self._best.T
        gaps = np.abs(np.diff(samples.hint, prepend=samples.hint[:1], append=samples.hint[-1:]))
        box = 2.0 * float(np.linalg.norm(allowance.box_position))
        self.near = np.maximum(gaps[:-1], gaps[1:]) + 2.0 * allowance.position
        self.reach = self.near + box

    def match(self) -> Match:
        """What has been found."""
        oriented = self._path.oriented[self._piece] & (not self._allowance.positions_only)
        return Match(self._s, oriented, self._distance, self._angle, self._ratio)

    def near_hints(self) -> None:
        """Look from the hints, on their pieces and the neighbours within reach."""
        path, samples = self._path, self._samples
        here, every = self._piece, np.arange(len(self._piece))
        before = self._piece_at(every, samples.hint - self.reach) < here
        after = self._piece_at(every, samples.hint + self.reach) > here
        pairs = [(every, here)]
        for step, near in ((-1, before), (1, after)):
            # Not from where an orientation is asked for to where it is free, or back.
            k = np.flatnonzero(near)
            k = k[path.oriented[here[k] + step] == path.oriented[here[k]]]
            if len(k):
                pairs.append((k, here[k] + step))
        sample = np.concatenate([k for k, _ in pairs])
        piece = np.concatenate([k for _, k in pairs])
        self._descend(sample, piece, samples.hint[sample])

    def left(self) -> Indices:
        """Samples that keep to no place found so far, the worst first."""
        order = np.argsort(-self._ratio, kind="stable")
        return order[self._ratio[order] > 1.0]

    def among(self, samples: Indices) -> Indices:
        """Those of some samples that keep to no place found so far, in their order."""
        return np.sort(samples[self._ratio[samples] > 1.0])

    def look_about_hints(self) -> None:
        """Look about the hints of samples that use much of the tolerance."""
        much, hint = np.flatnonzero(self._ratio > _MUCH), self._samples.hint
        if len(much):
            self._spread(much, hint - 2.0 * self.near, hint + 2.0 * self.near, _STARTS)

    def look_farther(self, left: Indices) -> None:
        """Look from places spread ever farther about the hints, then between matched samples."""
        hint = self._samples.hint
        spans = 0.05 * (self._samples.high - self._samples.low)
        for width in (self.near + self.reach, spans + 4.0 * self.reach):
            self._spread(self.among(left), hint - width, hint + width, _STARTS)
        self._from_nodes(self.among(left), hint - spans, hint + spans)
        for width in (self.near, self.reach):
            low, high = self._between_matched(width)
            self._from_nodes(self.among(left), low, high)
            self._spread(self.among(left), low, high, _STARTS_BETWEEN)

    def _spread(self, left: Indices, low: Array, high: Array, count: int) -> None:
        """Look from ``count`` places between path lengths, each of shape (m,) [m]."""
        samples = self._samples
        low, high = np.maximum(low, samples.low), np.minimum(high, samples.high)
        shares = np.linspace(0.0, 1.0, count)
        for first in range(0, len(left), max(1, _PAIRS // count)):
            part = left[first : first + max(1, _PAIRS // count)]
            starts = low[part, None] + (high - low)[part, None] * shares
            self._look_from(np.repeat(part, count), starts.ravel())

    def _from_nodes(self, left: Indices, low: Array, high: Array) -> None:
        """Look from the nodes of the path between path lengths, and from half-way between them.

        A curve that turns within less than a step has its nodes there.
        """
        samples, nodes = self._samples, self._path.nodes
        nodes = np.sort(np.concatenate([nodes, 0.5 * (nodes[1:] + nodes[:-1])]))
        begin = np.searchsorted(nodes, np.maximum(low, samples.low)[left])
        end = np.searchsorted(nodes, np.minimum(high, samples.high)[left], "right")
        count = np.maximum(end - begin, 0)
        # About so many pairs of a sample and a node at once.
        part = np.cumsum(count) // _PAIRS
        for rows in np.split(np.arange(len(left)), np.flatnonzero(np.diff(part)) + 1):
            many = count[rows]
            sample = np.repeat(left[rows], many)
            since = np.arange(len(sample)) - np.repeat(np.cumsum(many) - many, many)
            if len(sample):
                self._look_from(sample, nodes[np.repeat(begin[rows], many) + since])

    def _look_from(self, sample: Indices, begins: Array) -> None:
        """Look from places [m] of samples, one after the other, and on from the best of each."""
        piece = self._piece_at(sample, begins)
        square = self._look(sample, piece, begins - self._path.begins[piece])[:, 0]
        group = np.cumsum(np.append(0, sample[1:] != sample[:-1]))
        order = np.lexsort((square, group))
        first = np.searchsorted(group, np.arange(group[-1] + 1))
        rank = np.arange(len(order)) - first[group]
        chosen = order[rank < _DESCENTS]
        self._descend(sample[chosen], piece[chosen], begins[chosen])

    def _piece_at(self, sample: Indices, s: Array) -> Indices:
        """The pieces at path lengths, among those between the waypoints of samples."""
        return clamped(self._path.piece_at(s), self._first[sample], self._last[sample])

    def _between_matched(self, width: Array) -> tuple[Array, Array]:
        """Path lengths from the last to the next matched sample of each, and a width [m] more."""
        samples = self._samples
        known = self._ratio <= 1.0
        low = np.maximum.accumulate(np.where(known, self._s, -np.inf))
        high = np.minimum.accumulate(np.where(known, self._s, np.inf)[::-1])[::-1]
        return np.minimum(low, samples.high) - width, np.maximum(high, samples.low) + width

    def _descend(self, sample: Indices, piece: Indices, starts: Array) -> None:
        """Gauss-Newton steps on pieces, within the waypoints; keeps what is better than known."""
        path, samples = self._path, self._samples
        begin, end = path.begins[piece], path.begins[piece + 1]
        low = np.maximum(samples.low[sample], begin) - begin
        high = np.maximum(np.minimum(samples.high[sample], end) - begin, low)
        s = clamped(starts - begin, low, high)
        step, before = np.zeros_like(s), np.full(len(s), np.inf)
        at = np.arange(len(s))
        for _ in range(_STEPS):
            square, along, scale = self._look(sample[at], piece[at], s[at]).T
            worse = square > before[at]
            along = np.where(worse, -0.5 * step[at], along)
            before[at] = np.minimum(square, before[at])
            ahead = clamped(s[at] + along, low[at], high[at])
            step[at] = ahead - s[at]
            s[at] = ahead
            # On until a step changes the ratio by next to nothing.
            at = at[np.abs(step[at]) * scale > _SETTLED]
            if len(at) == 0:
                break
        if len(at):
            self._look(sample[at], piece[at], s[at])

    def _look(self, sample: Indices, piece: Indices, s: Array) -> Array:
        """Measure samples at lengths s of pieces, and keep what is better than known.

        Returns:
            The steps of :class:`Offsets`, shape (n, 3).
        """
        path, allowance, samples = self._path, self._allowance, self._samples
        at = path.derivatives(piece, s)
        found = allowance.offsets(
            samples.p[sample],
            samples.R[sample],
            at.p,
            at.R,
            path.oriented[piece],
            (at.v, at.w),
        )
        keep_better(
            allowance.rows,
            found.apart,
            found.turned,
            sample,
            piece,
            path.begins[piece] + s,
            self._best,
            self._piece,
        )
        return found.steps
