"""Requests of the benchmark: eight waypoints, ur5 and iiwa14 by turns."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np

__all__ = ["request_lines"]

_WAYPOINTS = 8


def request_lines(count: int, seed: int = 0) -> Iterator[bytes]:
    """Yield requests, JSON, each another one.

    Args:
        count: How many.
        seed: Seed of the random numbers.
    """
    rng = np.random.default_rng(seed)
    centre = {"ur5": (0.4, 0.0, 0.4), "iiwa14": (0.55, 0.0, 0.5)}
    for k in range(count):
        robot = ("ur5", "iiwa14")[k % 2]
        begin = np.array(centre[robot]) + rng.uniform(-0.05, 0.05, 3)
        steps = rng.uniform(-0.03, 0.03, (_WAYPOINTS, 3))
        points = np.round(begin + np.cumsum(steps, axis=0), 5)
        waypoints = [{"position": point.tolist()} for point in points]
        yield json.dumps({"robot": robot, "path": {"waypoints": waypoints}}).encode() + b"\n"
