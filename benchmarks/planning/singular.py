"""Lines aimed at singularities, held against a damped tracker that stays within the tolerance."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan
from benchmarks.planning.measure import pose_document
from benchmarks.speed.measure import Figure
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.within.window_kernels import linearised_errors
from ikplan.robots import Robot, load_robot

__all__ = ["aimed_line", "figures", "passes"]

Array = NDArray[np.float64]

SINGULAR_JOINTS = {"ur5": (4, 2), "panda": (5, 3), "iiwa14": (5, 3, 1)}
"""Joints that make each arm singular where they are 0 or straight: wrist, elbow, shoulder."""
STRAIGHT = {("panda", 5): 0.0, ("panda", 3): -0.0698}
POSITION, ORIENTATION = 1e-4, 1e-3
"""The default tolerance [m, rad]."""
HALF = 0.08
STEPS = 1600
_TELL = 10
"""After how many lines what has come out so far is printed."""


def aimed_line(
    robot: Robot, rng: np.random.Generator, steps: int = STEPS
) -> tuple[Array, Array, float] | None:
    """Return a start, shape (dof,), the end of a line, and how near to a singularity it passes.

    None: the arm cannot be led from the singularity back to the begin of the line.
    """
    joint = int(rng.choice(SINGULAR_JOINTS[robot.name]))
    off = float(10.0 ** rng.uniform(-6.0, -2.0))
    margin = 0.15 * (robot.upper - robot.lower)
    low = np.maximum(robot.lower + margin, -2.5)
    high = np.minimum(robot.upper - margin, 2.5)
    q = rng.uniform(low, high)
    q[joint] = STRAIGHT.get((robot.name, joint), 0.0) + off * rng.choice([-1.0, 1.0])
    q[joint] = np.clip(q[joint], robot.lower[joint], robot.upper[joint])
    d = rng.normal(size=3)
    d *= HALF / np.linalg.norm(d)
    T = robot.fk(q)
    begin = _led(robot, q, T.rotation, np.linspace(T.translation, T.translation - d, steps), 1.0)
    if begin is None:
        return None
    return begin, T.translation + d, off


def _led(robot: Robot, q: Array, R: Array, points: Array, damping: float) -> Array | None:
    """Lead the arm through points, damped; the last configuration, None where it leaves them."""
    arm, q = arm_of(robot), q.copy()
    one = np.ones(1, dtype=bool)
    for p in points:
        before = q
        targets = Targets(
            np.ascontiguousarray(R[None]), p[None], one, 0.1 * one.astype(float), no_freedom()
        )
        for _ in range(12):
            e, J = linearised_errors(arm.chain, targets, q[None])
            if np.linalg.norm(e) < 1e-12:
                break
            A = J[0] @ J[0].T + (damping * 2e-4) ** 2 * np.eye(6)
            step = J[0].T @ np.linalg.solve(A, e[0])
            q = np.clip(q + step, arm.lower, arm.upper)
            if np.linalg.norm(e[0, :3]) < 0.3 * POSITION and np.linalg.norm(e[0, 3:]) < 0.03e-3:
                break
        if np.linalg.norm(e[0, :3]) > POSITION or np.linalg.norm(e[0, 3:]) > 0.1 * ORIENTATION:
            return None
        if np.abs(q - before).max() > 48.0 / len(points):
            return None
    return q


def passes(robot: Robot, start: Array, R: Array, end: Array, steps: int = STEPS) -> bool:
    """Return whether a damped tracker gets along a line within the tolerance."""
    points = np.linspace(robot.fk(start).translation, end, steps)
    return any(_led(robot, start, R, points, damping) is not None for damping in (0.3, 1.0, 3.0))


def line_request(robot: Robot, start: Array, R: Array, end: Array) -> dict[str, Any]:
    """Return the request of a line from a start."""
    return {
        "robot": robot.name,
        "start": start.tolist(),
        "path": {"segments": [{"type": "line", "to": pose_document(R, end)}]},
        "scene": {"self_collision": False},
        "limits": {"jerk": False},
        "budget_s": 60.0,
    }


def figures(count: int, seed: int = 15, names: list[str] | None = None) -> Iterator[Figure]:
    """Yield what of random lines past singularities is planned."""
    for name in names or SINGULAR_JOINTS:
        robot, rng = load_robot(name), np.random.default_rng(seed)
        tried = passed = refused = planned = 0
        seconds: list[float] = []
        worst = 0.0
        while tried < count:
            line = aimed_line(robot, rng)
            if line is None:
                continue
            start, end, off = line
            R = robot.fk(start).rotation
            judged = passes(robot, start, R, end)
            began = time.perf_counter()
            tried += 1
            passed += judged
            try:
                plan = ikplan.plan(line_request(robot, start, R, end))
                planned += 1
                worst = max(worst, plan.certificate.max_path_deviation or 0.0)
            except ikplan.NoPlan as error:
                refused += judged
                if judged:
                    print(
                        f"  refused: {name}, {off:.2e} off, {start.tolist()}: {error}", flush=True
                    )
            seconds.append(time.perf_counter() - began)
            if tried % _TELL == 0 and tried < count:
                print(
                    f"  {name}: {tried} of {count}, the judge passes {passed}, of these "
                    f"{refused} refused; {planned} planned",
                    flush=True,
                )
        yield Figure(f"{name}: lines that the judge passes, of {tried}", passed, "")
        yield Figure(f"{name}: of these refused", refused, "", most=0)
        yield Figure(f"{name}: planned", planned, "")
        yield Figure(f"{name}: median time", statistics.median(seconds), "s")
        yield Figure(f"{name}: largest deviation", worst * 1e3, "mm")
