"""Hold bodies, planner and proof to coal: ``python -m benchmarks.collision STUDY``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.collision import bodies, window
from benchmarks.collision.before import beside_before
from benchmarks.collision.cost import BOXES, DURATION, RATE, ProofCost, proof_costs
from benchmarks.collision.falsify import OWN_BODIES, ROBOTS, falsify
from benchmarks.collision.helices import helix_costs
from benchmarks.collision.lines import BOXES as BOXES_BESIDE
from benchmarks.collision.lines import line_study
from benchmarks.collision.queries import compare
from ikplan.robots import load_robot

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


def falsification(count: int, seed: int, *, own: bool) -> bool:
    """Print how many bounds were broken; whether none was."""
    begin = time.process_time()
    verdicts = falsify(count, seed=seed, own=own)
    print(
        f"{count} motions over {', '.join(OWN_BODIES if own else ROBOTS)}: {verdicts.proven} "
        f"proven, {verdicts.refused} not; bounds broken {len(verdicts.broken)}, false "
        f"violations {len(verdicts.false)}; "
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


def bodies_against_meshes(count: int, seed: int, robots: list[str]) -> bool:
    """Print what the planner's bodies miss and what they refuse for nothing."""
    print(f"{count} configurations a robot, {bodies.BOXES} boxes in each of {bodies.SCENES} scenes")
    good = True
    for name in robots:
        study = bodies.body_study(name, count, seed)
        print(
            f"  {name}: {study.touching} in contact by the meshes, missed {study.missed}; false "
            f"alarms {study.alarms} ({100.0 * study.alarm_share:.2f} % of the free ones, "
            f"{study.alone} with the arm itself); {study.checker_us:.1f} us a check, "
            f"coal on meshes {study.mesh_us:.0f} us",
            flush=True,
        )
        good &= study.missed == 0 and study.alarm_share <= 0.01
    return good


def lines(count: int, seed: int) -> bool:
    """Print what becomes of lines beside boxes; whether none is lost and each verdict names it."""
    good, robot = True, load_robot("ur5")
    for free_start in (False, True):
        study = line_study(robot, count, free_start=free_start, seed=seed)
        print(
            f"{count} lines beside {BOXES_BESIDE} boxes, {'any' if free_start else 'given'} start: "
            f"the dense search finds {study.free} free; planned and proven {study.planned} "
            f"(of others {study.found}), lost {len(study.lost)}; in contact in every branch "
            f"{study.held}, refused with the pair named {study.named}, without "
            f"{len(study.unnamed)}"
        )
        for line in (*study.lost, *study.unnamed):
            print(" ", line)
        good &= not study.lost and not study.unnamed
    return good


def windows(count: int, seed: int) -> bool:
    """Print what becomes of lines through windows; whether none that can be passed is lost."""
    good = True
    for name in ("panda", "iiwa14"):
        study = window.window_study(load_robot(name), count, seed)
        print(
            f"{name}, {count} windows: holding the first branch collides in {study.held}, of which "
            f"planned {study.planned}, least clearance "
            f"{', '.join(f'{1e3 * least:.1f}' for least in study.least)} mm; free in "
            f"{study.open}, of which planned {study.open_planned}; refused {len(study.refused)}, "
            f"of which a dense search passes {len(study.lost)}"
        )
        for line in study.refused:
            print("  LOST" if line in study.lost else " ", line)
        good &= study.planned > 0 and study.open_planned == study.open and not study.lost
    return good


def helices(repeats: int) -> bool:
    """Print what self-collision costs the helices; whether motions are the same in 5 ms more."""
    good = True
    for cost in helix_costs(repeats):
        print(
            f"{cost.name}: {cost.off:.1f} ms without, {cost.on:.1f} ms with self-collision; the "
            f"{'same' if cost.same else 'ANOTHER'} motion, {'' if cost.proven else 'NOT '}proven"
            + (f"; without checks {' and '.join(cost.contact)} touch" if cost.contact else "")
        )
        good &= (cost.same or cost.contact is not None) and cost.proven
        good &= cost.on - cost.off <= 5.0
    return good


def off(checkout: Path, repeats: int) -> bool:
    """Print what plans without checks cost beside an earlier checkout; whether 1.02 is kept."""
    rows = beside_before(checkout, repeats)
    ratios = [row.now / row.before for row in rows]
    for row, ratio in zip(rows, ratios, strict=True):
        print(f"  {row.name}: {row.before:.2f} ms before, {row.now:.2f} ms now, {ratio:.3f}")
    mean = float(np.exp(np.mean(np.log(ratios))))
    print(f"{len(rows)} requests, {repeats} plans each: geometric mean of the ratios {mean:.3f}")
    return mean <= 1.02


def main() -> int:
    """Run one study."""
    parser = argparse.ArgumentParser(prog="benchmarks.collision", description=__doc__)
    studies = ("proof", "falsify", "kernel", "bodies", "lines", "window", "helices", "off")
    parser.add_argument("study", choices=studies)
    parser.add_argument("--count", type=int, help="motions, configurations, lines, queries, ...")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--own", action="store_true", help="falsify: the robots' own bodies")
    parser.add_argument("--robots", nargs="+", default=bodies.ROBOTS, help="bodies: these robots")
    parser.add_argument("--before", type=Path, help="off: folder of a checkout of earlier code")
    options = parser.parse_args()
    if options.study == "off" and options.before is None:
        parser.error("off: --before FOLDER is missing")
    count, seed = options.count, options.seed
    good = {
        "proof": lambda: proof(count or 20),
        "falsify": lambda: falsification(count or 1000, seed, own=options.own),
        "kernel": lambda: kernel(count or 1_000_000, seed),
        "bodies": lambda: bodies_against_meshes(count or 100_000, seed, list(options.robots)),
        "lines": lambda: lines(count or 200, seed),
        "window": lambda: windows(count or 30, seed),
        "helices": lambda: helices(count or 15),
        "off": lambda: off(options.before.absolute(), count or 15),
    }[options.study]()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
