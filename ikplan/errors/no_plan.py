"""The request makes sense, and there is no plan for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ikplan.errors.base import IkplanError

__all__ = [
    "BudgetExceeded",
    "Disconnected",
    "InCollision",
    "NoPlan",
    "TimingFailed",
    "Unreachable",
]


class NoPlan(IkplanError):
    """The request makes sense, and there is no plan for it: a group, to be caught."""


class Unreachable(NoPlan):
    """A waypoint has no solution within limits and tolerance.

    Attributes:
        waypoint: Index of the waypoint, from 0.
        position_error: Smallest position error found [m].
        orientation_error: Orientation error of that configuration [rad]; None: position target.
        q: Joint values of the best configuration found, shape (dof,) [rad or m].
        reason: Why, as far as it is known: out of reach by so much, or which joint limit binds.
        limits: Names of the joints that stand at a position limit in ``q``.
        target: Where the tool was to be, in the robot's base, as ``{"position",
            "quaternion_xyzw"}`` (None: any orientation) [m], or None.
        waypoints: Every waypoint found unreachable, as ``{"waypoint", "position_error",
            "orientation_error", "reason", "target"}``.
        repairs: Changes of the request that were tried and make it feasible, least first, as
            ``{"change", "detail"}``: the fields to change, and what that means in words.
    """

    slug = "unreachable"
    title = "Waypoint unreachable"
    status = 422
    fields = (
        "waypoint",
        "position_error",
        "orientation_error",
        "q",
        "reason",
        "limits",
        "target",
        "waypoints",
        "repairs",
    )

    def __init__(
        self,
        detail: str,
        *,
        waypoint: int,
        position_error: float,
        orientation_error: float | None,
        q: Sequence[float],
        reason: str,
        limits: Sequence[str] = (),
        target: Mapping[str, Any] | None = None,
        waypoints: Sequence[Mapping[str, Any]] = (),
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoint = waypoint
        self.position_error = position_error
        self.orientation_error = orientation_error
        self.q = [float(v) for v in q]
        self.reason = reason
        self.limits = list(limits)
        self.target = None if target is None else dict(target)
        self.waypoints = [dict(w) for w in waypoints]
        self.repairs = [dict(r) for r in repairs]


class Disconnected(NoPlan):
    """Each waypoint has solutions, but no continuous motion joins two neighbours.

    Attributes:
        waypoints: Indices of the two waypoints, from 0; -1 stands for the start configuration.
        jump: Largest single-joint difference a motion between them would need [rad or m].
        reason: Why the motion is not possible.
        q: Joint values at which the motion gets no further, shape (dof,) [rad or m].
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
    """

    slug = "disconnected"
    title = "Path disconnected"
    status = 422
    fields = ("waypoints", "jump", "reason", "q", "repairs")

    def __init__(
        self,
        detail: str,
        *,
        waypoints: Sequence[int],
        jump: float,
        reason: str = "",
        q: Sequence[float] = (),
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoints = [int(i) for i in waypoints]
        self.jump = jump
        self.reason = reason
        self.q = [float(v) for v in q]
        self.repairs = [dict(r) for r in repairs]


class InCollision(NoPlan):
    """The arm, its tool or what it holds comes closer to a body than the clearance asked for.

    Attributes:
        waypoint: Index of the waypoint, from 0; -1 stands for the start configuration; None: it
            happens between waypoints.
        time: When in the finished motion [s]; None: there is no timed motion yet.
        pair: Names of the two bodies.
        depth: How far the gap falls short of the clearance asked for; of bodies in each other, how
            deep they are and the clearance [m].
        q: Joint values at which it happens, shape (dof,) [rad or m].
        proven: Whether contact is proven there; false: no way around was found.
        reason: Why no way around was found: how many candidates failed for which pair.
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
    """

    slug = "in-collision"
    title = "In collision"
    status = 422
    fields = ("waypoint", "time", "pair", "depth", "q", "proven", "reason", "repairs")

    def __init__(
        self,
        detail: str,
        *,
        waypoint: int | None = None,
        time: float | None = None,
        pair: Sequence[str] = (),
        depth: float = 0.0,
        q: Sequence[float] = (),
        proven: bool = False,
        reason: str = "",
        repairs: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(detail)
        self.waypoint = waypoint
        self.time = time
        self.pair = [str(name) for name in pair]
        self.depth = depth
        self.q = [float(v) for v in q]
        self.proven = proven
        self.reason = reason
        self.repairs = [dict(r) for r in repairs]


class TimingFailed(NoPlan):
    """No timing exists, or none was found, under the limits.

    Attributes:
        position: Where on the path, as a fraction 0..1 of its joint arc length, or None.
        joint: Name of the joint, or None.
        limit: The limit that cannot be kept ("velocity", "acceleration", "position", "torque"), or
            None.
        repairs: Changes of the request that were tried and make it feasible, as
            ``{"change", "detail"}``.
        nearest: Fields of the request with the nearest values found that are feasible: of a motion
            that begins or ends moving, of a duration or of times asked for; else empty.
    """

    slug = "timing-failed"
    title = "Timing failed"
    status = 422
    fields = ("position", "joint", "limit", "repairs", "nearest")
    added_fields = ("nearest",)

    def __init__(
        self,
        detail: str,
        *,
        position: float | None = None,
        joint: str | None = None,
        limit: str | None = None,
        repairs: Sequence[Mapping[str, Any]] = (),
        nearest: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(detail)
        self.position = position
        self.joint = joint
        self.limit = limit
        self.repairs = [dict(r) for r in repairs]
        self.nearest = dict(nearest or {})


class BudgetExceeded(NoPlan):
    """The time budget of the request ran out: its processor time, or a multiple in wall time.

    Attributes:
        stage: The stage that was running.
        budget_s: The budget [s].
        best: Best result so far (joint values of the waypoints solved), or None.
    """

    slug = "budget-exceeded"
    title = "Time budget exceeded"
    status = 422
    fields = ("stage", "budget_s", "best")

    def __init__(
        self, detail: str, *, stage: str, budget_s: float, best: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(detail)
        self.stage = stage
        self.budget_s = budget_s
        self.best = dict(best) if best is not None else None
