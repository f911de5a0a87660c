"""The trajectories of E9 on the EOD arm: joints through 200 poses, and a free axis."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import ikplan
from benchmarks.papers.li_paths import EQ_47, path_case, path_points
from benchmarks.planning.measure import pose_document
from benchmarks.speed.measure import Figure
from ikplan.errors import Unreachable
from ikplan.robots import load_robot

__all__ = ["NAMES", "e9_request", "figures"]

NAMES = ("1", "2", "3", "4", "3+")


def e9_request(name: str, free: Any = None) -> dict[str, Any]:
    """Return the request of a trajectory; free: what of the orientation is."""
    return {
        "robot": "eod_arm",
        "scene": {"self_collision": False},
        "path": {
            "waypoints": [pose_document(EQ_47, p) for p in path_points(name)],
            "orientation_free": free,
            # Point 66 of trajectory 4 is out of reach by less than the default tolerance.
            "tolerance": {"position": 1e-6, "orientation": 1e-6},
        },
        "budget_s": 600,
    }


def figures(names: tuple[str, ...] = NAMES) -> Iterator[Figure]:
    """Yield the points named unreachable with the full pose, and what freedom solves."""
    robot = load_robot("eod_arm")
    for name in names:
        reachable = path_case(name).reachable
        try:
            ikplan.plan(e9_request(name), robot=robot)
            named: set[int] = set()
        except Unreachable as verdict:
            named = {int(row["waypoint"]) for row in verdict.waypoints}
        out = {k for k in range(len(reachable)) if not reachable[k]}
        yield Figure(f"{name}, full pose: points named unreachable", len(named), "")
        yield Figure(
            f"{name}, full pose: not those of the closed form", len(named ^ out), "", most=0
        )
        for words, free in (
            ("tool_x free", {"about": "tool_x"}),
            ("tool_y free", {"about": "tool_y"}),
            ("tool_z free", {"about": "tool_z"}),
            ("position only", "all"),
        ):
            begin = time.thread_time()
            try:
                plan = ikplan.plan(e9_request(name, free), robot=robot)
            except Unreachable as verdict:
                number = len(verdict.waypoints)
                yield Figure(f"{name}, {words}: points named unreachable", number, "")
                continue
            yield Figure(f"{name}, {words}: joint motion", plan.certificate.elongation_sum, "rad")
            yield Figure(f"{name}, {words}: planned in", time.thread_time() - begin, "s")
