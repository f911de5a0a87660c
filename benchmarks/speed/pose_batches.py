"""Many random reachable poses in one call, from home and near their solutions."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator

import numpy as np
import pinocchio as pin

from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan import load_robot, solve_ik_batch

__all__ = ["SECTION"]

MOST = {"iiwa14": 25.0, "panda": None, "ur5": 35.0}
NEAR = 0.02
"""Standard deviation of starts from a solution [rad]."""


def _ratio(clock: FkClock, call: Callable[[], object], count: int, repeats: int) -> float:
    """Processor time a pose of this process, in calls of the forward kinematics."""
    seconds = []
    for _ in range(repeats):
        clock.tick()
        begun = time.process_time()
        call()
        seconds.append((time.process_time() - begun) / count)
    clock.tick()
    return statistics.median(seconds) / clock.seconds


def _study(name: str, count: int, repeats: int) -> Iterator[Figure]:
    robot = load_robot(name)
    rng = np.random.default_rng(2026)
    q = np.array([robot.random_configuration(rng) for _ in range(count)])
    poses = [robot.fk(row) for row in q]
    matrices = np.array([pose.homogeneous for pose in poses])
    near = np.clip(q + rng.normal(0.0, NEAR, q.shape), robot.lower, robot.upper)
    found = solve_ik_batch(robot, poses, verdict=False)
    yield Figure(f"{name}: solved", 100.0 * float(found.solved.mean()), "%", least=99.99)
    worst = max(
        float(np.linalg.norm(pin.log6(robot.fk(row).actInv(pose)).vector))
        for row, pose in zip(found.q[:1000], poses, strict=False)
    )
    yield Figure(f"{name}: worst error of 1,000 by Pinocchio", worst, "", most=1e-6)
    clock = FkClock(robot)

    def cost(threads: int, start: object = None) -> float:
        def call() -> object:
            return solve_ik_batch(robot, matrices, start=start, verdict=False, threads=threads)  # type: ignore[arg-type]

        return _ratio(clock, call, count, repeats)

    one = cost(1)
    yield Figure(f"{name}: a pose from home", one, "x FK", most=MOST[name])
    yield Figure(
        f"{name}: near a start", cost(1, near), "x FK", most=8.0 if name == "iiwa14" else None
    )
    # Processor time: on two free processors the wall time is that much less than the half.
    yield Figure(f"{name}: speed by two threads", 2.0 * one / cost(2), "x", least=1.8)


def run(effort: float) -> list[Figure]:
    """Solve and time every batch."""
    count, repeats = max(500, int(100_000 * effort)), max(1, round(3 * effort))
    return [figure for name in MOST for figure in _study(name, count, repeats)]


SECTION = Section("pose_batches", "random reachable poses, solve_ik_batch()", run)
