"""Leading the joints evenly where a tracked path stays beside itself near a singularity.

Points near a singularity are met within the tolerance one by one, by steps that the singularity
scatters: motions through them never settle however many are added. Over each run of such points
the joints are led as evenly as the tolerance allows instead, all points of it at once.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.tracked_arm import TrackedArm
from ikplan.planning.within.tolerance_window import error_ratios, led_between
from ikplan.planning.within.track_within import SpanList

__all__ = ["led_beside"]

_ON_PATH = 1e-3
"""Ratio of a point's error to the tolerance up to which it counts as exact."""
_STEP = 2.5e-3
"""Spacing of the points of a run [m]."""
_FEWEST, _MOST = 32, 256
"""Steps of a run."""


def led_beside(
    tracked: TrackedArm, reference: ReferencePath, s: Array, q: Array
) -> tuple[Array, Array, SpanList] | None:
    """Return a tracked path led evenly over the runs of points that are not on it.

    Args:
        tracked: The arm, and what it has to keep within the tolerance.
        reference: The path.
        s: Path positions of the points tracked, shape (m,).
        q: Their configurations, shape (m, dof) [rad or m].

    Returns:
        Path positions, configurations, and the runs; None where every point is on the path, or
        a run cannot be led within the tolerance.

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    runs = _runs(reference, s, error_ratios(tracked, reference, s, q) > _ON_PATH)
    spans = [(float(s[first]), float(s[last])) for first, last in runs]
    for (first, last), (begin, end) in zip(reversed(runs), reversed(spans), strict=True):
        tracked.clock.check()
        steps = min(max(math.ceil((end - begin) / _STEP), _FEWEST), _MOST)
        found = led_between(tracked, reference, (begin, end), q[first], q[last], steps)
        if found is None:
            return None
        s = np.concatenate([s[:first], found[0], s[last + 1 :]])
        q = np.ascontiguousarray(np.vstack([q[:first], found[1], q[last + 1 :]]))
    return (s, q, spans) if runs else None


def _runs(reference: ReferencePath, s: Array, off: Flags) -> list[tuple[int, int]]:
    """First and last points of the runs that hold points off the path; none goes over a corner."""
    runs: list[tuple[int, int]] = []
    for k in np.flatnonzero(off[1:] | off[:-1]).tolist():
        if runs and runs[-1][1] == k and s[k] not in reference.corners:
            runs[-1] = runs[-1][0], k + 1
        else:
            runs.append((k, k + 1))
    return runs
