"""Where on a tool path a pose is allowed, if anywhere near where it is about."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.offsets import offsets
from ikplan.path import ToolPath
from ikplan.request import PathRequest

__all__ = ["TimedSpan", "nearest_allowed", "offsets_at", "share_used", "windows_about"]

Array = NDArray[np.float64]

_LEAST_WINDOW = 1e-4
"""How far around a hint to look at least [m]."""
_PLACES, _ROUNDS = 33, 6
"""Places of the path that the least is looked for from, and steps from each."""


@dataclass(frozen=True)
class TimedSpan:
    """A tool path, and when the motion says it is where on it.

    Attributes:
        path: The tool path asked for.
        time: Times, shape (k,), increasing [s].
        s: Path length at each, shape (k,) [m]; hints for the search of the nearest pose.
    """

    path: ToolPath
    time: Array
    s: Array


def offsets_at(
    span: TimedSpan, path: PathRequest, p: Array, R: Array, s: Array
) -> tuple[Array, Array]:
    """Distances [m] and angles [rad] outside what is allowed at path lengths s, shape (m,)."""
    R_path, p_path = span.path.poses(s)
    distance, angle = offsets(path, p, R, p_path, R_path)
    asked = span.path.orientation_mask(s) & (path.orientation_free != "all")
    return distance, np.where(asked, angle, 0.0)


def share_used(path: PathRequest, distance: Array, angle: Array) -> Array:
    """Share of the tolerance used up."""
    return np.maximum(distance / path.tolerance.position, angle / path.tolerance.orientation)


def nearest_allowed(
    span: TimedSpan, path: PathRequest, p: Array, R: Array, hints: Array, windows: Array
) -> Array:
    """Path lengths within the windows where poses use least of the tolerance, in all it says.

    Looked for from the hints, and where that leads to none that is allowed, from all over the
    windows. Only places count that ask for an orientation as the hint does.
    """
    low, high = np.maximum(hints - windows, 0.0), np.minimum(hints + windows, span.path.length)
    asked = span.path.orientation_mask(hints)
    best, share = _descend(span, path, p, R, hints, low, high, asked)
    left = np.flatnonzero(share > 1.0)
    if len(left):
        shares = np.linspace(0.0, 1.0, _PLACES)
        begins = (low[left, None] + (high - low)[left, None] * shares).ravel()
        k = np.repeat(left, _PLACES)
        s, share = _descend(span, path, p[k], R[k], begins, low[k], high[k], asked[k])
        at = np.argmin(share.reshape(-1, _PLACES), axis=1)
        best[left] = s.reshape(-1, _PLACES)[np.arange(len(left)), at]
    return best


def _descend(
    span: TimedSpan,
    path: PathRequest,
    p: Array,
    R: Array,
    begins: Array,
    low: Array,
    high: Array,
    asked: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Slide along the path to where less of the tolerance is used, by parabolas through three.

    Returns:
        The best path lengths come across, shape (m,), and the shares used there; infinite where
        an orientation is asked for and ``asked``, shape (m,), says that it is not, or the reverse.
    """
    tolerance = path.tolerance

    def used(s: Array) -> tuple[Array, Array]:
        distance, angle = offsets_at(span, path, p, R, s)
        share = share_used(path, distance, angle)
        share[span.path.orientation_mask(s) != asked] = np.inf
        return share, (distance / tolerance.position) ** 2 + (angle / tolerance.orientation) ** 2

    s, best, least = begins, begins.copy(), np.full(len(begins), np.inf)
    h = 1e-3 * (high - low)
    for _ in range(_ROUNDS):
        share, middle = used(s)
        better = share < least
        best[better], least[better] = s[better], share[better]
        before, after = np.maximum(s - h, low), np.minimum(s + h, high)
        u, v = s - before, after - s
        _, left = used(before)
        _, right = used(after)
        down, up = (middle - left) / np.maximum(u, 1e-300), (right - middle) / np.maximum(v, 1e-300)
        slope = np.where(u * v > 0.0, (down * v + up * u) / np.maximum(u + v, 1e-300), down + up)
        bend = 2.0 * np.where(u * v > 0.0, (up - down) / np.maximum(u + v, 1e-300), 0.0)
        step = np.where(bend > 0.0, -slope / np.where(bend > 0.0, bend, 1.0), -np.sign(slope) * h)
        s = np.clip(s + step, low, high)
        h = 0.3 * h
    return best, least


def windows_about(span: TimedSpan, hints: Array) -> Array:
    """How far around each hint to look: hints are exact at stations and near between them."""
    gaps = np.pad(np.diff(span.s, append=span.s[-1]), 1)
    widest = np.maximum(np.maximum(gaps[:-2], gaps[1:-1]), gaps[2:])
    step = np.clip(np.searchsorted(span.s, hints, "right") - 1, 0, len(widest) - 1)
    return np.maximum(widest[step], _LEAST_WINDOW)
