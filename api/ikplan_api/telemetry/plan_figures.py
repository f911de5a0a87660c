"""Figures of a plan for metrics and traces, small enough to travel with the plan."""

from __future__ import annotations

from typing import NamedTuple

from ikplan.plans.plan import Plan

__all__ = ["PlanFigures", "figures_of"]

_RATIOS = {
    "position": "position_limit_ratio",
    "velocity": "velocity_limit_ratio",
    "acceleration": "acceleration_limit_ratio",
    "jerk": "jerk_limit_ratio",
    "torque": "torque_limit_ratio",
    "tool_speed": "tool_speed_ratio",
    "tool_acceleration": "tool_acceleration_ratio",
}


class PlanFigures(NamedTuple):
    """Figures of one plan.

    Attributes:
        stages: Duration of each stage [s].
        margins: Share of each limit that the certified plan leaves unused, 0..1.
        waypoints: Number of waypoints.
        samples: Number of timed samples.
    """

    stages: dict[str, float]
    margins: dict[str, float]
    waypoints: int
    samples: int


def figures_of(plan: Plan) -> PlanFigures:
    """Return the figures of a plan."""
    ratios = {name: getattr(plan.certificate, field) for name, field in _RATIOS.items()}
    return PlanFigures(
        stages=dict(plan.stats.seconds),
        margins={name: 1.0 - ratio for name, ratio in ratios.items() if ratio is not None},
        waypoints=len(plan.waypoints.time),
        samples=len(plan.trajectory.time),
    )
