"""An arm to be led along tool paths, and what it has to keep there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikplan.documents.plan_request import Tolerance
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, constraint_rows
from ikplan.limits import JointLimits
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.time_budget import TimeBudget

__all__ = ["EXACT", "MOST_STATIONS", "TrackedArm"]

Array = NDArray[np.float64]

EXACT = 1e-9
"""Error of a station that counts as none [m and rad]."""
MOST_STATIONS = 20_000
"""Stations of a path at which more are no longer added."""


@dataclass(frozen=True)
class TrackedArm:
    """An arm to be led along tool paths.

    Attributes:
        arm: The arm.
        limits: Its position limits.
        freedom: What need not hold along the path.
        oriented: Whether orientations count at all.
        tolerance: How far from the path the tool may be.
        clock: The time budget.
    """

    arm: Arm
    limits: JointLimits
    freedom: Freedom
    oriented: bool
    tolerance: Tolerance
    clock: TimeBudget

    def targets_at(self, guide: ReferencePath, s: Array) -> Targets:
        """Return the targets of path positions, shape (m,)."""
        R, p = guide.poses(s)
        mask = guide.orientation_mask(s) & self.oriented
        return Targets(
            np.ascontiguousarray(R),
            np.ascontiguousarray(p),
            mask,
            np.where(mask, ORIENTATION_WEIGHT, 0.0),
            self.freedom,
        )

    def redundant(self, guide: ReferencePath) -> bool:
        """Return whether the arm has self-motion along a path."""
        targets = self.targets_at(guide, np.array([0.5 * guide.length]))
        return self.arm.dof > constraint_rows(target_at(targets, 0))
