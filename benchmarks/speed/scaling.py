"""Paths of many waypoints: time and memory a waypoint, each planned in a process of its own."""

from __future__ import annotations

import json
import math
import subprocess
import sys

from benchmarks.speed.measure import Figure, Section

__all__ = ["SECTION"]

FK = 0.55e-6
"""One call of the forward kinematics where the goals were set [s]."""
COUNTS = (1_000, 4_000, 16_000)

_MEASURE = """
import json, resource, sys
import ikplan
from benchmarks.planning.scaling import spline_request
from benchmarks.speed.measure import FkClock, seconds_of
from benchmarks.speed.paths import polyline
from ikplan.robots import load_robot

def request(count):
    asked = polyline(count) if kind == "line" else spline_request(count)
    return {**asked, "budget_s": 3600}

def memory():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

kind, count = sys.argv[1], int(sys.argv[2])
clock = FkClock(load_robot("iiwa14"))
ikplan.plan(request(50))
before, asked = memory(), request(count)
clock.tick()
plans = []
seconds = seconds_of(lambda: plans.append(ikplan.plan(asked)))
clock.tick()
assert plans[0].certificate.valid
print(json.dumps([seconds / clock.seconds, memory() - before]))
"""


def run(effort: float) -> list[Figure]:
    """Plan each path once."""
    figures = []
    for kind in ("spline", "line"):
        counts = COUNTS if effort >= 1.0 else COUNTS[:2]
        ratios = []
        for count in counts:
            done = subprocess.run(
                [sys.executable, "-c", _MEASURE, kind, str(count)],
                check=True,
                capture_output=True,
                text=True,
            )
            ratio, memory = json.loads(done.stdout.splitlines()[-1])
            ratios.append(ratio)
            most = 0.2e-3 / FK if kind == "line" else 0.25e-3 / FK
            name = f"{kind} of {count:,}"
            figures.append(Figure(f"{name}, a waypoint", ratio / count, "x FK", most=most))
            figures.append(Figure(f"{name}, a waypoint", memory / count / 1e3, "kB", most=30.0))
        exponent = math.log(ratios[-1] / ratios[0]) / math.log(counts[-1] / counts[0])
        figures.append(Figure(f"{kind}, exponent of the growth", exponent, "", most=1.1))
    return figures


SECTION = Section(
    "scaling",
    "paths of 1,000 to 16,000 waypoints, passed, and with a stop at each: time and memory",
    run,
)
