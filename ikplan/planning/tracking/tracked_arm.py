"""The arm, its limits and the tolerance while it tracks a tool path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.plan_request import Tolerance
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, constraint_rows
from ikplan.limits import JointLimits
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.time_budget import TimeBudget

__all__ = ["EXACT", "MAX_POINTS", "TrackedArm"]


EXACT = 1e-9
"""Error of a point that counts as none [m and rad]."""
MAX_POINTS = 20_000
"""Points of a path at which more are no longer added."""


@dataclass(frozen=True)
class TrackedArm:
    """An arm that tracks tool paths.

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

    def targets_at(self, reference: ReferencePath, s: Array) -> Targets:
        """Return the targets of path positions, shape (m,)."""
        R, p = reference.poses(s)
        mask = reference.orientation_mask(s) & self.oriented
        return Targets(
            np.ascontiguousarray(R),
            np.ascontiguousarray(p),
            mask,
            np.where(mask, ORIENTATION_WEIGHT, 0.0),
            self.freedom,
        )

    def redundant(self, reference: ReferencePath) -> bool:
        """Return whether the arm has self-motion along a path."""
        targets = self.targets_at(reference, np.array([0.5 * reference.length]))
        return self.arm.dof > constraint_rows(target_at(targets, 0))
