"""A dense tracker from many branches: whether the tool path of a request can be followed at all."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

import ikplan
from ikplan.ik.levenberg_marquardt import Effort, differentiate, refine, residual
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import ORIENTATION_WEIGHT, pose_target
from ikplan.path import JointLeg, Pose, ToolLeg, ToolPath, legs_of
from ikplan.pipeline.resolve import resolve_robot
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.task_freedom import counts_orientation, freedom_of
from ikplan.robots import Robot

__all__ = ["followed_from"]

Array = NDArray[np.float64]

STEPS = 3000
RESTARTS = 1500
BRANCHES = 64
JUMP = 0.1
"""Largest step of a joint from one of the places to the next [rad or m]."""
SHARE = 0.5
"""Of the tolerance, what the tracker may use."""


@njit  # type: ignore[untyped-decorator]
def _lead(
    chain: Chain,
    targets: Targets,
    q: Array,
    lower: Array,
    upper: Array,
    most: Array,
    damping: float,
) -> int:
    """Lead q through targets, in place; how many are met, within ``most`` [m, rad], in turn."""
    w = new_workspace(chain)
    dof, n = q.shape[0], len(targets.p)
    before, J = np.empty(dof), np.empty((6, dof))
    for k in range(n):
        before[:] = q
        target = target_at(targets, k)
        distance, angle, _ = refine(chain, target, q, lower, upper, Effort(30, 8), w)
        if distance < 1e-8 and angle < 1e-8 and np.abs(q - before).max() < JUMP:
            continue
        q[:] = before
        for _ in range(15):
            distance, angle, _ = residual(chain, target, q, w.e, w)
            if distance < 0.3 * most[0] and angle < 0.3 * most[1]:
                break
            differentiate(chain, target, w)
            for i in range(6):
                for d in range(dof):
                    J[i, d] = w.Jt[d, i]
            A = J @ J.T + damping * damping * np.eye(6)
            step = J.T @ np.linalg.solve(A, w.e.copy())
            for d in range(dof):
                q[d] = min(max(q[d] + step[d], lower[d]), upper[d])
        distance, angle, _ = residual(chain, target, q, w.e, w)
        if distance > most[0] or angle > most[1] or np.abs(q - before).max() > JUMP:
            return k
    return n


def _targets(path: ToolPath, request: ikplan.PlanRequest) -> Targets:
    s = np.linspace(0.0, path.length, STEPS)
    R, p = path.poses(s)
    oriented = path.orientation_mask(s) & counts_orientation(request.path)
    weight = np.where(oriented, ORIENTATION_WEIGHT, 0.0)
    return Targets(np.ascontiguousarray(R), np.ascontiguousarray(p), oriented, weight,
                   freedom_of(request.path))  # fmt: skip


def _branches(arm: Arm, targets: Targets, near: Array) -> Array:
    """Solutions of the first target from many restarts, and their full turns, shape (c, dof)."""
    rng = np.random.default_rng(0)
    w = new_workspace(arm.chain)
    lower, upper = arm.search_bounds(near)
    target = pose_target(
        targets.p[0], targets.R[0] if targets.oriented[0] else None, freedom=targets.freedom
    )
    rows: list[Array] = []
    for _ in range(RESTARTS):
        q = rng.uniform(np.maximum(lower, -math.pi), np.minimum(upper, math.pi))
        distance, angle, _ = refine(arm.chain, target, q, lower, upper, Effort(40, 10), w)
        if distance > 1e-9 or angle > 1e-9:
            continue
        if not rows or min(float(np.abs(q - row).max()) for row in rows) > 0.05:
            rows.append(q)
        if len(rows) == BRANCHES:
            break
    return with_equivalents(arm, np.array(rows)) if rows else np.empty((0, arm.dof))


def followed_from(
    document: ikplan.PlanRequest, robot: Robot | None = None
) -> tuple[Array | None, float] | None:
    """Return where the arm follows the tool path of a request from, and how far it gets at most.

    Args:
        document: The request.
        robot: The robot; None: that of the request.

    Returns:
        The configuration at the begin, shape (dof,) [rad or m], None where none is found, and the
        share of the path that is followed; None: the path has no tool path, or more than one.
    """
    robot = resolve_robot(document, robot)
    arm = arm_of(robot)
    free = document.start == "free"
    given = robot.home if document.start in (None, "free") else document.start
    q_start = np.array(given, dtype=float)

    def fk(q: Array) -> tuple[Array, Array]:
        T = robot.fk(q)
        return T.rotation, T.translation

    legs = legs_of(document.path, None if free else Pose(*fk(q_start)), fk, "none")
    tool = [k for k, leg in enumerate(legs) if isinstance(leg, ToolLeg)]
    if len(tool) != 1:
        return None
    leg = legs[tool[0]]
    assert isinstance(leg, ToolLeg)
    targets = _targets(leg.path, document)
    before = legs[tool[0] - 1] if tool[0] > 0 else None
    if isinstance(before, JointLeg) and before.waypoints[-1].q is not None:
        starts = np.array(before.waypoints[-1].q, dtype=float)[None]
    elif before is None and not free:
        starts = q_start[None]
    else:
        starts = _branches(arm, targets, q_start)
    lower, upper = arm.search_bounds(q_start)
    tolerance = document.path.tolerance
    most = SHARE * np.array([tolerance.position, tolerance.orientation])
    farthest = 0
    for start in starts:
        for damping in (1e-4, 1e-3):
            q = np.ascontiguousarray(start)
            met = _lead(arm.chain, targets, q.copy(), lower, upper, most, damping)
            farthest = max(farthest, met)
            if met == STEPS:
                return start, 1.0
    return None, farthest / STEPS
