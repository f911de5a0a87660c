"""Random straight lines of the UR5, held against a tracker of 4,000 steps."""

from __future__ import annotations

import collections
import statistics
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

import ikplan
from benchmarks.planning.measure import laid, pose_document
from benchmarks.speed.measure import Figure
from ikplan.errors import Disconnected, Unreachable
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target, pose_target
from ikplan.robots import Robot, load_robot

__all__ = ["figures", "free_figures", "line_request", "random_lines", "tracked"]

Array = NDArray[np.float64]
Line = tuple[Array, Array]
"""Start, shape (dof,), and position of the tool at the end, shape (3,)."""

LENGTH = 0.2
TOLERANCES = (5e-3, 1e-3, 1e-4, 1e-5)
STEPS = 4000
LARGEST_STEP = 0.1
"""Largest joint motion in one step of the tracker: a step is 0.05 mm [rad]."""


def random_lines(robot: Robot, count: int) -> list[Line]:
    """Return lines of 200 mm, starts uniform in +/-2.5 rad, directions uniform."""
    rng = np.random.default_rng(4)
    lines = []
    for _ in range(count):
        q = rng.uniform(-2.5, 2.5, robot.dof)
        d = rng.normal(size=3)
        lines.append((q, robot.fk(q).translation + LENGTH * d / np.linalg.norm(d)))
    return lines


def line_request(
    robot: Robot, line: Line, tolerance: float, *, free: bool = False
) -> dict[str, Any]:
    """Return the request of a line; with a free start, of the same line from any branch."""
    q, end = line
    T = robot.fk(q)
    waypoints = [pose_document(T.rotation, end)]
    if free:
        waypoints.insert(0, pose_document(T.rotation, T.translation))
    return {
        "robot": "ur5",
        "start": "free" if free else q.tolist(),
        "path": {
            "waypoints": waypoints,
            "interpolation": "line",
            "tolerance": {"position": tolerance, "orientation": max(10.0 * tolerance, 1e-3)},
        },
    }


@njit  # type: ignore[untyped-decorator]
def _track(chain: Chain, wanted: Target, end: Array, q: Array, lower: Array, upper: Array) -> int:
    """Lead q along the line in equal steps, in place; the number of steps that went well."""
    w = new_workspace(chain)
    before = np.empty(q.shape[0])
    for k in range(STEPS):
        before[:] = q
        p = wanted.p + (end - wanted.p) * ((k + 1.0) / STEPS)
        target = Target(wanted.R, p, True, wanted.weight, wanted.freedom)
        distance, angle, _ = refine(chain, target, q, lower, upper, Effort(30, 8), w)
        if distance > 1e-9 or angle > 1e-9 or np.abs(q - before).max() > LARGEST_STEP:
            return k
    return STEPS


def tracked(robot: Robot, line: Line) -> bool:
    """Whether small steps follow the line from its start.

    Each of 4,000 steps is solved to 1e-9 within the limits, without a jump.
    """
    arm, q = arm_of(robot), line[0].copy()
    T = robot.fk(q)
    begin = pose_target(T.translation, T.rotation)
    lower, upper = arm.search_bounds(q)
    return bool(_track(arm.chain, begin, line[1], q, lower, upper) == STEPS)


def _kind(reason: str) -> str:
    """What a reason speaks of, in a word."""
    kinds = {"singular:": "singularity", "limit": "joint limit", "reach": "reach"}
    return next((kind for word, kind in kinds.items() if word in reason), "no cause named")


def figures(count: int) -> Iterator[Figure]:
    """Yield what is solved at each tolerance, and what the tracker can follow."""
    robot = load_robot("ur5")
    lines = random_lines(robot, count)
    followed = np.array([tracked(robot, line) for line in lines])
    yield Figure(f"tracker of {STEPS} steps: lines followed of {count}", followed.sum(), "")
    for tolerance in TOLERANCES:
        name = f"{1e3 * tolerance:g} mm"
        times, solved, ratios = [], np.zeros(count, dtype=bool), [0.0]
        motion, verdicts = [0.0], collections.Counter[str]()
        for k, line in enumerate(lines):
            request = line_request(robot, line, tolerance)
            try:
                route = laid(request, robot)
            except (Unreachable, Disconnected) as error:
                verdicts[f"{type(error).__name__}, {_kind(error.reason)}"] += 1
                continue
            solved[k] = True
            motion.append(float(np.abs(np.diff(route.q, axis=0)).sum(axis=0).max()))
            begin = time.thread_time()
            plan = ikplan.plan(request, robot=robot)
            times.append(time.thread_time() - begin)
            assert plan.certificate.valid
            ratios.append((plan.certificate.max_path_deviation or 0.0) / tolerance)
        yield Figure(f"{name}: solved", solved.sum(), "", least=float(followed.sum()))
        lost = int((followed & ~solved).sum())
        yield Figure(f"{name}: followed by the tracker, refused by us", lost, "", most=0.0)
        yield Figure(f"{name}: largest deviation on the samples", max(ratios), "tol", most=1.0)
        yield Figure(
            f"{name}: whole plan, median",
            1e3 * statistics.median(times),
            "ms",
            most=15.0 if tolerance == 1e-4 else None,
        )
        yield Figure(f"{name}: longest way of one joint", max(motion), "rad")
        for verdict, number in sorted(verdicts.items()):
            yield Figure(f"{name}: refused: {verdict}", number, "")


def free_figures(count: int) -> Iterator[Figure]:
    """Yield what is solved at 0.1 mm when the line may begin in any branch."""
    robot = load_robot("ur5")
    times, motion, solved = [], [], 0
    for line in random_lines(robot, count):
        request = line_request(robot, line, 1e-4, free=True)
        begin = time.thread_time()
        try:
            route = laid(request, robot)
        except (Unreachable, Disconnected):
            continue
        times.append(time.thread_time() - begin)
        solved += 1
        motion.append(float(np.linalg.norm(np.diff(route.q, axis=0), axis=1).sum()))
    yield Figure(f"start free, 0.1 mm: solved of {count}", solved, "")
    yield Figure("start free, 0.1 mm: laid in, median", 1e3 * statistics.median(times), "ms")
    yield Figure("start free, 0.1 mm: joint motion, median", statistics.median(motion), "rad")
    yield Figure("start free, 0.1 mm: joint motion, largest", max(motion), "rad")
