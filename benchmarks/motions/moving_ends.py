"""Random moving starts and ends over six robots, jerk limited or not."""

from __future__ import annotations

import time
from collections import Counter

import numpy as np
from numpy.typing import NDArray

import ikplan

__all__ = ["study"]

Array = NDArray[np.float64]

_ROBOTS = ("ur5", "iiwa14", "panda", "ur10", "xarm7", "kuka_kr6_r700_sixx")
_JERKS: tuple[float | bool | None, ...] = (False, None, 30.0, 100.0, 500.0)
_MET = 1e-9


def study(count: int, seed: int) -> int:
    """Time random waypoints with random velocities at their ends and print what came out.

    Args:
        count: How many.
        seed: Seed of every random choice.

    Returns:
        How many broke a promise: not certified, a velocity not met, or a nearest one that is not
        feasible either.
    """
    rng = np.random.default_rng(seed)
    seen: Counter[str] = Counter()
    worst, spent = 0.0, []
    for k in range(count):
        robot = ikplan.load_robot(_ROBOTS[k % len(_ROBOTS)])
        waypoints, start, end = _drawn(robot, rng)
        jerk = _JERKS[int(rng.integers(len(_JERKS)))]
        begin = time.process_time()
        try:
            plan = _timed(robot, waypoints, jerk, start, end)
            seen["as asked"] += 1
        except ikplan.TimingFailed as refused:
            seen["refused"] += 1
            start = np.array(refused.nearest.get("start_velocity", 0.0 * start))
            end = np.array(refused.nearest.get("end_velocity", 0.0 * end))
            try:
                plan = _timed(robot, waypoints, jerk, start, end)
            except ikplan.IkplanError as error:
                seen["broken"] += 1
                print(f"{k}: the nearest of {robot.name} is not feasible: {error}")
                continue
        except ikplan.IkplanError as error:
            seen["broken"] += 1
            print(f"{k}: {robot.name}: {type(error).__name__}: {error}")
            continue
        spent.append(time.process_time() - begin)
        off = max(np.abs(plan.dq[0] - start).max(), np.abs(plan.dq[-1] - end).max())
        worst = max(worst, float(off))
        if off > _MET or not plan.certificate.valid:
            seen["broken"] += 1
            print(f"{k}: {robot.name}: velocities off by {off:.1e}")
    print(
        f"{count} motions: {dict(seen)}; velocities off by {worst:.1e} at most; processor time "
        f"{np.median(spent):.2f} s in the median, {np.max(spent):.1f} s at most"
    )
    return seen["broken"]


def _drawn(robot: ikplan.Robot, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    n = int(rng.integers(2, 6))
    if rng.random() < 0.5:
        waypoints = rng.uniform(low, high, (n, robot.dof))
    else:
        steps = np.cumsum(rng.normal(0.0, 0.25, (n, robot.dof)), axis=0)
        waypoints = np.clip(steps + 0.5 * (low + high), low, high)
    share = float(rng.choice([0.3, 0.7, 1.0]))
    start, end = share * rng.uniform(-1.0, 1.0, (2, robot.dof)) * robot.velocity_limit
    which = rng.random()
    if which < 0.3:
        end[:] = 0.0
    elif which < 0.5:
        start[:] = 0.0
    return waypoints, start, end


def _timed(
    robot: ikplan.Robot, waypoints: Array, jerk: float | bool | None, start: Array, end: Array
) -> ikplan.Plan:
    limits = {"jerk": jerk}
    return ikplan.time_path(robot, waypoints, limits=limits, start_velocity=start, end_velocity=end)
