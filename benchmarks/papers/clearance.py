"""Clearance as a term of the searches' objective: ``python -m benchmarks.papers.clearance``.

The case that papers on obstacle avoidance by metaheuristics study: a pose of a redundant arm, and
boxes close to it. Every search minimises the error of the pose, and the same with the term of
:mod:`ikplan.ik.crowding`, from the same random numbers. The best configuration of each is refined
to the pose; its distances are coal's, which the searches do not use.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wilcoxon

from ikplan.collision.checker import CollisionChecker
from ikplan.documents import parse
from ikplan.documents.scene import Scene
from ikplan.ik.crowding import REACH, surroundings
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.metaheuristic_seeds import Searcher
from ikplan.ik.registry import solvers
from ikplan.ik.solver import Solver
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.robots import Robot, load_robot
from ikplan.scene.body import CollisionModel
from ikplan.scene.clearance import model_clearance
from ikplan.scene.model import collision_model

__all__ = ["AvoidanceCase", "Comparison", "Found", "avoidance_cases", "compare", "search"]

Array = NDArray[np.float64]

BOXES = 6
_LEAST, _MOST = 0.01, 0.06
"""Distance from the boxes of the configuration that a target is the pose of [m]."""
_MET = 1e-6


@dataclass(frozen=True)
class AvoidanceCase:
    """A pose, and what stands about it.

    Attributes:
        q: A configuration of the pose that is free of contact, shape (dof,) [rad or m].
        checker: What the search keeps clear of: the boxes, and the arm itself.
        boxes: The arm against the boxes alone.
    """

    q: Array
    checker: CollisionChecker
    boxes: CollisionModel


@dataclass(frozen=True)
class Found:
    """What a search found for each target.

    Attributes:
        error: Error of the pose before the refinement [m, 0.1 m a unit of Delta R].
        met: Whether the pose is met after it.
        free: Whether it is met free of contact.
        gap: Distance of the arm from the boxes there [m]; nan where the pose is not met.
        seconds: Processor time of the search [s].
        evaluations: Evaluations of the objective.
    """

    error: Array
    met: NDArray[np.bool_]
    free: NDArray[np.bool_]
    gap: Array
    seconds: Array
    evaluations: Array


@dataclass(frozen=True)
class Comparison:
    """One search without and with the term, from the same random numbers."""

    method: str
    without: Found
    with_term: Found

    @property
    def both(self) -> NDArray[np.bool_]:
        """Targets whose pose both meet."""
        return np.asarray(self.without.met & self.with_term.met)

    @property
    def gains(self) -> Array:
        """How much the distance from the boxes grows where both meet the pose [m].

        As for the term, a distance beyond its reach counts as the reach.
        """
        with_term, without = (np.minimum(x.gap, REACH) for x in (self.with_term, self.without))
        return np.asarray((with_term - without)[self.both])

    @property
    def p_value(self) -> float:
        """Wilcoxon's test of the gains, paired, two-sided; 1 where nothing differs."""
        gains = self.gains
        return float(wilcoxon(gains).pvalue) if np.any(gains != 0.0) else 1.0


def avoidance_cases(robot: Robot, count: int, seed: int = 0) -> list[AvoidanceCase]:
    """Return poses among boxes, each with a configuration that is close to one, without contact."""
    rng = np.random.default_rng(seed)
    cases: list[AvoidanceCase] = []
    while len(cases) < count:
        boxes: list[dict[str, Any]] = [
            {
                "name": f"box {k}",
                "shape": {"type": "box", "size": rng.uniform(0.05, 0.3, 3).tolist()},
                "position": rng.uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 0.9]).tolist(),
            }
            for k in range(BOXES)
        ]
        checker = CollisionChecker(
            robot, collision_model(robot, parse(Scene, {"obstacles": boxes}))
        )
        model = collision_model(robot, parse(Scene, {"obstacles": boxes, "self_collision": False}))
        for _ in range(300):
            q = robot.random_configuration(rng)
            if checker.least_gap(q)[0] < _LEAST:
                continue
            if model_clearance(robot, model, q).distance < _MOST:
                cases.append(AvoidanceCase(q, checker, model))
                break
    return cases


