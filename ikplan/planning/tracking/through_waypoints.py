"""Points at waypoints and corners of a path, in a sequence chosen over fewer points."""

from __future__ import annotations

import contextlib

import numpy as np

from ikplan.path.curves.natural_spline import NaturalSpline
from ikplan.planning.tracking.reference_path import ReferencePath, positions_missing
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm
from ikplan.planning.tracking.tracked_path import JointSequence, TrackingFailed
from ikplan.planning.tracking.tracking_kernels import project_onto_targets

__all__ = ["whole_sequences"]


def whole_sequences(
    tracked: TrackedArm, reference: ReferencePath, sequences: list[JointSequence]
) -> list[JointSequence]:
    """Return those of sequences that reach every waypoint and corner, with points there.

    Args:
        tracked: The arm, and what it has to keep.
        reference: The path.
        sequences: Points from the begin to the end of the path each.
    """
    whole: list[JointSequence] = []
    for sequence in sequences:
        with contextlib.suppress(TrackingFailed):
            whole.append(_through_waypoints(tracked, reference, sequence))
    return whole


def _through_waypoints(
    tracked: TrackedArm, reference: ReferencePath, sequence: JointSequence
) -> JointSequence:
    """Return a sequence with a point at every waypoint and corner.

    Points that are missing are on a smooth curve through those there are, brought onto the path.

    Raises:
        TrackingFailed: The arm does not get from there to one of them.
    """
    length, s, q = sequence
    missing = positions_missing(reference, s)
    if len(missing) == 0:
        return sequence
    arm, targets = tracked.arm, tracked.targets_at(reference, missing)
    # By a smooth curve: kinks would stay, and take time.
    added = np.clip(NaturalSpline(s, q)(missing), arm.lower, arm.upper)
    left, spent = project_onto_targets(arm.chain, targets, added, arm.lower, arm.upper)
    tracked.clock.count(spent)
    off = np.flatnonzero(left > EXACT)
    if len(off):
        at = int(np.searchsorted(s, missing[off[0]]))
        raise TrackingFailed(float(s[at - 1]), q[at - 1].copy(), q[at].copy())
    every = np.concatenate([s, missing])
    order = np.argsort(every, kind="stable")
    return length, every[order], np.ascontiguousarray(np.vstack([q, added])[order])
