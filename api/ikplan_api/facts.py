"""What is measured of a plan where it is made, small enough to travel beside it."""

from __future__ import annotations

from typing import NamedTuple

from ikplan.result import Plan

__all__ = ["PlanFacts", "facts_of"]

_RATIOS = {
    "position": "position_limit_ratio",
    "velocity": "velocity_limit_ratio",
    "acceleration": "acceleration_limit_ratio",
    "jerk": "jerk_limit_ratio",
    "torque": "torque_limit_ratio",
    "tool_speed": "tool_speed_ratio",
    "tool_acceleration": "tool_acceleration_ratio",
}


class PlanFacts(NamedTuple):
    """Figures of one plan.

    Attributes:
        stages: Seconds of each stage.
        margins: Share of each limit that the plan leaves unused, 0..1, as certified.
        waypoints: Number of waypoints.
        samples: Number of timed samples.
    """

    stages: dict[str, float]
    margins: dict[str, float]
    waypoints: int
    samples: int


def facts_of(plan: Plan) -> PlanFacts:
    """Return the figures of a plan."""
    ratios = {name: getattr(plan.certificate, field) for name, field in _RATIOS.items()}
    return PlanFacts(
        stages=dict(plan.stats.seconds),
        margins={name: 1.0 - ratio for name, ratio in ratios.items() if ratio is not None},
        waypoints=len(plan.waypoints.time),
        samples=len(plan.trajectory.time),
    )
