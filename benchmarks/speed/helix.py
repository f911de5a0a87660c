"""The helix of the demo, planned in-process after a warm-up."""

from __future__ import annotations

import json
import math
import statistics
import time
from pathlib import Path

from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan import Plan, load_robot, plan

__all__ = ["SECTION"]

REQUEST = json.loads(
    (Path(__file__).parents[2] / "examples" / "helix_iiwa14.json").read_text(encoding="utf-8")
)


def run(effort: float) -> list[Figure]:
    """Time the plan and its stages."""
    first = plan(REQUEST)
    blocks = []
    for _ in range(max(3, round(8 * effort))):
        plans: list[Plan] = []
        wall = []
        for _ in range(9):
            start = time.perf_counter()
            plans.append(plan(REQUEST))
            wall.append(time.perf_counter() - start)
        stages = {
            name: statistics.median(p.stats.seconds[name] for p in plans)
            for name in first.stats.seconds
        }
        blocks.append((statistics.median(wall), stages))
    # The least disturbed block of repeats.
    whole, stages = min(blocks, key=lambda block: block[0])
    clock = FkClock(load_robot("iiwa14"))
    ratio = clock.ratio([lambda: plan(REQUEST)] * 9, len(blocks))
    rest = whole - sum(stages.values())
    shares = {**stages, "documents and the rest": rest}
    certificate = first.certificate
    return [
        Figure("one plan, median", 1e3 * whole, "ms", most=60.0),
        *(Figure(f"  share of {n}", 100.0 * s / whole, "%") for n, s in shares.items()),
        Figure("one plan, in processor time", 1e3 * ratio * clock.seconds, "ms"),
        Figure("one plan, in processor time", ratio, "x FK"),
        Figure("evaluations of the IK", float(first.stats.ik_evaluations), ""),
        Figure("joint motion", math.degrees(certificate.elongation_sum), "deg", most=565.0),
        Figure("worst position error", certificate.max_position_error or 0.0, "m", most=1e-6),
        Figure("worst orientation error", certificate.max_orientation_error or 0.0, "rad", 1e-6),
    ]


SECTION = Section("helix", "plan() of examples/helix_iiwa14.json, 20 full poses, warm", run)
