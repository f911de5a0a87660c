"""Arcs of 1 to 2.5 turns from a free start, held to a search of every branch and copy."""

from __future__ import annotations

import math
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
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target, pose_target
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.robots import Robot, load_robot

__all__ = ["ROBOTS", "arc_request", "figures", "goes_through", "random_arc"]

Array = NDArray[np.float64]
Arc = tuple[Array, Array, float, float]
"""Configuration at the begin, shape (dof,), axis, shape (3,), radius [m] and angle [rad]."""

ROBOTS = ("ur3", "ur5", "ur10", "xarm7", "iiwa14")
STEPS = 3000
RESTARTS = 600


def random_arc(robot: Robot, rng: np.random.Generator) -> Arc:
    """Return an arc about the axis of the tool, which turns with it."""
    low, high = np.maximum(robot.lower, -2.5), np.minimum(robot.upper, 2.5)
    q = rng.uniform(low, high)
    turns = rng.uniform(1.0, 2.5) * rng.choice([-1.0, 1.0])
    return q, robot.fk(q).rotation[:, 2], float(rng.uniform(0.01, 0.08)), 2.0 * math.pi * turns


def _poses(robot: Robot, arc: Arc, count: int) -> tuple[Array, Array]:
    """Rotations, shape (n, 3, 3), and positions, shape (n, 3) [m], of n = count + 1 places."""
    q, axis, radius, angle = arc
    T = robot.fk(q)
    K = np.array([np.cross(axis, e) for e in np.eye(3)]).T
    angles = np.linspace(0.0, angle, count + 1)[:, None, None]
    turn = np.eye(3) + np.sin(angles) * K + (1.0 - np.cos(angles)) * (K @ K)
    centre = T.translation - radius * T.rotation[:, 0]
    return turn @ T.rotation, centre + (turn @ (T.translation - centre)[:, None])[:, :, 0]


def arc_request(robot: Robot, arc: Arc) -> dict[str, Any]:
    """Return the request of an arc that may begin in any branch."""
    q, axis, radius, angle = arc
    T = robot.fk(q)
    circle = {
        "type": "arc",
        "centre": (T.translation - radius * T.rotation[:, 0]).tolist(),
        "axis": axis.tolist(),
        "angle": angle,
        "orientation": "follow",
    }
    path = {"begin": pose_document(T.rotation, T.translation), "segments": [circle]}
    scene = {"self_collision": False}
    return {"robot": robot.name, "start": "free", "path": path, "scene": scene, "budget_s": 120.0}


@njit  # type: ignore[untyped-decorator]
def _track(
    chain: Chain, first: Target, R: Array, p: Array, q: Array, lower: Array, upper: Array
) -> bool:
    """Lead q through poses, in place; whether each is met without a jump."""
    w = new_workspace(chain)
    before = np.empty(q.shape[0])
    for k in range(p.shape[0]):
        before[:] = q
        target = Target(R[k], p[k], True, first.weight, first.freedom)
        distance, angle, _ = refine(chain, target, q, lower, upper, Effort(30, 8), w)
        if distance > 1e-8 or angle > 1e-8 or np.abs(q - before).max() > 0.1:
            return False
    return True


def goes_through(robot: Robot, arc: Arc) -> bool:
    """Return whether any copy of any branch found gets along an arc in small steps."""
    arm, rng = arm_of(robot), np.random.default_rng(0)
    R, p = _poses(robot, arc, STEPS)
    begin = pose_target(p[0], R[0])
    w = new_workspace(arm.chain)
    lower, upper = arm.search_bounds(arc[0])
    rows: list[Array] = [arc[0]]
    for _ in range(RESTARTS):
        q = rng.uniform(np.maximum(lower, -math.pi), np.minimum(upper, math.pi))
        distance, angle, _ = refine(arm.chain, begin, q, lower, upper, Effort(40, 10), w)
        apart = min(float(np.abs(q - row).max()) for row in rows)
        if distance < 1e-9 and angle < 1e-9 and apart > 0.05:
            rows.append(q)
        if len(rows) == 24:
            break
    return any(
        _track(arm.chain, begin, R, p, np.ascontiguousarray(q), lower, upper)
        for q in with_equivalents(arm, np.array(rows))
    )


def figures(count: int, seed: int = 15, names: list[str] | None = None) -> Iterator[Figure]:
    """Yield which arcs go through, and which of these are refused."""
    for name in names or ROBOTS:
        robot, rng = load_robot(name), np.random.default_rng(seed)
        through = refused = planned = 0
        seconds: list[float] = []
        for _ in range(count):
            arc = random_arc(robot, rng)
            began = time.perf_counter()
            try:
                laid(arc_request(robot, arc), robot)
            except ikplan.NoPlan as error:
                judged = goes_through(robot, arc)
                refused += judged
                if judged:
                    print(f"  refused: {name}: {arc}: {error}", flush=True)
            else:
                judged = True
                planned += 1
            seconds.append(time.perf_counter() - began)
            through += judged
        yield Figure(f"{name}: arcs that go through, of {count}", through, "")
        yield Figure(f"{name}: planned", planned, "")
        yield Figure(
            f"{name}: refused, though a copy of a branch goes through", refused, "", most=0
        )
        yield Figure(f"{name}: median time", statistics.median(seconds), "s")
