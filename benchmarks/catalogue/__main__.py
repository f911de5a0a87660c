"""``python -m benchmarks.catalogue``: the written robots against the facts of their sources.

For each: the largest error of its forward kinematics at 50 random configurations against the facts
(composed in numpy, and by Pinocchio from a URDF of the facts), how many random poses ``lm`` solves,
the smallest singular value at home, and how many of the 100 mm lines from home along +x, -x, +z
and -z plan.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence

import numpy as np

from benchmarks.catalogue.measure import fk_errors, lines_planned, poses_solved
from catalogue.facts import read_facts
from ikplan.robots import load_robot


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row a robot, and the sums."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.catalogue", description=__doc__)
    parser.add_argument("--poses", type=int, default=200, help="poses of IK a robot")
    parser.add_argument("names", nargs="*", help="robots; none: all")
    options = parser.parse_args(arguments)
    facts = read_facts()
    arms = [arm for arm in facts.arms if not options.names or arm.name in options.names]
    errors, solved, planned, least, refusals = np.zeros(2), 0, 0, np.inf, []
    begun = time.perf_counter()
    for number, arm in enumerate(arms):
        robot = load_robot(arm.name)
        rng = np.random.default_rng([14, number])
        error = fk_errors(arm, robot, 50, rng)
        met = poses_solved(robot, options.poses, rng)
        value = float(np.linalg.svd(robot.jacobian(robot.home), compute_uv=False)[-1])
        said = lines_planned(arm.name)
        lines = sum(answer == "planned" for answer in said.values())
        errors = np.maximum(errors, error)
        solved, planned, least = solved + met, planned + lines, min(least, value)
        refusals += [f"{arm.name} {k}: {v}" for k, v in said.items() if v != "planned"]
        print(
            f"{arm.name:28} FK {error[0]:.1e} m {error[1]:.1e} rad  IK {met}/{options.poses}  "
            f"home {value:.3f}  lines {lines}/4",
            flush=True,
        )
    print(
        f"{len(arms)} robots: FK at most {errors[0]:.1e} m and {errors[1]:.1e} rad; IK {solved} of "
        f"{options.poses * len(arms)}; smallest singular value at home at least {least:.3f}; lines "
        f"{planned} of {4 * len(arms)}; {time.perf_counter() - begun:.0f} s"
    )
    print(*refusals, sep="\n")


if __name__ == "__main__":
    main()
