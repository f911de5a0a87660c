"""The arm, its limits and the tolerance while it tracks a tool path."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.check import Contact, ContactCheck
from ikplan.documents.poses import Tolerance
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import ORIENTATION_WEIGHT, Freedom, fixed_rows
from ikplan.limits import JointLimits
from ikplan.path.tolerance_shares import MET, TRACKING, TRACKING_WITHIN
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.ladder.motion_cost import MotionCost, motion_cost_along, plain_cost
from ikplan.planning.segment_number import segment_number
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.time_budget import TimeBudget

__all__ = ["EXACT", "TrackedArm", "most_points"]


EXACT = 1e-9
"""Error of a point that counts as none [m and rad]."""
_MOST_POINTS = 20_000
"""Points of a path at which more are no longer added, unless it begins with many."""
_MOST_TIMES = 2
"""The same as a multiple of the points that a path begins with: four to a stop, one to a waypoint
that is passed."""


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
        contact: Refuses configurations and motions in contact; None: nothing is checked.
        within: Whether points that cannot be met exactly may be met within the tolerance.
        posture: What motions cost where a posture is preferred; None: joint motion alone counts.
        closeness: How near the joint spline stays to a path that is met exactly [m]: nearer than
            the tolerance asks for, where places on it have to be met.
        exact_share: Share of the tolerance that the joint spline takes at most there.
    """

    arm: Arm
    limits: JointLimits
    freedom: Freedom
    oriented: bool
    tolerance: Tolerance
    clock: TimeBudget
    contact: ContactCheck | None = None
    within: bool = False
    posture: MotionCost | None = None
    closeness: float = np.inf
    exact_share: float = TRACKING

    @property
    def cost(self) -> MotionCost:
        """What a motion costs."""
        return plain_cost(self.arm.dof) if self.posture is None else self.posture

    def sequence_cost(self, s: Array, q: Array) -> float:
        """Return what the motion through tracked points costs.

        Args:
            s: Path positions, shape (m,).
            q: Configurations, shape (m, dof) [rad or m].
        """
        return motion_cost_along(s, q, self.cost)

    @property
    def met(self) -> tuple[float, float]:
        """Distance [m] and angle [rad] from a target at which a point counts as on it."""
        if not self.within:
            return EXACT, EXACT
        return MET * self.tolerance.position, MET * self.tolerance.orientation

    @property
    def deviation_share(self) -> float:
        """Largest ratio of the joint spline's deviation to the tolerance."""
        if self.within:
            return TRACKING_WITHIN
        return min(self.exact_share, self.closeness / self.tolerance.position)

    def first_contact(self, reference: ReferencePath, s: Array, q: Array) -> Contact | None:
        """Return where the straight motions between tracked points first meet a body, or None.

        Args:
            reference: The path.
            s: Path positions, shape (m,).
            q: Configurations, shape (m, dof) [rad or m].
        """
        if self.contact is None:
            return None
        if not self.contact.changes_by_segment or not reference.segments:
            return self.contact.first_contact(q)
        for part in reference.segments:
            steps = np.flatnonzero((s[1:] > part.begin) & (s[:-1] < part.end))
            if len(steps) == 0:
                continue
            first = int(steps[0])
            rows = q[first : int(steps[-1]) + 2]
            found = self.contact.first_contact(rows, segment_number(part.field))
            if found is not None:
                return replace(found, step=first + found.step)
        return None

    def targets_at(self, reference: ReferencePath, s: Array) -> Targets:
        """Return the targets of path positions, shape (m,)."""
        R, p = reference.poses(s)
        mask = reference.orientation_mask(s) & self.oriented
        weight = ORIENTATION_WEIGHT
        if self.within:  # an error is to be as small as it can be in units of the tolerance
            weight = min(max(self.tolerance.position / self.tolerance.orientation, 0.01), 10.0)
        return Targets(
            np.ascontiguousarray(R),
            np.ascontiguousarray(p),
            mask,
            np.where(mask, weight, 0.0),
            self.freedom,
        )

    def redundant(self, reference: ReferencePath) -> bool:
        """Return whether the arm has self-motion along a path."""
        middle = np.array([0.5 * reference.length])
        oriented = self.oriented and bool(reference.orientation_mask(middle)[0])
        return self.arm.dof > fixed_rows(self.freedom, oriented)


def most_points(begun_with: int) -> int:
    """Return the number of points of a path at which more are no longer added.

    Args:
        begun_with: The number of points that it begins with.
    """
    return max(_MOST_POINTS, _MOST_TIMES * begun_with)
