"""What the choice along the path works on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array
from ikplan.collision.check import Contact, ContactCheck
from ikplan.documents.poses import Tolerance
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.target import Target
from ikplan.planning.ladder.motion_cost import MotionCost, plain_cost
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget

__all__ = ["WaypointProblem"]


@dataclass(frozen=True)
class WaypointProblem:
    """Targets to be met one after the other.

    Attributes:
        robot: The robot, with its tool.
        solver: Solves single targets.
        targets: The targets, in order.
        q_start: Where the arm is, shape (dof,); with a free start, where it would rather be.
        start_free: Whether the path may begin anywhere.
        tolerance: Deviation allowed where a target cannot be met exactly.
        clock: The time budget.
        first_row: Number of the first target among the waypoints of the path.
        explain: Whether a refusal names every waypoint out of reach; else the first only.
        contact: Refuses configurations and motions in contact; None: nothing is checked.
        segments: Number of the segment that ends at each target; empty: not known.
        posture: What motions cost where a posture is preferred; None: joint motion alone counts.
    """

    robot: Robot
    solver: PoseSolver
    targets: list[Target]
    q_start: Array
    start_free: bool
    tolerance: Tolerance
    clock: TimeBudget
    first_row: int = 0
    explain: bool = True
    contact: ContactCheck | None = None
    segments: tuple[int | None, ...] = ()
    posture: MotionCost | None = None

    @property
    def cost(self) -> MotionCost:
        """What a motion costs."""
        return plain_cost(self.robot.dof) if self.posture is None else self.posture

    def segment(self, k: int) -> int | None:
        """Return the number of the segment that ends at target k; None: not known."""
        return self.segments[k] if k < len(self.segments) else None

    def first_contact(self, q: Array) -> Contact | None:
        """Return where straight motions through configurations first meet a body, or None.

        Args:
            q: One configuration for each target, shape (n, dof) [rad or m].
        """
        if self.contact is None:
            return None
        rows = q if self.start_free else np.vstack([self.q_start, q])
        if not self.contact.changes_by_segment:
            return self.contact.first_contact(rows)
        for k in range(len(rows) - 1):
            segment = self.segment(k + self.start_free)
            found = self.contact.first_contact(rows[k : k + 2], segment)
            if found is not None:
                return replace(found, step=k)
        return None
