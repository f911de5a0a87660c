"""What 10,050 evaluations by each search cost: ``python -m benchmarks.speed.solvers``.

In calls of ``pinocchio.framesForwardKinematics``, both measured by turns in one process, in
processor time: what else the machine does in between does not count.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import statistics  # noqa: E402 - the threads are counted when NumPy is imported
import time  # noqa: E402
from collections.abc import Callable  # noqa: E402
from dataclasses import dataclass  # noqa: E402

import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402

from ikplan.ik.metaheuristic_seeds import Searcher  # noqa: E402
from ikplan.ik.registry import solvers  # noqa: E402
from ikplan.kinematics.arm import arm_of  # noqa: E402
from ikplan.kinematics.target import pose_target  # noqa: E402
from ikplan.robots import load_robot  # noqa: E402

__all__ = ["Cost", "main", "rows"]

EVALUATIONS = 10_050
COSTLY = {"mo-pso", "gsa", "bode-cs"}


@dataclass(frozen=True)
class Cost:
    """What a search costs.

    Attributes:
        name: The search.
        seconds: Of 10,050 evaluations of the iiwa's position objective, the call included [s].
        fk: Of one call of ``pinocchio.framesForwardKinematics`` in the same run [s].
        limit: Largest ratio allowed.
    """

    name: str
    seconds: float
    fk: float
    limit: float

    @property
    def ratio(self) -> float:
        """Cost in calls of the forward kinematics."""
        return self.seconds / self.fk


def _seconds(call: Callable[[], object], loops: int) -> float:
    start = time.thread_time()
    for _ in range(loops):
        call()
    return (time.thread_time() - start) / loops


def rows(repeats: int = 15) -> list[Cost]:
    """Measure every search.

    Args:
        repeats: Searches timed of each; the median counts.
    """
    robot = load_robot("iiwa14")
    arm = arm_of(robot)
    q = np.array([0.3, 0.5, 0.2, -1.0, 0.4, 0.6, 0.1])
    target = pose_target(robot.fk(q).translation)
    data = robot.model.createData()
    costs = []
    for solver in solvers():
        if solver.population is None:
            continue
        iterations = 100 if solver.name == "cs" else 200
        searcher = Searcher(arm, solver, solver.check({}), 0, 50, iterations)

        def search(searcher: Searcher = searcher) -> float:
            outcome = searcher.run(target, robot.home, arm.lower, arm.upper)
            return EVALUATIONS / float(outcome.evaluations[0])

        search()
        searches, calls = [], []
        for _ in range(repeats):
            start = time.thread_time()
            share = search()
            searches.append((time.thread_time() - start) * share)
            calls.append(_seconds(lambda: pin.framesForwardKinematics(robot.model, data, q), 1000))
        limit = 40_000.0 if solver.name in COSTLY else 15_000.0
        seconds, fk = statistics.median(searches), statistics.median(calls)
        costs.append(Cost(solver.name, seconds, fk, limit))
    return costs


def main() -> None:
    """Print the table."""
    print(f"{EVALUATIONS:,} evaluations of the iiwa's position objective, N = 50")
    print(f"{'search':22} {'ms':>8} {'x FK':>9} {'limit':>9}")
    for cost in rows():
        verdict = "" if cost.ratio <= cost.limit else "  above its limit"
        figures = f"{cost.seconds * 1e3:8.2f} {cost.ratio:9,.0f} {cost.limit:9,.0f}"
        print(f"{cost.name:22} {figures}{verdict}")


if __name__ == "__main__":
    main()
