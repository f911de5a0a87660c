"""Single poses: 1,000 random reachable ones on each of five arms, from home."""

from __future__ import annotations

import functools
import statistics
from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan import IkSolution, Robot, Unreachable, load_robot, solve_ik

__all__ = ["SECTION"]

ROBOTS = ("panda", "ur5", "iiwa14", "xarm7", "z1")
METHODS = ("lm", "ik-ba")
MOST = {"iiwa14": 25.0, "panda": 30.0, "ur5": 35.0}
"""Largest median of the method lm in calls of the robot's own forward kinematics."""


def _errors(robot: Robot, solution: IkSolution, pose: pin.SE3) -> tuple[float, float] | None:
    """Distance [m] and rotation [rad] by Pinocchio; None where the limits are not kept."""
    q = np.asarray(solution.q)
    if (q < robot.lower).any() or (q > robot.upper).any():
        return None
    have = robot.fk(q)
    return (
        float(np.linalg.norm(have.translation - pose.translation)),
        float(np.linalg.norm(pin.log3(have.rotation.T @ pose.rotation))),
    )


def _study(name: str, method: str, count: int, repeats: int) -> Iterator[Figure]:
    robot = load_robot(name)
    rng = np.random.default_rng(2026)
    poses = [robot.fk(robot.random_configuration(rng)) for _ in range(count)]
    solve_ik(robot, poses[0], method=method)
    solved, worst_p, worst_r, evaluations = 0, 0.0, 0.0, []
    for pose in poses:
        try:
            solution = solve_ik(robot, pose, method=method)
        except Unreachable:
            continue
        errors = _errors(robot, solution, pose)
        if errors is None:
            continue
        solved += errors[0] <= 1e-6 and errors[1] <= 1e-6
        worst_p, worst_r = max(worst_p, errors[0]), max(worst_r, errors[1])
        evaluations.append(solution.evaluations)
    calls = [functools.partial(solve_ik, robot, pose, method=method) for pose in poses]
    ratio = FkClock(robot).ratio(calls, repeats)
    label = f"{name}, {method}"
    yield Figure(f"{label}: solved", 100.0 * solved / count, "%", least=100.0)
    yield Figure(f"{label}: worst position error", worst_p, "m", most=1e-6)
    yield Figure(f"{label}: worst orientation error", worst_r, "rad", most=1e-6)
    yield Figure(f"{label}: median evaluations", statistics.median(evaluations), "")
    yield Figure(
        f"{label}: median time of a solve",
        ratio,
        "x FK",
        most=MOST.get(name) if method == "lm" else None,
    )


def run(effort: float) -> list[Figure]:
    """Solve and time every pose."""
    count, repeats = max(20, int(1000 * effort)), max(1, round(5 * effort))
    return [f for m in METHODS for name in ROBOTS for f in _study(name, m, count, repeats)]


SECTION = Section("poses", "random reachable poses, solve_ik() from home, all included", run)
