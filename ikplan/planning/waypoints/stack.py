"""Targets of a path as arrays."""

from __future__ import annotations

import numpy as np

from ikplan.kinematics.target import Target
from ikplan.planning.ladder.ik_candidates import Targets

__all__ = ["stack_targets"]


def stack_targets(targets: list[Target]) -> Targets:
    """Return targets, which share their freedom, as arrays."""
    return Targets(
        np.array([t.R for t in targets]),
        np.array([t.p for t in targets]),
        np.array([t.oriented for t in targets]),
        np.array([t.weight for t in targets]),
        targets[0].freedom,
    )