def search(
    robot: Robot,
    solver: Solver,
    cases: Sequence[AvoidanceCase],
    *,
    term: bool,
    population: int,
    iterations: int,
    seed: int = 0,
) -> Found:
    """Run a search on every target and refine its best configuration.

    Args:
        robot: The arm.
        solver: The search.
        cases: The targets.
        term: Whether clearance is a term of its objective.
        population: Its individuals.
        iterations: Its iterations.
        seed: Of its random numbers; every target has its own.
    """
    arm, count = arm_of(robot), len(cases)
    found = Found(
        np.empty(count),
        np.zeros(count, dtype=np.bool_),
        np.zeros(count, dtype=np.bool_),
        np.full(count, np.nan),
        np.empty(count),
        np.empty(count),
    )
    lower, upper = arm.search_bounds(robot.home)
    values = solver.check({})
    for k, case in enumerate(cases):
        T = robot.fk(case.q)
        target = pose_target(T.translation.copy(), T.rotation.copy())
        searcher = Searcher(arm, solver, values, seed + k, population, iterations)
        searcher.around = surroundings(case.checker.arrays(None)) if term else None
        began = time.process_time()
        q, spent = searcher.best(target, robot.home, lower, upper)
        found.seconds[k] = time.process_time() - began
        found.evaluations[k] = spent
        reached = robot.fk(q)
        found.error[k] = np.linalg.norm(reached.translation - target.p) + 0.1 * np.linalg.norm(
            reached.rotation - target.R
        )
        q = np.array(q)
        distance, angle, _ = refine(
            arm.chain, target, q, lower, upper, Effort(60, 8), new_workspace(arm.chain)
        )
        if distance <= _MET and angle <= _MET:
            found.met[k] = True
            found.free[k] = case.checker.free(q[None])[0]
            found.gap[k] = model_clearance(robot, case.boxes, q).distance
    return found


def compare(
    robot: Robot,
    cases: Sequence[AvoidanceCase],
    *,
    population: int,
    iterations: int,
    seed: int = 0,
    methods: Sequence[str] | None = None,
) -> list[Comparison]:
    """Run searches without and with the term.

    Args:
        robot: A redundant arm.
        cases: The targets.
        population: Individuals of each search.
        iterations: Iterations of each search.
        seed: Of the searches.
        methods: Names of the searches; None: all that have a population.
    """
    chosen = [
        solver
        for solver in solvers()
        if solver.searches
        and solver.population is not None
        and (methods is None or solver.name in methods)
    ]
    budget: dict[str, int] = {
        "population": population,
        "iterations": iterations,
        "seed": seed,
    }
    return [
        Comparison(
            solver.name,
            search(robot, solver, cases, term=False, **budget),
            search(robot, solver, cases, term=True, **budget),
        )
        for solver in chosen
    ]


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.papers.clearance")
    parser.add_argument("--robot", default="panda")
    parser.add_argument("--targets", type=int, default=100)
    parser.add_argument("--population", type=int, default=50)
    parser.add_argument("--iterations", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--methods", nargs="+")
    options = parser.parse_args()
    robot = load_robot(options.robot)
    cases = avoidance_cases(robot, options.targets, options.seed)
    print(
        f"{options.robot}, {options.targets} poses among {BOXES} boxes, N = "
        f"{options.population}, T = {options.iterations}; without the term -> with it"
    )
    print(
        "| search | evaluations | error before refinement [mm] | met | free of contact | "
        "mean distance gained [mm] | p | time |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for row in compare(
        robot,
        cases,
        population=options.population,
        iterations=options.iterations,
        seed=options.seed,
        methods=options.methods,
    ):
        a, b = row.without, row.with_term
        times = float(np.median(b.seconds) / np.median(a.seconds))
        print(
            f"| {row.method} | {b.evaluations.mean():,.0f} | "
            f"{1e3 * np.median(a.error):.1f} -> {1e3 * np.median(b.error):.1f} | "
            f"{a.met.mean():.0%} -> {b.met.mean():.0%} | "
            f"{a.free.mean():.0%} -> {b.free.mean():.0%} | "
            f"{1e3 * row.gains.mean():+.1f} | {row.p_value:.1g} | {times:.1f} x |",
            flush=True,
        )


if __name__ == "__main__":
    main()
