"""Contact at the start that a request asks to leave: which pairs may touch, and until when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ikplan.scene.body import Body, CollisionModel

__all__ = ["Leaving", "with_leaving"]


@dataclass(frozen=True)
class Leaving:
    """Pairs that touch at the start.

    Attributes:
        rows: Rows of the model's pairs.
        until: When they are to be apart [s].
    """

    rows: tuple[int, ...]
    until: float


def with_leaving(
    model: CollisionModel,
    leaving: Leaving,
    segment_times: Sequence[tuple[float, float]] | None,
    duration: float,
) -> tuple[CollisionModel, list[tuple[float, float]]]:
    """Return a model, and segments with the leaving as the first, in which its pairs are left out.

    Of each pair a copy of one body takes its place, which is there from the next segment on.

    Args:
        model: The bodies.
        leaving: The pairs, and until when they may touch.
        segment_times: When each segment begins and ends [s]; None: the motion is one.
        duration: When the motion ends [s].
    """
    bodies = [_later(body, 1) for body in model.bodies]
    pairs = np.array(model.pairs)
    for row in leaving.rows:
        body = bodies[int(pairs[row, 0])]
        bodies.append(replace(body, first_segment=max(body.first_segment or 0, 1), source=""))
        pairs[row, 0] = len(bodies) - 1
    times = [(0.0, leaving.until)]
    for begin, end in segment_times or [(0.0, duration)]:
        times.append((max(begin, leaving.until), max(end, leaving.until)))
    return replace(model, bodies=tuple(bodies), pairs=pairs), times


def _later(body: Body, by: int) -> Body:
    """A body that counts segments from later on; what is there from the start is so still."""
    first, last = body.first_segment, body.last_segment
    if first is not None:
        # What is carried on the first segment is carried while the start is left.
        first = 0 if first == 0 else first + by
    return replace(body, first_segment=first, last_segment=None if last is None else last + by)
