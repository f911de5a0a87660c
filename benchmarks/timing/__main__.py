"""Print how well and how fast joint paths are timed: ``python -m benchmarks.timing``."""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from benchmarks.timing.further import steady_study, tool_study, torque_study
from benchmarks.timing.paths import KINDS, random_limits, random_waypoints
from benchmarks.timing.reference import toppra_duration
from ikplan.errors import TimingFailed
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.robots import load_robot
from ikplan.timing import TimedPath, sample, time_joint_path

ROBOTS = ("iiwa14", "panda", "ur5", "xarm7", "z1", "kinova_j2s6s200")
Case = tuple[str, NDArray[np.float64], JointLimits]


def robot_cases(count: int) -> list[Case]:
    """Random paths over six robots: the set of the first release."""
    limits = [JointLimits.from_robot(load_robot(name)) for name in ROBOTS]
    cases: list[Case] = []
    kinds = ("smooth", "scattered", "cusps", "duplicates")
    for i in range(count):
        rng = np.random.default_rng([1, i])
        mine, kind = limits[i % len(limits)], kinds[i % len(kinds)]
        n = int(rng.integers(2, 40))
        cases.append(
            (kind, random_waypoints(rng, kind, n, mine.lower, mine.upper, fill=True), mine)
        )
    return cases


def wild_cases(count: int) -> list[Case]:
    """2 to 500 waypoints, 1 to 12 joints, of every kind."""
    cases: list[Case] = []
    for i in range(count):
        rng = np.random.default_rng([2, i])
        kind = tuple(KINDS)[i % len(KINDS)]
        limits = random_limits(rng, int(rng.integers(1, 13)))
        n = int(np.exp(rng.uniform(np.log(2), np.log(500))))
        fill = kind != "tiny" and bool(rng.random() < 0.5)
        cases.append(
            (kind, random_waypoints(rng, kind, n, limits.lower, limits.upper, fill=fill), limits)
        )
    return cases


def excess(timed: TimedPath, limits: JointLimits) -> float:
    """Return by how much, relatively, any limit is exceeded at 10 kHz, in blocks of samples."""
    worst = -1.0
    total = int(timed.duration * 1e4) + 2
    for start in range(0, total, 200_000):
        t = np.minimum(np.arange(start, min(start + 200_000, total)) * 1e-4, timed.duration)
        q, dq, ddq = timed.evaluate(t)
        worst = max(
            worst,
            float((dq / limits.velocity).max()) - 1,
            float((dq / limits.velocity_lower).max()) - 1,
            float((ddq / limits.acceleration).max()) - 1,
            float((ddq / limits.acceleration_lower).max()) - 1,
        )
        span = np.where(np.isfinite(limits.upper - limits.lower), limits.upper - limits.lower, 1.0)
        worst = max(worst, float(((q - limits.upper) / span).max()))
        worst = max(worst, float(((limits.lower - q) / span).max()))
    return worst


def study(cases: list[Case], compare_up_to: int) -> None:
    """Time every case and print excess, distance from the optimum, and verdicts."""
    worst, gaps, failed, slow = -1.0, [], [], []
    for number, (kind, waypoints, limits) in enumerate(cases):
        start = time.perf_counter()
        try:
            path = JointPath.through(waypoints, limits)
            timed = time_joint_path(path, limits)
        except TimingFailed as error:
            failed.append((number, kind, error.detail))
            continue
        slow.append(time.perf_counter() - start)
        worst = max(worst, excess(timed, limits))
        if timed.duration == 0.0 or len(timed.s) > compare_up_to:
            continue
        n = len(timed.pieces)
        fine = np.interp(np.arange(10 * n + 1) / 10.0, np.arange(n + 1), timed.s)
        best = toppra_duration(path, limits, fine)
        if best is not None:
            gaps.append((timed.duration / best - 1.0, number, kind, n))
        if sys.stderr.isatty():
            print(f"\r{number + 1}/{len(cases)}", end="", file=sys.stderr)
    print(f"  paths                         {len(cases)}")
    print(f"  without a timing (verdicts)   {len(failed)}  {failed[:3]}")
    print(f"  greatest excess at 10 kHz     {worst:.2e} (relative; negative: inside)")
    print(f"  seconds a path, median, worst {statistics.median(slow):.4f} {max(slow):.3f}")
    if gaps:
        gaps.sort(reverse=True)
        print(f"  compared with toppra, 10x     {len(gaps)} paths")
        print(
            f"  duration over it, median      {100 * statistics.median(g[0] for g in gaps):.3f} %"
        )
        print(f"  duration over it, worst       {100 * gaps[0][0]:.3f} %  {gaps[:5]}")
        print(f"  duration over it, least       {100 * gaps[-1][0]:.3f} %  {gaps[-1][1:]}")


