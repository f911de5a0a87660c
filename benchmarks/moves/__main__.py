"""Print how well and how fast moves around obstacles are found: ``python -m benchmarks.moves``."""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

import ikplan
from benchmarks.moves.ompl_peer import ompl_runs
from benchmarks.moves.problems import Problem, read_problems
from benchmarks.moves.random_cells import arm_on_a_rail, random_problems
from benchmarks.moves.search import (
    Runs,
    least_distance,
    left_out,
    plan_runs,
    proof_times,
    search_runs,
)
from ikplan.robots import Robot


def main() -> int:
    """Run what the command line asks for; 1 where a plan is not proven or touches something."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.moves", description=__doc__)
    parser.add_argument("--robots", nargs="+", default=["ur5", "panda"])
    parser.add_argument("--seeds", type=int, default=5, help="seeds of every search")
    parser.add_argument(
        "--cells", type=int, default=0, help="random cells instead; robots of the catalogue, rail"
    )
    parser.add_argument("--cell-seed", type=int, default=1, help="seed of the cells")
    parser.add_argument("--every", type=int, default=1, help="take every n-th problem only")
    parser.add_argument("--plans", type=int, default=1, help="seeds of whole plans")
    parser.add_argument("--falsify", type=int, default=20, help="plans looked at by coal")
    parser.add_argument("--ompl", action="store_true", help="OMPL in the same run (pip package)")
    options = parser.parse_args()
    return max(_robot(name, options) for name in options.robots)


def _robot(name: str, options: argparse.Namespace) -> int:
    robot = arm_on_a_rail() if name == "rail" else ikplan.load_robot(name)
    if options.cells:
        problems = random_problems(robot, options.cells, options.cell_seed)
        print(f"\n{name}: {len(problems)} random cells, seed {options.cell_seed}")
    else:
        problems = read_problems(name)[:: options.every]
        print(f"\n{name}: {len(problems)} problems of MotionBenchMaker")
    kept = []
    for problem in problems:
        pair = left_out(robot, problem)
        if pair is None:
            kept.append(problem)
        else:
            print(
                f"  left out: {problem.name}: start or goal holds {' and '.join(pair)} in contact"
            )
    print(f"  {len(kept)} taken, {options.seeds} seeds, processor time, median / p95 / max [ms]")
    _print("ikplan, every edge proven", search_runs(robot, kept, options.seeds))
    if options.ompl:
        _print("OMPL RRTConnect, sampled", ompl_runs(robot, kept, 1))
    return sum(_plans(robot, kept, seed, options.falsify) for seed in range(options.plans))


def _plans(robot: Robot, problems: list[Problem], seed: int, falsify: int) -> int:
    plan_runs(robot, problems[:1], seed)  # compiles
    begin = time.process_time()
    plans, failed = plan_runs(robot, problems, seed)
    spent = (time.process_time() - begin) / max(len(problems), 1)
    for line in failed:
        print(f"  not solved: {line}")
    proven = sum(bool(p.certificate.clearance and p.certificate.clearance.proven) for p in plans)
    stages = sorted({stage for plan in plans for stage in plan.stats.seconds})
    times = {s: 1e3 * np.median([p.stats.seconds.get(s, 0.0) for p in plans]) for s in stages}
    stops = sum(move.stops for plan in plans for move in plan.stats.moves)
    print(
        f"  plans, seed {seed}: {len(plans)} of {len(problems)} solved, {proven} proven; "
        f"{1e3 * spent:.0f} ms each; duration {np.median([p.duration for p in plans]):.2f} s, "
        f"length {np.median([p.stats.moves[0].length for p in plans]):.2f}, {stops} stops; median "
        + ", ".join(f"{stage} {value:.1f} ms" for stage, value in times.items())
    )
    solved = [p for p in problems if not any(line.startswith(f"{p.name}:") for line in failed)]
    if plans:
        proof = np.percentile(proof_times(robot, solved, plans), [50, 95])
        print(f"  proof of the timed motion, processor time: {proof[0]:.1f} / {proof[1]:.1f} ms")
    chosen = range(0, len(plans), max(1, len(plans) // falsify)) if falsify else ()
    least = [least_distance(robot, solved[k], plans[k]) for k in chosen]
    touching = sum(distance <= 0.0 for distance in least)
    if least:
        print(
            f"  coal at steps of 0.0005 rad: {touching} of {len(least)} plans touch something, "
            f"least distance {1e3 * min(least):.3f} mm"
        )
    return int(proven < len(plans) or touching > 0)


def _print(title: str, runs: Runs) -> None:
    def row(values: list[float]) -> str:
        return " / ".join(f"{v:.2f}" for v in np.percentile(values, [50, 95, 100]))

    print(
        f"  {title}: {100.0 * np.mean(runs.solved):.1f} % solved; search {row(runs.search)}; with "
        f"shortening {row(runs.shortened)}; length {np.median(runs.found_length):.2f} -> "
        f"{np.median(runs.length):.2f} (mean {np.mean(runs.length):.2f})"
    )


if __name__ == "__main__":
    sys.exit(main())
