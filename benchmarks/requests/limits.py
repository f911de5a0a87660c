"""Random limits and samplings."""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.robots import Robot

__all__ = ["random_limits", "random_sampling", "random_segment_limits"]

Draws = np.random.Generator
Document = dict[str, Any]


def random_segment_limits(rng: Draws, robot: Robot) -> Document:
    """Draw limits that a segment may have, most of them absent."""
    limits: Document = {}
    if rng.random() < 0.3:
        limits["velocity_scale"] = float(rng.uniform(0.05, 1.0))
    if rng.random() < 0.2:
        limits["acceleration_scale"] = float(rng.uniform(0.05, 1.0))
    if rng.random() < 0.1:
        limits["velocity"] = (robot.velocity_limit * rng.uniform(0.1, 1.2, robot.dof)).tolist()
        limits["velocity_lower"] = (
            -robot.velocity_limit * rng.uniform(0.1, 1.2, robot.dof)
        ).tolist()
    if rng.random() < 0.4:
        limits["tool_speed"] = _tool_rate(rng, (0.02, 0.5), (0.05, 3.0))
    if rng.random() < 0.25:
        limits["tool_acceleration"] = _tool_rate(rng, (0.2, 5.0), (0.5, 20.0))
    info = robot.info()
    if info.inertias_sourced and rng.random() < 0.25:
        known = bool((robot.effort_limit > 0.0).all())
        limits["torque"] = True if known else [float(rng.uniform(50, 300))] * robot.dof
        if rng.random() < 0.5:
            load = {"mass": float(rng.uniform(0.1, 3.0)), "position": [0.0, 0.02, 0.05]}
            limits["payload"] = load
    if rng.random() < 0.15:
        limits["jerk"] = float(rng.uniform(20, 500))
    return limits


def random_limits(rng: Draws, robot: Robot) -> Document:
    """Draw limits of a whole motion."""
    limits = random_segment_limits(rng, robot)
    if rng.random() < 0.15:
        limits["jerk"] = rng.uniform(20, 500, robot.dof).tolist()
    return limits


def random_sampling(rng: Draws) -> Document:
    """Draw a rate and a form of the samples."""
    return {
        "rate_hz": float(rng.choice([7.3, 50.0, 125.0, 250.0, 1000.0])),
        "form": str(rng.choice(["samples", "knots", "polynomial"])),
    }


def _tool_rate(
    rng: Draws, linear: tuple[float, float], angular: tuple[float, float]
) -> float | Document:
    of = float(rng.uniform(*linear))
    turn = float(rng.uniform(*angular))
    forms: list[float | Document] = [
        of,
        {"linear": of},
        {"angular": turn},
        {"linear": of, "angular": turn},
    ]
    return forms[int(rng.integers(len(forms)))]
