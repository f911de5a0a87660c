"""Helices A to E with self-collision on, beside the same without: motion and time."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

import numpy as np

import ikplan
from benchmarks.planning.helices import BEST_KNOWN, helix_request
from ikplan.robots import load_robot

__all__ = ["HelixCost", "helix_costs"]


@dataclass(frozen=True)
class HelixCost:
    """What checking a helix costs.

    Attributes:
        name: "A" to "E".
        same: Whether the joint motion is the same, byte for byte.
        proven: Whether it is proven free.
        off: Median time of a plan without checks [ms].
        on: With self-collision on [ms].
    """

    name: str
    same: bool
    proven: bool
    off: float
    on: float


def helix_costs(repeats: int) -> list[HelixCost]:
    """Measure every helix, both ways in turn, by processor time."""
    robot = load_robot("iiwa14")
    found = []
    for name in BEST_KNOWN:
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
        found.append(
            HelixCost(
                name,
                bool(np.array_equal(plans[0].q, plans[1].q)),
                clearance is not None and clearance.proven,
                1e3 * statistics.median(times[0]),
                1e3 * statistics.median(times[1]),
            )
        )
    return found
