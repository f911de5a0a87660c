"""Around obstacles along a tool path, by self-motion and by what the path leaves free.

A ladder over points of the path: solutions of each that are free of contact, those that follow the
ones before, those beside them on their self-motion, and fresh ones. Steps between them are taken
only where the arm can follow the path from one to the other clear of contact. The way found is then
drawn taut among solutions near to it, still clear of contact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.around.path_ladder import PathLadder
from ikplan.planning.ladder.free_ladder import shortest_way
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.tracked_arm import TrackedArm

__all__ = ["dodged_sequence"]

_WIDE = (0.01, 0.003, 0.0)
"""Gaps on top of what is asked for that are tried, the widest first [m]."""


def dodged_sequence(
    arm: TrackedArm, reference: ReferencePath, starts: Array, costs: Array, s: Array
) -> Array | None:
    """Return configurations along a path that keep clear of contact, or None.

    Args:
        arm: The arm, with what refuses contact.
        reference: The path.
        starts: Configurations at the path's first pose, shape (c, dof) [rad or m].
        costs: Joint motion already spent to get to each, shape (c,).
        s: Path positions, an odd number m of them; every other is half-way between two.

    Returns:
        Shape (m, dof) [rad or m]; None: none was found.
    """
    assert arm.contact is not None
    for extra in _WIDE:
        wider = replace(arm, contact=arm.contact.wider(extra))
        q = _sequence(wider, reference, starts, costs, s)
        if q is not None:
            return q
    return None


def _sequence(
    arm: TrackedArm, reference: ReferencePath, starts: Array, costs: Array, s: Array
) -> Array | None:
    """Configurations along a path, shape (m, dof), or None; see above."""
    ladder = PathLadder(arm, reference, s)
    rungs = [np.ascontiguousarray(starts)]
    for k in range(1, len(s) // 2 + 1):
        arm.clock.check()
        rung = ladder.candidates(k, rungs[-1], starts[0])
        if len(rung) == 0:
            return None
        rungs.append(rung)
    way = shortest_way(rungs, costs, ladder.join)
    return None if way is None else ladder.drawn_taut(*way)
