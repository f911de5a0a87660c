"""The five helices on the iiwa: least joint motion through exact waypoints."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import ikplan
from benchmarks.planning.measure import laid, median_seconds, pose_document
from benchmarks.speed.measure import Figure, FkClock
from ikplan.robots import load_robot

__all__ = ["BEST_KNOWN", "figures", "helix_request"]

START = np.radians([0.0, 30.0, 0.0, -90.0, 0.0, 60.0, 0.0])
BEST_KNOWN = {"A": 600.6, "B": 331.4, "C": 623.8, "D": 726.0, "E": 461.0}
"""First move and steps of the best solutions known [deg]."""
_ALL = tuple(range(20))
_INNER = tuple(k for k in _ALL if k not in (5, 18, 19))
_FLIPPED, _ACROSS = np.diag([-1.0, 1.0, -1.0]), np.diag([1.0, -1.0, -1.0])
_EQ_27 = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
_CASES: dict[str, tuple[float, np.ndarray, tuple[int, ...]]] = {
    "A": (0.2, _FLIPPED, _INNER),
    "B": (0.1, _FLIPPED, _ALL),
    "C": (0.2, _EQ_27, _ALL[1:18]),
    "D": (0.2, _ACROSS, _INNER),
    "E": (0.1, _ACROSS, _ALL),
}


def helix_request(name: str, seed: int = 0) -> dict[str, Any]:
    """Return the request of a helix, "A" to "E"."""
    radius, R, rows = _CASES[name]
    waypoints = []
    for k in rows:
        a = 4.0 * math.pi * k / 19.0
        p = [0.6 + radius * math.cos(a), radius * math.sin(a), 0.1 + 0.5 * k / 19.0]
        waypoints.append(pose_document(R, np.array(p)))
    return {
        "robot": "iiwa14",
        "scene": {"self_collision": False},
        "start": START.tolist(),
        "path": {"waypoints": waypoints},
        "ik": {"seed": seed},
    }


def figures(seeds: int) -> Iterator[Figure]:
    """Yield length against the best known, and times, of every helix."""
    robot = load_robot("iiwa14")
    clock = FkClock(robot)
    clock.tick()
    for name, best in BEST_KNOWN.items():
        plans = [ikplan.plan(helix_request(name, seed), robot=robot) for seed in range(seeds)]
        lengths = [math.degrees(plan.certificate.elongation_sum) for plan in plans]
        miss = max(plan.certificate.max_position_error or 0.0 for plan in plans)
        yield Figure(f"{name}: longest of {seeds} seeds", max(lengths), "deg", most=1.005 * best)
        yield Figure(f"{name}: shortest of them (known: {best:g})", min(lengths), "deg")
        yield Figure(f"{name}: largest miss of a waypoint", 1e3 * miss, "mm", most=1e-6)
        request = helix_request(name)
        chosen = min(median_seconds(partial(laid, request, robot), 7) for _ in range(3))
        whole = min(median_seconds(partial(ikplan.plan, request, robot=robot), 5) for _ in range(2))
        clock.tick()
        yield Figure(f"{name}: configurations chosen in", 1e3 * chosen, "ms", most=40.0)
        yield Figure(f"{name}: configurations chosen in", chosen / clock.seconds, "x FK")
        yield Figure(f"{name}: whole plan in", 1e3 * whole, "ms")
