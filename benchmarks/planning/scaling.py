"""A spline through 250 to 4,000 waypoints: the time is to grow linearly."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

import numpy as np

import ikplan
from benchmarks.planning.measure import laid, pose_document
from benchmarks.speed.measure import Figure
from ikplan.robots import load_robot

__all__ = ["COUNTS", "figures", "spline_request"]

COUNTS = (250, 500, 1000, 2000, 4000)


def spline_request(count: int, interpolation: str = "spline") -> dict[str, object]:
    """Return waypoints on a wavy ring of a fixed size, so that more of them are nearer together."""
    R = np.diag([1.0, -1.0, -1.0])
    waypoints = []
    for k in range(count):
        a = 4.0 * math.pi * k / (count - 1)
        p = [0.58 + 0.12 * math.cos(a), 0.12 * math.sin(a), 0.35 + 0.05 * math.sin(3.5 * a)]
        waypoints.append(pose_document(R, np.array(p)))
    return {
        "robot": "iiwa14",
        "scene": {"self_collision": False},
        "path": {
            "waypoints": waypoints,
            "interpolation": interpolation,
            "approach": "joint" if interpolation == "spline" else "path",
        },
        "budget_s": 300,
    }


def figures(share: float) -> Iterator[Figure]:
    """Yield the time for each number of waypoints, and the exponent of its growth."""
    robot = load_robot("iiwa14")
    counts = COUNTS if share >= 1.0 else COUNTS[: max(2, round(share * len(COUNTS)))]
    for interpolation in ("spline", "joint"):
        times = []
        for count in counts:
            request = spline_request(count, interpolation)
            begin = time.thread_time()
            laid(request, robot)
            times.append(time.thread_time() - begin)
            yield Figure(f"{interpolation}, {count} waypoints: laid in", times[-1], "s")
            begin = time.thread_time()
            plan = ikplan.plan(request, robot=robot)
            whole = time.thread_time() - begin
            assert plan.certificate.valid
            yield Figure(f"{interpolation}, {count} waypoints: whole plan", whole, "s")
        slope = float(np.polyfit(np.log(counts), np.log(times), 1)[0])
        yield Figure(f"{interpolation}: exponent of the growth of laying", slope, "", most=1.1)
