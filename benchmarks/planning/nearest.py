"""The nearest solution to 500 random poses from mid-range, against a much larger search."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator

import numpy as np

from benchmarks.speed.measure import Figure
from ikplan import solve_ik
from ikplan.ik.nearest_solutions import nearest_solutions
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.robots import load_robot

__all__ = ["ROBOTS", "figures"]

ROBOTS = ("panda", "ur5", "iiwa14")
_SEEDS, _SLIDES = 400, 60
"""Of the larger search; the planner's own has a few dozen."""


def figures(count: int) -> Iterator[Figure]:
    """Yield the share within 1 % of the best known, and the time, of each robot."""
    for name in ROBOTS:
        robot = load_robot(name)
        arm = arm_of(robot)
        middle = 0.5 * (robot.lower + robot.upper)
        rng = np.random.default_rng(500)
        times, near = [], 0
        for k in range(count):
            T = robot.fk(robot.random_configuration(rng))
            begin = time.thread_time()
            found = solve_ik(robot, T, start=middle)
            times.append(time.thread_time() - begin)
            lower, upper = arm.search_bounds(middle)
            solutions, errors = np.empty((_SLIDES, arm.dof)), np.full((_SLIDES, 3), np.inf)
            number, _ = nearest_solutions(
                arm.chain,
                pose_target(T.translation, T.rotation),
                middle[None],
                _SEEDS,
                (0.1 + 0.618 * k) % 1.0,
                middle,
                lower,
                upper,
                1e-6,
                1e-6,
                _SLIDES,
                solutions,
                errors,
            )
            best = min(errors[0, 2] if number else np.inf, found.elongation)
            near += found.elongation <= 1.01 * best
        share = 100.0 * near / count
        yield Figure(f"{name}: within 1 % of the best known", share, "%", least=99.0)
        yield Figure(f"{name}: solved in, median", 1e3 * statistics.median(times), "ms", most=2.0)
