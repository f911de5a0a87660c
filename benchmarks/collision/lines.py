"""Lines of the UR5 beside boxes: planned wherever a dense search over branches finds a way."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin
from numba import njit
from numpy.typing import NDArray

import ikplan
from benchmarks.collision.drawing import rotation
from benchmarks.collision.oracle import Oracle
from benchmarks.planning.lines import Line, line_request, random_lines
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.errors import IkplanError, InCollision
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.target import Target, pose_target
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.robots import Robot
from ikplan.scene.model import collision_model

__all__ = ["LineStudy", "boxed_lines", "line_study"]

Array = NDArray[np.float64]
Boxes = list[dict[str, Any]]

BOXES = 5
BESIDE = 0.45
"""How far the middle of a box is from that of its line along each axis, at most [m]."""
STEPS = 4000
LOOKED_AT = 250
"""Places of a line at which the dense search looks for contact."""
SLACK = 1e-3
"""Distance from which on the dense search calls a place free [m]."""
TOLERANCE = 1e-3


@dataclass
class LineStudy:
    """What became of the lines.

    Attributes:
        free: Lines for which the dense search finds a free tracking.
        planned: Lines planned and proven.
        lost: Lines that it finds one for and that are refused, in words.
        held: Lines that are followed, but in contact in every branch.
        named: Refused ones of them whose verdict names the pair.
        unnamed: The others, in words.
        found: Lines planned and proven for which the dense search finds no way.
    """

    free: int = 0
    planned: int = 0
    held: int = 0
    named: int = 0
    found: int = 0
    lost: list[str] = field(default_factory=list)
    unnamed: list[str] = field(default_factory=list)


def boxed_lines(robot: Robot, count: int, seed: int = 0) -> list[tuple[Line, Boxes]]:
    """Return lines whose start is free, each beside boxes of its own.

    Lines of the planning benchmark whose start touches itself are left out.
    """
    rng = np.random.default_rng(seed)
    found = []
    alone = Oracle(robot, collision_model(robot))
    for line in random_lines(robot, 2 * count):
        if alone.distances(line[0]).min() <= 2.0 * SLACK:
            continue
        boxes: Boxes = []
        middle = 0.5 * (robot.fk(line[0]).translation + line[1])
        while len(boxes) < BOXES:
            turn = pin.Quaternion(rotation(rng)).coeffs()
            box = {
                "name": f"box {len(boxes)}",
                "shape": {"type": "box", "size": rng.uniform(0.05, 0.4, 3).tolist()},
                "position": (middle + rng.uniform(-BESIDE, BESIDE, 3)).tolist(),
                "quaternion_xyzw": turn.tolist(),
            }
            scene = parse(Scene, {"obstacles": [box], "self_collision": False})
            if Oracle(robot, collision_model(robot, scene)).distances(line[0]).min() > 0.02:
                boxes.append(box)
        found.append((line, boxes))
        if len(found) == count:
            break
    return found


@njit  # type: ignore[untyped-decorator]
def _follow(
    chain: Chain, wanted: Target, end: Array, q: Array, lower: Array, upper: Array, rows: Array
) -> bool:
    """Lead q along the line in equal steps, in place; whether it gets there, and where it was."""
    w = new_workspace(chain)
    before = np.empty(q.shape[0])
    rows[0] = q
    every = STEPS // (rows.shape[0] - 1)
    for k in range(STEPS):
        before[:] = q
        p = wanted.p + (end - wanted.p) * ((k + 1.0) / STEPS)
        target = Target(wanted.R, p, True, wanted.weight, wanted.freedom)
        distance, angle, _ = refine(chain, target, q, lower, upper, Effort(30, 8), w)
        if distance > 1e-9 or angle > 1e-9 or np.abs(q - before).max() > 0.1:
            return False
        if (k + 1) % every == 0:
            rows[(k + 1) // every] = q
    return True


def _dense(robot: Robot, line: Line, oracle: Oracle, *, free_start: bool) -> tuple[bool, bool]:
    """Whether any branch follows the line, and whether one does so without contact."""
    arm = arm_of(robot)
    T = robot.fk(line[0])
    target = pose_target(T.translation, T.rotation)
    starts = line[0][None]
    lower, upper = arm.search_bounds(line[0])
    if free_start:
        found = sample_ik_solutions(
            arm.chain, stack_targets([target]), np.empty((1, 0, arm.dof)), line[0], arm.lower,
            arm.upper, 64, 600, 0, 0.25, 1e-9,
        )  # fmt: skip
        starts = found.q[0, : found.counts[0]]
        lower, upper = np.full(arm.dof, -np.inf), np.full(arm.dof, np.inf)
    followed = False
    for start in starts:
        rows = np.empty((LOOKED_AT + 1, arm.dof))
        if not _follow(arm.chain, target, line[1], start.copy(), lower, upper, rows):
            continue
        if free_start and not _fits(arm.lower, arm.upper, rows):
            continue
        followed = True
        if all(oracle.distances(q).min() > SLACK for q in rows):
            return True, True
    return followed, False


def _fits(lower: Array, upper: Array, rows: Array) -> bool:
    """Whether full turns of each joint bring a sequence within the limits."""
    low, high = rows.min(axis=0), rows.max(axis=0)
    turns = 2.0 * np.pi * np.ceil((lower - low) / (2.0 * np.pi))
    return bool((high + turns <= upper).all())


def line_study(robot: Robot, count: int, *, free_start: bool, seed: int = 0) -> LineStudy:
    """Plan lines beside boxes, and hold the verdicts to the dense search.

    Args:
        robot: The UR5.
        count: How many lines.
        free_start: Whether a line may begin in any branch.
        seed: Of the boxes.
    """
    study = LineStudy()
    for k, (line, boxes) in enumerate(boxed_lines(robot, count, seed)):
        scene = {"obstacles": boxes}
        oracle = Oracle(robot, collision_model(robot, parse(Scene, scene)))
        followed, free = _dense(robot, line, oracle, free_start=free_start)
        request = line_request(robot, line, TOLERANCE, free=free_start) | {"scene": scene}
        study.free += free
        study.held += followed and not free
        try:
            plan = ikplan.plan(request, robot=robot)
        except IkplanError as error:
            if free:
                study.lost.append(f"line {k}: {type(error).__name__}: {error}")
            elif isinstance(error, InCollision) and all(error.pair or ("",)):
                study.named += followed
            elif followed:
                study.unnamed.append(f"line {k}: {type(error).__name__}: {error}")
            continue
        clearance = plan.certificate.clearance
        assert clearance is not None
        assert clearance.proven
        study.planned += 1
        study.found += not free
    return study
