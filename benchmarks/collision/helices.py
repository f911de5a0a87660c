"""Helices A to E with self-collision on, beside the same without: motion and time."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import ikplan
from benchmarks.planning.helices import BEST_KNOWN, helix_request
from ikplan.collision.checker import CollisionChecker
from ikplan.robots import load_robot
from ikplan.scene.model import collision_model

__all__ = ["HelixCost", "helix_costs"]


@dataclass(frozen=True)
class HelixCost:
    """What checking a helix costs.

    Attributes:
        name: "A" to "E".
        same: Whether the joint motion is the same, byte for byte.
        contact: Bodies that touch in the motion without checks, or None.
        proven: Whether it is proven free.
        off: Median time of a plan without checks [ms].
        on: With self-collision on [ms].
    """

    name: str
    same: bool
    contact: tuple[str, str] | None
    proven: bool
    off: float
    on: float


def helix_costs(repeats: int, names: Sequence[str] = tuple(BEST_KNOWN)) -> list[HelixCost]:
    """Measure helices, both ways in turn, by processor time.

    Args:
        repeats: How often each is timed; 0: not.
        names: Which.
    """
    robot = load_robot("iiwa14")
    checker = CollisionChecker(robot, collision_model(robot))
    found = []
    for name in names:
        off = helix_request(name)
        on = {key: value for key, value in off.items() if key != "scene"}
        times: tuple[list[float], list[float]] = ([], [])
        plans = [ikplan.plan(request, robot=robot) for request in (off, on)]
        for _ in range(repeats):
            for row, request in zip(times, (off, on), strict=True):
                begin = time.thread_time()
                ikplan.plan(request, robot=robot)
                row.append(time.thread_time() - begin)
        clearance = plans[1].certificate.clearance
        contact = checker.first_contact(plans[0].q)
        found.append(
            HelixCost(
                name,
                bool(np.array_equal(plans[0].q, plans[1].q)),
                None if contact is None else contact.pair,
                clearance is not None and clearance.proven,
                1e3 * statistics.median(times[0] or [0.0]),
                1e3 * statistics.median(times[1] or [0.0]),
            )
        )
    return found
