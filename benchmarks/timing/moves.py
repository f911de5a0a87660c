"""Jerk-limited moves along straight lines: distance from the optimum, and from ruckig's."""

from __future__ import annotations

import importlib
import math
import statistics
import time
from typing import Any

import numpy as np

from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.timing import time_joint_path

__all__ = ["moves_study"]


def _shortest(distance: float, v: float, up: float, down: float, jerk: float) -> float:
    """Return the least duration from rest to rest [s], the peak speed found by bisection."""

    def turning(peak: float) -> float:
        return sum(
            peak / a + a / jerk if peak * jerk >= a * a else 2.0 * math.sqrt(peak / jerk)
            for a in (up, down)
        )

    if 0.5 * v * turning(v) <= distance:
        return 0.5 * turning(v) + distance / v
    low, high = 0.0, v
    for _ in range(200):
        middle = 0.5 * (low + high)
        if 0.5 * middle * turning(middle) < distance:
            low = middle
        else:
            high = middle
    return turning(high)


def _ruckig() -> Any:
    """Return the module ruckig, or None where it is not installed: it is compared with only."""
    try:
        return importlib.import_module("ruckig")
    except ModuleNotFoundError:
        return None


def _ruckig_duration(module: Any, q: np.ndarray, limits: JointLimits) -> float:
    """Return the duration of ruckig's motion of one joint from rest to rest [s]."""
    wanted = module.InputParameter(1)
    wanted.current_position, wanted.target_position = [0.0], [float(q[0])]
    assert limits.jerk is not None
    wanted.max_velocity = limits.velocity.tolist()
    wanted.max_acceleration = limits.acceleration.tolist()
    wanted.min_acceleration = limits.acceleration_lower.tolist()
    wanted.max_jerk = limits.jerk.tolist()
    found = module.Trajectory(1)
    module.Ruckig(1).calculate(wanted, found)
    return float(found.duration)


def moves_study(count: int, joints: int) -> None:
    """Time random straight moves under jerk limits and print how far they are from the optimum.

    Args:
        count: Number of moves.
        joints: Number of joints.
    """
    module = _ruckig() if joints == 1 else None
    over, seconds, excess, beside = [], [], -1.0, []
    for i in range(count):
        rng = np.random.default_rng([4, joints, i])
        v, up, down, jerk = (
            np.exp(rng.uniform(np.log(low), np.log(high), joints))
            for low, high in ((0.3, 5.0), (2.0, 30.0), (2.0, 30.0), (10.0, 1000.0))
        )
        box = np.full(joints, 1e6)
        names = tuple(f"joint{k}" for k in range(joints))
        limits = JointLimits(-box, box, v, up, names, -v, -down, jerk)
        q = np.exp(rng.uniform(-5.0, 2.0, joints)) * rng.choice([-1.0, 1.0], joints)
        start = time.process_time()
        timed = time_joint_path(JointPath.through([0.0 * q, q], limits), limits)
        seconds.append(time.process_time() - start)
        way, ahead = np.abs(q), q > 0.0
        best = _shortest(
            1.0,
            float((v / way).min()),
            float((np.where(ahead, up, down) / way).min()),
            float((np.where(ahead, down, up) / way).min()),
            float((jerk / way).min()),
        )
        over.append(timed.duration / best - 1.0)
        t = np.append(np.arange(0.0, timed.duration, 1e-4), timed.duration)
        _, dq, ddq = timed.evaluate(t)
        change = np.abs(np.diff(ddq, axis=0))[:-1] * 1e4 / jerk
        used = [(np.abs(dq) / v).max(), (ddq / up).max(), (-ddq / down).max(), change.max()]
        excess = max(excess, float(max(used)) - 1.0)
        if module is not None:
            beside.append(timed.duration / _ruckig_duration(module, q, limits) - 1.0)
    over.sort()
    least, median, worst = (100.0 * over[k] for k in (0, count // 2, -1))
    print(
        f"  {count} moves of {joints} joint(s), over the closed form: {median:.1e} % (median) "
        f"{worst:.1e} % (worst) {least:.1e} % (least)"
    )
    cost = 1e3 * statistics.median(seconds)
    print(f"    greatest excess at 10 kHz {excess:.1e}; processor time a move {cost:.1f} ms")
    if beside:
        print(
            f"    over ruckig {100 * max(beside):.1e} % (worst) {100 * min(beside):.1e} % (least)"
        )