def jerk_study(cases: list[Case], multiple: float) -> None:
    """Time cases under jerk limits, a multiple of the acceleration limits, and print the price."""
    prices, seconds, worst_jerk, worst = [], [], 0.0, -1.0
    for _, waypoints, free in cases:
        most = multiple * np.minimum(free.acceleration, -free.acceleration_lower)
        limits = JointLimits(
            free.lower,
            free.upper,
            free.velocity,
            free.acceleration,
            free.joint_names,
            free.velocity_lower,
            free.acceleration_lower,
            most,
        )
        start = time.perf_counter()
        timed = time_joint_path(JointPath.through(waypoints, limits), limits)
        seconds.append(time.perf_counter() - start)
        worst = max(worst, excess(timed, free))
        if timed.duration > 0.0:
            t = np.arange(0.0, timed.duration, 1e-3)
            jerk = np.abs(np.diff(timed.evaluate(t)[2], axis=0)) * 1e3 / most
            worst_jerk = max(worst_jerk, float(jerk.max(initial=0.0)))
            prices.append(timed.duration / timed.unlimited_duration - 1.0)
    print(f"  jerk limit {multiple:g} x acceleration limit a second")
    print(f"    greatest jerk at 1 kHz        {worst_jerk:.4f} x limit (finite differences)")
    print(f"    greatest excess, other limits {worst:.2e}")
    print(f"    longer than without, median   {100 * statistics.median(prices):.1f} %")
    print(f"    seconds, median, worst        {statistics.median(seconds):.3f} {max(seconds):.3f}")


def median_time(call: Callable[[], object], repeats: int, loops: int) -> float:
    """Return the median over repeats of the mean processor time of a call, all threads [s]."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(loops):
            call()
        times.append((time.process_time() - start) / loops)
    return statistics.median(times)


def cost() -> None:
    """Print what the timing of the helix costs, in forward kinematics calls."""
    robot = load_robot("iiwa14")
    limits = JointLimits.from_robot(robot)
    turn = np.linspace(0.0, 4.0 * np.pi, 20)[:, None]
    q = 0.3 * np.sin(turn + np.arange(7)) + 0.05 * turn * np.array([0, 0.1, 0.5, 0.1, 0.2, 0, 1])
    model, data, home = robot.model, robot.model.createData(), robot.configuration(robot.home)
    path = JointPath.through(q, limits)
    timed = time_joint_path(path, limits)
    n = len(timed.s)
    uniform = np.linspace(0.0, path.length, 201)
    jobs: dict[str, Callable[[], object]] = {
        "path": lambda: JointPath.through(q, limits),
        "timing": lambda: time_joint_path(path, limits),
        "sampling at 250 Hz": lambda: sample(timed, 250.0),
        "exact check of limits": lambda: [s.problem.limit_ratios(s.x) for s in timed.spans],
        "toppra alone, 200 uniform": lambda: toppra_duration(path, limits, uniform),
    }
    best = dict.fromkeys(jobs, np.inf)
    fk = np.inf
    for _ in range(5):
        fk = min(fk, median_time(lambda: pin.framesForwardKinematics(model, data, home), 5, 2000))
        for name, job in jobs.items():
            best[name] = min(best[name], median_time(job, 5, 3))
    print(f"  one framesForwardKinematics   {fk * 1e6:.2f} us;  grid of {n} nodes")
    for name, seconds in best.items():
        print(f"  {name:29s} {seconds * 1e3:7.2f} ms = {seconds / fk:8.0f} x FK")
    total = sum(v for k, v in best.items() if not k.startswith("toppra"))
    print(f"  {'all of it':29s} {total * 1e3:7.2f} ms = {total / fk:8.0f} x FK")


def main() -> None:
    """Run the studies asked for; a count of 0 leaves one out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-cost", dest="cost", action="store_false", help="not the helix")
    parser.add_argument("--robots", type=int, default=500, help="paths over six robots")
    parser.add_argument("--wild", type=int, default=2000, help="paths of every kind")
    parser.add_argument("--jerk", type=int, default=60, help="paths timed under jerk limits")
    parser.add_argument(
        "--further", type=int, default=20, help="paths a robot under torque and tool limits"
    )
    parser.add_argument(
        "--compare-up-to", type=int, default=3000, help="largest grid compared with toppra"
    )
    options = parser.parse_args()
    if options.cost:
        print("cost of a helix of 20 waypoints, 7 joints")
        cost()
    if options.robots:
        print("random joint paths over", ", ".join(ROBOTS))
        study(robot_cases(options.robots), options.compare_up_to)
    if options.wild:
        print("random paths of every kind, 2 to 500 waypoints, 1 to 12 joints")
        study(wild_cases(options.wild), options.compare_up_to)
    if options.jerk:
        print("the first of the paths over six robots, under jerk limits")
        for multiple in (5.0, 20.0, 100.0):
            jerk_study(robot_cases(options.jerk), multiple)
    if options.further:
        print("torque limits at half of what the free motion takes beyond gravity")
        torque_study(options.further)
        print("tool speed and acceleration limits")
        tool_study(options.further)
        print("straight lines under a tool speed limit of 0.1 m/s")
        steady_study()


if __name__ == "__main__":
    main()
