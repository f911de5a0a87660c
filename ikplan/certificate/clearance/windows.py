"""Parts of a motion in which the same bodies are there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ikplan.errors import InvalidRequest
from ikplan.scene.body import Body

__all__ = ["Window", "is_there", "windows_of"]

_SAME = 1e-9
"""Times this near to each other are one, as a share of the duration."""


@dataclass(frozen=True)
class Window:
    """A part of a motion.

    Attributes:
        begin: When it begins [s].
        end: When it ends [s].
        segments: Segments whose bodies are there: its own, or, between two, both.
        own: Segment it is, or None.
    """

    begin: float
    end: float
    segments: tuple[int, ...]
    own: int | None


def windows_of(
    duration: float, segment_times: Sequence[tuple[float, float]] | None
) -> list[Window]:
    """Return windows that together hold the whole motion: each segment, and what lies between.

    Args:
        duration: When the motion ends [s].
        segment_times: When each segment begins and ends [s]; they may overlap at corners. None:
            the motion is one.

    Raises:
        InvalidRequest: A segment ends before it begins, or before the one before it begins.
    """
    if not segment_times:
        return [Window(0.0, duration, (), None)]
    found: list[Window] = []
    reached, same = 0.0, _SAME * duration
    for k, (begin, end) in enumerate(segment_times):
        if not begin <= end or (k > 0 and begin < segment_times[k - 1][0]):
            raise InvalidRequest(
                f"segment_times[{k}]: from {begin!r} to {end!r} s",
                field=f"segment_times[{k}]",
                allowed="segments in their order, none ends before it begins",
            )
        if begin > reached + same:
            found.append(Window(reached, begin, tuple({max(k - 1, 0), k}), None))
        found.append(Window(max(begin, 0.0), min(end, duration), (k,), k))
        reached = max(reached, end)
    if reached < duration - same:
        found.append(Window(reached, duration, (len(segment_times) - 1,), None))
    return found


def is_there(body: Body, window: Window) -> bool:
    """Whether a body exists in a window; without segments every body does."""
    if not window.segments:
        return True
    first = -1 if body.first_segment is None else body.first_segment
    last = max(window.segments) if body.last_segment is None else body.last_segment
    return any(first <= k <= last for k in window.segments)
