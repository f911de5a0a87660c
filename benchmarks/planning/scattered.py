"""Waypoints far apart, against dynamic programming over every solution and its 2 pi copies."""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Iterator

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from benchmarks.planning.measure import laid, pose_document, route_problem
from benchmarks.speed.measure import Figure
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.equivalent_configurations import with_equivalents
from ikplan.planning.ladder.ik_candidates import sample_ik_solutions
from ikplan.planning.ladder.joint_length import joint_path_length
from ikplan.planning.ladder.motion_cost import plain_cost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.planning.waypoints.stack import stack_targets
from ikplan.robots import Robot, load_robot

__all__ = ["ROBOTS", "figures"]

Array = NDArray[np.float64]

ROBOTS = ("ur5", "mh5", "panda", "iiwa14")
_WAYPOINTS = 10
_SEEDS = {6: 300, 7: 1500}
"""Of the reference, each waypoint; the planner's own has a few dozen."""


def figures(paths: int) -> Iterator[Figure]:
    """Yield how far the planner's joint motion is above the reference's, for each robot."""
    for name in ROBOTS:
        robot = load_robot(name)
        rng = np.random.default_rng(100)
        above, greedy_above, times = [], [], []
        for _ in range(paths):
            poses = [robot.fk(robot.random_configuration(rng)) for _ in range(_WAYPOINTS)]
            request = {
                "robot": name,
                "scene": {"self_collision": False},
                "start": [float(v) for v in robot.home],
                "path": {"waypoints": [pose_document(T.rotation, T.translation) for T in poses]},
                "budget_s": 600,
            }
            begin = time.thread_time()
            length = _length(request, robot)
            times.append(time.thread_time() - begin)
            greedy = _length({**request, "ik": {"elongation": "greedy"}}, robot)
            best = min(_reference(robot, poses), length, greedy)
            above.append(100.0 * (length / best - 1.0))
            greedy_above.append(100.0 * (greedy / best - 1.0))
        yield Figure(f"{name}: over the reference, median", statistics.median(above), "%", most=1.0)
        yield Figure(f"{name}: over the reference, worst", max(above), "%", most=5.0)
        yield Figure(f"{name}: greedy, median", statistics.median(greedy_above), "%")
        yield Figure(f"{name}: planned in, median", 1e3 * statistics.median(times), "ms")


def _length(request: dict[str, object], robot: Robot) -> float:
    q_start = route_problem(request, robot).q_start
    route = laid(request, robot)
    q = route.q[[waypoint.index for waypoint in route.waypoints]]
    return joint_path_length(q, q_start, False)


def _reference(robot: Robot, poses: list[pin.SE3]) -> float:
    """Least joint motion from home over all the solutions found from many seeds, polished [rad]."""
    arm = arm_of(robot)
    q_start = np.array(robot.home)
    targets = stack_targets([pose_target(T.translation, T.rotation) for T in poses])
    seeds = _SEEDS[robot.dof]
    no_seeds = np.empty((len(poses), 0, robot.dof))
    found = sample_ik_solutions(
        arm.chain,
        targets,
        no_seeds,
        q_start,
        arm.lower,
        arm.upper,
        4 * seeds,
        seeds,
        seeds,
        0.5,
        1e-9,
    )
    rows = [with_equivalents(arm, found.q[k, : found.counts[k]]) for k in range(len(poses))]
    best = np.inf
    for q in _shortest(rows, q_start, 12):
        length, _ = shorten_sequence(
            arm.chain,
            targets,
            q,
            q_start,
            False,
            arm.lower,
            arm.upper,
            plain_cost(arm.dof),
            200,
            1e-9,
        )
        best = min(best, length)
    return best


def _shortest(rows: list[Array], q_start: Array, most: int) -> Iterator[Array]:
    """Yield the shortest paths over the ladder to different last solutions, shape (n, dof)."""
    cost = np.linalg.norm(rows[0] - q_start, axis=1)
    parents = []
    for before, here in itertools.pairwise(rows):
        total = cost[:, None] + np.sqrt(
            np.maximum(
                0.0,
                np.sum(before**2, axis=1)[:, None]
                + np.sum(here**2, axis=1)[None]
                - 2.0 * before @ here.T,
            )
        )
        parents.append(np.argmin(total, axis=0))
        cost = np.min(total, axis=0)
    for j in np.argsort(cost, kind="stable")[:most]:
        path, i = [rows[-1][j]], int(j)
        for k in range(len(rows) - 2, -1, -1):
            i = int(parents[k][i])
            path.append(rows[k][i])
        yield np.array(path[::-1])
