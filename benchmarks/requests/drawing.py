"""Random requests, each told by its seed and number."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.requests.curves import random_curves
from benchmarks.requests.limits import random_limits, random_sampling
from benchmarks.requests.paths import random_joint_path, random_path
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.robots import Robot, load_robot

__all__ = ["KINDS", "draw"]

KINDS = ("plan", "timing", "curve")


@functools.cache
def _robot(name: str) -> Robot:
    return load_robot(name)


def draw(
    kind: str, seed: int, number: int, budget_s: float, robots: Sequence[str] | None = None
) -> dict[str, Any]:
    """Draw a request.

    Args:
        kind: "plan", "timing" for that of a joint path, or "curve" for a plan along named curves.
        seed: Which series.
        number: Which of it.
        budget_s: Its time budget [s].
        robots: Names of the robots to draw from; None: the reference robots.

    Returns:
        The request document.
    """
    rng = np.random.default_rng([KINDS.index(kind), seed, number])
    names = REFERENCE_ROBOTS if robots is None else robots
    name = names[int(rng.integers(len(names)))]
    robot = _robot(name)
    request: dict[str, Any] = {"robot": name, "budget_s": budget_s}
    if kind == "timing":
        request |= random_joint_path(rng, robot)
    else:
        q = robot.random_configuration(rng)
        free = bool(rng.random() < 0.25)
        request["start"] = "free" if free else q.tolist()
        request["path"] = (
            random_path(rng, robot, q, free)
            if kind == "plan"
            else random_curves(rng, robot, robot.fk(q), free)
        )
        ik: dict[str, Any] = {"method": "lm"} if rng.random() < 0.5 else {}
        if rng.random() < 0.2:
            ik["elongation"] = "greedy"
        request["ik"] = ik
        # Random starts touch themselves often: contact is studied by benchmarks of its own.
        request["scene"] = {"self_collision": False}
    request["limits"] = random_limits(rng, robot)
    if rng.random() < 0.5:
        request["sampling"] = random_sampling(rng)
    if rng.random() < 0.2:
        request["tool"] = {"position": [0.05, -0.02, 0.1]}
    return request
