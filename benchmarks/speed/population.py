"""IK-BA as in its paper: 50 bats, 200 iterations, one waypoint of the iiwa."""

from __future__ import annotations

import numpy as np

from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan import IkSolution, load_robot, solve_ik

__all__ = ["SECTION"]


def run(effort: float) -> list[Figure]:
    """Time the search, solve_ik() included."""
    robot = load_robot("iiwa14")
    position = robot.fk(np.array(robot.home)).translation + np.array([0.05, 0.1, -0.1])

    def solve() -> IkSolution:
        return solve_ik(robot, position, population="paper", iterations="paper", refine=False)

    first = solve()
    ratio = FkClock(robot).ratio([solve] * 9, max(3, round(10 * effort)))
    return [
        Figure("evaluations", float(first.evaluations), "", most=10_050, least=10_050),
        Figure("position error of the raw search", first.position_error, "m"),
        Figure("one search, all included", ratio, "x FK", most=15_000),
    ]


SECTION = Section("ik-ba", "IK-BA, 50 bats, 200 iterations, one position on the iiwa", run)
