"""Lines and helices, planned in-process: what is solved, and what is refused."""

from __future__ import annotations

import functools
from typing import Any

import ikplan
from benchmarks.peers.lines import requests
from benchmarks.planning.helices import BEST_KNOWN, helix_request
from benchmarks.planning.lines import line_request, random_lines
from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan.errors import IkplanError
from ikplan.robots import load_robot

__all__ = ["SECTION"]

FK = 0.55e-6
"""One call of the forward kinematics where the goals were set [s]."""
TOLERANCE = 1e-3


def _try(request: dict[str, Any]) -> str | None:
    """Plan a request; the name of its refusal, None where there is a plan."""
    try:
        ikplan.plan(request)
    except IkplanError as refusal:
        return type(refusal).__name__
    return None


def run(effort: float) -> list[Figure]:
    """Time lines of the UR5 that are planned and lines that are refused."""
    robot = load_robot("ur5")
    clock, figures = FkClock(robot), []
    repeats = max(1, round(3 * effort))
    for tolerance, goal in ((1e-3, 4.5e-3), (1e-4, 5e-3)):
        planned = requests(robot, max(3, round(20 * effort)), tolerance)
        calls = [functools.partial(ikplan.plan, request) for request in planned]
        calls[0]()
        name = f"line of 200 mm, {1e3 * tolerance:g} mm"
        figures.append(Figure(name, clock.ratio(calls, repeats), "x FK", most=goal / FK))
    lines = random_lines(robot, max(20, round(100 * effort)))
    asked = [line_request(robot, line, TOLERANCE) for line in lines]
    refused = [request for request in asked if _try({**request, "repairs": 0})]
    for name, repairs in (("no", 0), ("the cheapest", 1), ("all", None)):
        tries = [functools.partial(_try, {**r, "repairs": repairs}) for r in refused]
        most = 30e-3 / FK if repairs == 0 else None
        ratio = clock.ratio(tries, 1)
        figures.append(Figure(f"refused line, {name} repairs", ratio, "x FK", most=most))
    clock = FkClock(load_robot("iiwa14"))
    for name in BEST_KNOWN:
        call = functools.partial(ikplan.plan, helix_request(name))
        call()
        figures.append(
            Figure(f"helix {name}", clock.ratio([call] * 9, repeats), "x FK", 15e-3 / FK)
        )
    return figures


SECTION = Section("lines", "lines of the UR5, planned and refused, and helices of 20 poses", run)
