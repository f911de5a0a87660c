"""The jerk-limited motion of a path, found from its motion without jerk limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.timing.engines.engine import Check, unlimited
from ikplan.timing.jerk.jerk import smooth_span
from ikplan.timing.jerk.least_duration import least_duration
from ikplan.timing.jerk.smoothed import Smoothed
from ikplan.timing.timed_path import TimedPath

__all__ = ["NotShorter", "limit_jerk"]


class NotShorter(Exception):
    """No jerk-limited motion along a path is as short as asked for; stays inside the program."""


def limit_jerk(timed: TimedPath, check: Check = unlimited, most: float = np.inf) -> TimedPath:
    """Return the motion along the same path within the jerk limits too.

    Each span between rests is smoothed by itself. Those that may gain most on what they are known
    to take at least come first: the motion is given up as soon as it cannot be as short as asked.

    Args:
        timed: The motion that keeps all limits but those of the jerk, as time_before_jerk finds
            it.
        check: Is called now and then, and may end the timing by an error of its own.
        most: What the motion may take [s].

    Returns:
        The motion.

    Raises:
        NotShorter: The motion takes longer than ``most``.
    """
    spans = timed.spans
    order = np.arange(len(spans))
    taken = np.zeros(len(spans))
    if np.isfinite(most):
        found = [least_duration(span.problem, span.x) for span in spans]
        by_jerk, without = np.array(found).reshape(-1, 2).T
        # Where the jerk limits bound a joint's whole move, little is left to be found out: the
        # spans that take longest beyond that tell most.
        order = np.argsort(by_jerk - without, kind="stable")
        taken = np.maximum(by_jerk, without)
    motions: dict[int, Smoothed] = {}
    for k in order.tolist():
        if float(taken.sum()) > most:
            raise NotShorter
        motions[k] = smooth_span(spans[k].problem, check)
        taken[k] = motions[k].duration
    if float(taken.sum()) > most:
        raise NotShorter
    return _joined(timed, [motions[k] for k in range(len(spans))])


def _joined(timed: TimedPath, smoothed: list[Smoothed]) -> TimedPath:
    """Join jerk-limited motions of spans end to end."""
    motions = [each.motion for each in smoothed]
    if not motions:
        return replace(timed, sddot=np.zeros(1))
    ends = np.cumsum([float(motion.time[-1]) for motion in motions])
    starts = np.concatenate([[0.0], ends[:-1]])
    time = [m.time[1:] + start for m, start in zip(motions, starts, strict=True)]
    return TimedPath(
        path=timed.path,
        s=np.concatenate([[0.0], *(m.s[1:] for m in motions)]),
        pieces=np.zeros(0, dtype=np.int64),
        sdot=np.concatenate([[0.0], *(m.v[1:] for m in motions)]),
        node_times=np.concatenate([[0.0], *time]),
        spans=timed.spans,
        sddot=np.concatenate([[0.0], *(m.a[1:] for m in motions)]),
        smoothed=tuple(smoothed),
    )
