"""Least time as the objective beside least joint motion."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan

__all__ = ["small_gaps", "study"]

Array = NDArray[np.float64]

_ROBOTS = ("kuka_kr6_r700_sixx", "ur5", "iiwa14", "panda")
_EXAMPLES = Path(__file__).parents[2] / "examples"
_SLACK = 1e-3
_BUDGET = 300


def study(kind: str, count: int, seed: int) -> int:
    """Plan requests of one kind with both objectives and print the gains.

    Args:
        kind: "helices", "waypoints" or "lines".
        count: How many.
        seed: Seed of every random choice.

    Returns:
        How many motions of least time are longer than those of least motion by more than 0.1 %.
    """
    gains, longer, none = [], 0, 0
    for request in itertools.islice(_requests(kind, np.random.default_rng(seed)), count):
        request = {**request, "budget_s": _BUDGET}
        try:
            least = ikplan.plan(request)
            fast = ikplan.plan({**request, "ik": {"objective": "time"}})
        except ikplan.NoPlan:
            none += 1
            continue
        gains.append(1.0 - fast.duration / least.duration)
        longer += fast.duration > least.duration * (1.0 + _SLACK)
    shares = np.array(gains)
    print(
        f"{kind}: {len(gains)} planned, {none} not; shorter by {100 * shares.mean():.2f} % in the "
        f"mean, {100 * np.median(shares):.2f} % in the median, {100 * shares.max():.1f} % at most; "
        f"{100 * (shares > 1e-4).mean():.0f} % are shorter; {longer} longer by more than 0.1 %"
    )
    return longer


def _requests(kind: str, rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    if kind == "helices":
        for file in sorted(_EXAMPLES.glob("helix*.json")):
            yield json.loads(file.read_text())
        return
    for k in itertools.count():
        robot = ikplan.load_robot(_ROBOTS[k % len(_ROBOTS)])
        yield _waypoints(robot, rng) if kind == "waypoints" else _line(robot, rng)


def _pose(robot: ikplan.Robot, rng: np.random.Generator) -> Any:
    low, high = np.maximum(robot.lower, -2.0), np.minimum(robot.upper, 2.0)
    return robot.fk(rng.uniform(low, high))


def _waypoints(robot: ikplan.Robot, rng: np.random.Generator) -> dict[str, Any]:
    poses = [_pose(robot, rng) for _ in range(int(rng.integers(2, 7)))]
    waypoints = [{"position": pose.translation.tolist()} for pose in poses]
    return {
        "robot": robot.name,
        "path": {"waypoints": waypoints},
        "scene": {"self_collision": False},
    }


def _line(robot: ikplan.Robot, rng: np.random.Generator) -> dict[str, Any]:
    """A line of the tool, which may turn about its own axis."""
    import pinocchio as pin

    q = np.clip(robot.home + rng.uniform(-0.5, 0.5, robot.dof), robot.lower, robot.upper)
    T = robot.fk(q)
    quaternion = pin.Quaternion(T.rotation).coeffs().tolist()
    step = rng.normal(0.0, 1.0, 3)
    to = T.translation + step * (rng.uniform(0.1, 0.3) / np.linalg.norm(step))
    return {
        "robot": robot.name,
        "start": "free",
        "path": {
            "begin": {"position": T.translation.tolist(), "quaternion_xyzw": quaternion},
            "segments": [
                {"type": "line", "to": {"position": to.tolist(), "quaternion_xyzw": quaternion}}
            ],
            "orientation_free": {"about": "tool_z"},
        },
        "scene": {"self_collision": False},
    }


def small_gaps(count: int, seed: int) -> float:
    """Compare least time with exact dynamic programming over all branches of few waypoints.

    The price of a step is what the metric of the limits says: the largest motion of a joint over
    its velocity limit. All poses are full ones of a UR5, whose branches are found by many restarts.

    Args:
        count: How many sets of waypoints.
        seed: Seed of every random choice.

    Returns:
        The largest gap, as a share of the exact optimum.
    """
    import pinocchio as pin

    robot, rng = ikplan.load_robot("ur5"), np.random.default_rng(seed)
    gaps = []
    for _ in range(count):
        poses = [_pose(robot, rng) for _ in range(int(rng.integers(2, 4)))]
        waypoints = [
            {
                "position": T.translation.tolist(),
                "quaternion_xyzw": pin.Quaternion(T.rotation).coeffs().tolist(),
            }
            for T in poses
        ]
        request = {
            "robot": "ur5",
            "path": {"waypoints": waypoints},
            "ik": {"objective": "time"},
            "scene": {"self_collision": False},
        }
        found = ikplan.plan(request)
        layers = [_branches(robot, T, rng) for T in poses]
        best = _dynamic_programme(robot, robot.home, layers)
        rows = np.vstack([robot.home, found.waypoints.q])
        cost = (np.abs(np.diff(rows, axis=0)) / robot.velocity_limit).max(axis=1).sum()
        gaps.append(float(cost) / best - 1.0)
    print(
        f"{count} small sets: gap to exact dynamic programming {100 * np.mean(gaps):.2f} % in the "
        f"mean, {100 * np.median(gaps):.2f} % in the median, {100 * np.max(gaps):.1f} % at most"
    )
    return float(np.max(gaps))


def _branches(robot: ikplan.Robot, T: Any, rng: np.random.Generator) -> Array:
    """Every solution of a pose found from 200 starts, full turns included."""
    starts = [robot.random_configuration(rng) for _ in range(200)]
    found = ikplan.solve_ik_batch(robot, [T] * len(starts), start=np.array(starts), verdict=False)
    rows = found.q[found.solved]
    turns = np.array(list(itertools.product((-1, 0, 1), repeat=robot.dof))) * 2.0 * np.pi
    every = (rows[:, None] + turns[None]).reshape(-1, robot.dof)
    inside = ((every >= robot.lower) & (every <= robot.upper)).all(axis=1)
    _, first = np.unique(np.round(every[inside], 5), axis=0, return_index=True)
    return np.asarray(every[inside][first])


def _dynamic_programme(robot: ikplan.Robot, start: Array, layers: list[Array]) -> float:
    before, cost = start[None], np.zeros(1)
    for layer in layers:
        total = np.full(len(layer), np.inf)
        for q, price in zip(before, cost, strict=True):
            step = (np.abs(layer - q) / robot.velocity_limit).max(axis=1)
            total = np.minimum(total, price + step)
        before, cost = layer, total
    return float(cost.min())
