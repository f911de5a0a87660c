"""Hold the proof of clearance to coal: ``python -m benchmarks.collision proof|falsify|kernel``."""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from benchmarks.collision.cost import BOXES, DURATION, RATE, ProofCost, proof_costs
from benchmarks.collision.falsify import ROBOTS, falsify
from benchmarks.collision.queries import compare

_BLOCK = 50_000


def proof(count: int) -> bool:
    """Print what proofs cost; whether they are cheaper than a yes or no at every sample."""
    print(
        f"{DURATION:g} s, {BOXES} boxes, {RATE:g} Hz, {count} motions a robot; processor time, "
        "median (greatest) [ms]"
    )
    cheaper = True
    for name in ("panda", "ur5"):
        costs = proof_costs(name, count)

        def row(field: str, costs: list[ProofCost] = costs) -> str:
            values = [getattr(cost, field) for cost in costs]
            return f"{np.median(values):.2f} ({max(values):.2f})"

        free = [cost for cost in costs if cost.proven]
        print(f"{name}: {costs[0].pairs} pairs, {len(free)} of {count} proven")
        for field, what in (
            ("polynomials", "proof of the polynomials to 1 mm"),
            ("cubic", "proof of the cubics between samples to 1 mm"),
            ("segments", "the same of ten segments, each to 1 mm"),
            ("prepare", "reading the bodies, once a scene"),
            ("broadphase", "coal, yes or no at every sample, broadphase"),
            ("sampled", "coal, yes or no at every sample, pair by pair"),
            ("configurations", "configurations of the proof"),
            ("queries", "distance queries of the proof"),
        ):
            print(f"  {row(field):>18}  {what}")
        cheaper &= bool(
            np.median([c.polynomials for c in free]) < np.median([c.broadphase for c in free])
        )
    return cheaper


def falsification(count: int, seed: int) -> bool:
    """Print how many bounds were broken; whether none was."""
    begin = time.process_time()
    verdicts = falsify(count, seed=seed)
    print(
        f"{count} motions over {', '.join(ROBOTS)}: {verdicts.proven} proven, {verdicts.refused} "
        f"not; bounds broken {len(verdicts.broken)}, false violations {len(verdicts.false)}; "
        f"dense distance less bound {min(verdicts.slack):.2e} to {max(verdicts.slack):.2e} m; "
        f"{time.process_time() - begin:.0f} s"
    )
    for line in (*verdicts.broken, *verdicts.false):
        print(" ", line)
    return not verdicts.broken and not verdicts.false


def kernel(count: int, seed: int) -> bool:
    """Print the worst of many distance queries; whether all bounds hold."""
    good, touching = True, 0
    above = below = gap = -np.inf
    missed, ours, theirs = 0, [], []
    done = 0
    while done < count:
        study = compare(min(_BLOCK, count - done), seed + done)
        done += study.queries
        touching += study.touching
        missed += study.missed
        above, below = max(above, study.above), max(below, study.below)
        gap = max(gap, study.gap)
        ours.append(study.kernel_us)
        theirs.append(study.coal_us)
        good &= study.missed == 0 and study.above <= 5e-6 and study.below <= 5e-6
    print(
        f"{done} queries, {touching} touching, {missed} missed; lower bound above coal "
        f"{above:.1e} m, upper bound below coal {below:.1e} m, gap between bounds {gap:.1e} m; "
        f"{np.median(ours):.2f} us (coal from Python {np.median(theirs):.1f} us)"
    )
    return good


def main() -> int:
    """Run one study."""
    parser = argparse.ArgumentParser(prog="benchmarks.collision", description=__doc__)
    parser.add_argument("study", choices=("proof", "falsify", "kernel"))
    parser.add_argument("--count", type=int, help="motions, motions a robot, or queries")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if options.study == "proof":
        good = proof(options.count or 20)
    elif options.study == "falsify":
        good = falsification(options.count or 1000, options.seed)
    else:
        good = kernel(options.count or 1_000_000, options.seed)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
