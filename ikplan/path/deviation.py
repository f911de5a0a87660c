"""How far given tool poses are from a tool path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ikplan.path.piece import dot
from ikplan.path.rotation import log
from ikplan.path.tool_path import ToolPath

__all__ = ["path_deviation"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_BATCH = 2048
_SPACINGS = 4
"""Stations in half a window."""
_AT_END = 1e-12
"""How close to an end of where it is looked for a place is that end [m]."""
_TIE = 1e-12
"""Weight of the square of the way from the hint, where all else is equal."""


def path_deviation(
    tool_path: ToolPath,
    p: Array,
    R: Array,
    s_hint: Array,
    *,
    window: float | Array = 0.01,
    rotation_weight: float = 0.1,
) -> tuple[Array, Array, Array]:
    """Measure tool poses against the nearest pose of the path near given path lengths.

    Nearest is the pose of the path with the least ``distance^2 + (rotation_weight angle)^2``. Both
    figures of a pose are taken there, so that one pose of the path bears them out together. Every
    piece within the window is searched: at stations, then by safeguarded Newton steps around each
    station that can still lead to the least. Where the orientation is free ends, it is asked for:
    a hint from beyond that end is not measured there as if it were free.

    Args:
        tool_path: The path asked for.
        p: Tool positions in the base, shape (m, 3) [m].
        R: Tool rotations in the base, shape (m, 3, 3).
        s_hint: Path length that each pose is about at, shape (m,) [m].
        window: How far from the hint to look on either side, one for all or shape (m,) [m].
        rotation_weight: What a radian weighs against a metre [m/rad]; the ratio of the position
            and the orientation tolerance is a good choice. 0: the nearest point; on a turn on the
            spot, the pose nearest to the hint.

    Returns:
        Distance, shape (m,) [m]; angle, shape (m,) [rad], 0 where the orientation is free; and
        the path length of the nearest pose, shape (m,) [m].
    """
    p, R = np.asarray(p, dtype=np.float64), np.asarray(R, dtype=np.float64)
    hints = np.clip(np.asarray(s_hint, dtype=np.float64), 0.0, tool_path.length)
    windows = np.broadcast_to(np.asarray(window, dtype=np.float64), hints.shape)
    batches = [slice(k, k + _BATCH) for k in range(0, len(p), _BATCH)]
    found = [
        _Search(tool_path, p[b], R[b], hints[b], rotation_weight).nearest(windows[b])
        for b in batches
    ]
    if not found:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    distance, angle, s = (np.concatenate(column) for column in zip(*found, strict=True))
    return distance, angle, s


class _Search:
    """The search for one batch of poses."""

    def __init__(self, path: ToolPath, p: Array, R: Array, hints: Array, weight: float) -> None:
        self._path, self._p, self._R, self._hints = path, p, R, hints
        self._weight = weight if path.any_oriented else 0.0
        self._oriented = np.array([piece.oriented for piece in path.pieces])
        self._turns = np.array([piece.turns for piece in path.pieces])

    def nearest(self, window: Array) -> tuple[Array, Array, Array]:
        hints, begins, count = self._hints, self._path.begins, len(self._p)
        low, high = hints - window, hints + window
        last = len(begins) - 2
        first_piece = np.clip(np.searchsorted(begins, low, "right") - 1, 0, last)
        last_piece = np.clip(np.searchsorted(begins, high, "left") - 1, first_piece, last)
        # Pairs of a pose and a piece within its window.
        pose = np.repeat(np.arange(count), last_piece - first_piece + 1)
        piece = _ranges(first_piece, last_piece + 1)
        # At the end of a turn on the spot a span begins that leaves the orientation free: not that
        # the last of the turn be held to it.
        turning = self._turns[self._path.piece_at(hints)]
        counts = ~turning[pose] | (self._oriented if self._weight > 0.0 else self._turns)[piece]
        pose, piece = pose[counts], piece[counts]
        lower = np.clip(low[pose] - begins[piece], 0.0, None)
        upper = np.minimum(high[pose], begins[piece + 1]) - begins[piece]
        upper = np.maximum(upper, lower)
        # Stations on each pair, its ends included.
        gap = (np.where(window > 0.0, window, np.inf) / _SPACINGS)[pose]
        stations = np.ceil((upper - lower) / gap).astype(np.int64) + 1
        pair = np.repeat(np.arange(len(pose)), stations)
        step = (upper - lower) / np.maximum(stations - 1, 1)
        s = lower[pair] + _ranges(np.zeros_like(stations), stations) * step[pair]
        value, _, rate = self._cost(pose[pair], piece[pair], s)
        # The root of the cost changes by no more than the twist for each unit of s.
        root = np.sqrt(value)
        best = np.full(count, np.inf)
        within = self._beyond(pose[pair], piece[pair]) == 0
        np.minimum.at(best, pose[pair[within]], root[within])
        reach = np.sqrt(rate) * step[pair]
        keep = root - reach <= best[pose[pair]]
        pair, s = pair[keep], s[keep]
        here, on = pose[pair], piece[pair]
        a = np.maximum(s - step[pair], lower[pair])
        b = np.minimum(s + step[pair], upper[pair])
        s, value = self._descend(here, on, a, s, b)
        # A free piece from beyond its end: only a least of its own, not the way to that end.
        side = self._beyond(here, on)
        ends = ((side < 0) & (s <= a + _AT_END)) | ((side > 0) & (s >= b - _AT_END))
        value[ends] = np.inf
        order = np.lexsort((s + begins[on], value, here))
        chosen = order[np.concatenate([[True], np.diff(here[order]) > 0])]
        here, on, s = here[chosen], on[chosen], s[chosen]
        distance, angle = self._figures(here, on, s)
        return distance, angle, begins[on] + s

    def _beyond(self, pose: Index, piece: Index) -> Index:
        """On which side of a free piece the hint is: -1 before, 1 after, 0 within, or not free."""
        begins, hints = self._path.begins, self._hints[pose]
        side = np.where(hints < begins[piece], -1, np.where(hints > begins[piece + 1], 1, 0))
        return np.where(~self._oriented[piece] & (self._weight > 0.0), side, 0)

    def _errors(self, pose: Index, piece: Index, s: Array) -> tuple[Array, Array, Array, Array]:
        """Offset and rotation vector from path to pose in the base, and the path's twist."""
        motion = self._path.motion_on(piece, s)
        offset = self._p[pose] - motion.p
        turn = np.zeros_like(offset)
        if self._weight > 0.0:
            oriented = self._oriented[piece]
            Rs = motion.R[oriented]
            turn[oriented] = log(self._R[pose[oriented]] @ np.swapaxes(Rs, 1, 2))
        return offset, turn, motion.v, motion.w

    def _cost(self, pose: Index, piece: Index, s: Array) -> tuple[Array, Array, Array]:
        """Cost, half its slope downhill, and the square of the weighted twist."""
        offset, turn, v, w = self._errors(pose, piece, s)
        square = self._weight**2
        value = dot(offset, offset) + square * dot(turn, turn)
        downhill = dot(offset, v) + square * dot(turn, w)
        rate = dot(v, v) + square * dot(w, w)
        if self._weight == 0.0:
            # A turn on the spot is all one point: the hint tells which of its poses is meant.
            off = self._path.begins[piece] + s - self._hints[pose]
            tie = np.where(self._turns[piece], _TIE, 0.0)
            value, downhill, rate = value + tie * off * off, downhill - tie * off, rate + tie
        return value, downhill, rate

    def _descend(
        self, pose: Index, piece: Index, a: Array, s: Array, b: Array
    ) -> tuple[Array, Array]:
        """Gauss-Newton steps on s between a and b; halving where they overshoot."""
        best_s, best = s.copy(), np.full(len(s), np.inf)
        active = np.arange(len(s))
        a, s, b = a.copy(), s.copy(), b.copy()
        # Whether the slope at the end of the bracket is known, and points inwards.
        a_known, b_known = np.zeros(len(s), dtype=bool), np.zeros(len(s), dtype=bool)
        for _ in range(60):
            at = s[active]
            value, downhill, rate = self._cost(pose[active], piece[active], at)
            better = value < best[active]
            best[active[better]], best_s[active[better]] = value[better], at[better]
            forward = downhill > 0.0
            a[active[forward]], a_known[active[forward]] = at[forward], True
            b[active[~forward]], b_known[active[~forward]] = at[~forward], True
            low, high = a[active], b[active]
            target = at + downhill / np.maximum(rate, 1e-12)
            over = ((target < low) & a_known[active]) | ((target > high) & b_known[active])
            target = np.where(over, 0.5 * (low + high), np.clip(target, low, high))
            s[active] = target
            active = active[np.abs(target - at) > 1e-13 + 1e-11 * np.abs(target)]
            if len(active) == 0:
                break
        return best_s, best

    def _figures(self, pose: Index, piece: Index, s: Array) -> tuple[Array, Array]:
        motion = self._path.motion_on(piece, s)
        distance = np.linalg.norm(self._p[pose] - motion.p, axis=1)
        angle = np.zeros(len(s))
        here = self._oriented[piece]
        rotvec = log(np.swapaxes(motion.R[here], 1, 2) @ self._R[pose[here]])
        angle[here] = np.linalg.norm(rotvec, axis=1)
        return distance, angle


def _ranges(begin: Index, end: Index) -> Index:
    """Concatenate arange(begin[i], end[i])."""
    counts = end - begin
    starts = np.cumsum(counts) - counts
    return np.asarray(np.arange(counts.sum()) - np.repeat(starts - begin, counts))
