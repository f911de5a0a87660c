"""Play programs and samples as controllers do: ``python -m benchmarks.programs``.

Random plans are written as programs, read back and played at the controller's cycle: URScript
beside the plan, the others beside the certificate of the thinned program. Those of Franka arms
are judged by libfranka's difference formulas. Ends with exit code 1 if one is out of bounds.
"""

from __future__ import annotations

import argparse
import itertools
import sys

from benchmarks.programs.fci import FER, FR3, FciLimits, judge
from benchmarks.programs.plans import random_plans
from benchmarks.programs.playing import compare
from benchmarks.programs.points import judge as judge_points
from ikplan.errors import InvalidRequest
from ikplan.plans.programs.certifying import limits_of
from ikplan.robots import load_robot

_UR = {"cb3": (("ur3", "ur5", "ur10"), 0.008), "e-series": (("ur3e", "ur5e", "ur10e"), 0.002)}
_FRANKA: dict[str, FciLimits] = {"panda": FER, "fr3": FR3}
_POINTS = {
    "rapid": ("abb_irb2400_12_155", "abb_irb6640_185_280"),
    "krl": ("kuka_kr10_r1100_2", "kuka_kr6_r900_sixx", "kuka_kr210_r2700_2"),
    "fanuc-ls": ("fanuc_m10ia", "fanuc_lrmate200id", "fanuc_crx10ia"),
    "drl": ("doosan_m1013", "doosan_a0509"),
    "xarm": ("xarm7", "xarm6", "xarm5", "lite6"),
    "franky": ("panda", "fr3"),
}
_JOINTS = 1e-4
_TOOL = 1e-6
_TIME = 1e-9


def _programs(variant: str, seed: int, count: int) -> bool:
    robots, cycle = _UR[variant]
    worst, written, too_long = [0.0] * 4, 0, 0
    for plan in random_plans(robots, seed):
        if written == count:
            break
        try:
            found = compare(plan, load_robot(plan.robot), cycle)
        except InvalidRequest:
            too_long += 1
            continue
        written += 1
        figures = (abs(found.duration), found.joints, found.tool, found.off_grid)
        worst = [max(pair) for pair in zip(worst, figures, strict=True)]
    time, joints, tool, off_grid = worst
    print(
        f"{variant}: {written} programs played at {1e3 * cycle:g} ms, {too_long} refused as too "
        f"long; longer than the plan by {time:.1e} s at most, joints {joints:.1e} rad, tool "
        f"{tool:.1e} m, last sample off the grid {off_grid:.1e} s"
    )
    return time <= _TIME and joints <= _JOINTS and tool <= _TOOL and off_grid <= _TIME


def _points(language: str, seed: int, count: int) -> bool:
    kept, refused, fewer, slower, deviation = 0, 0, [], [], 0.0
    for plan in random_plans(_POINTS[language], seed):
        if kept + refused == count:
            break
        if plan.duration == 0.0:
            continue  # it does not move
        robot = load_robot(plan.robot)
        try:
            found = judge_points(plan, robot, language, limits_of(plan, robot))
        except InvalidRequest as error:
            refused += 1
            print(f"{language}: {plan.robot}, {plan.duration:.3f} s refused: {error.detail}")
            continue
        if not found.kept:
            print(f"{language}: {plan.robot}, {plan.duration:.3f} s out of bounds: {found}")
            return False
        kept += 1
        fewer.append(250.0 * plan.duration / found.certificate.points)
        slower.append(found.certificate.time_factor)
        deviation = max(deviation, found.deviation)
    fewer.sort()
    slower.sort()
    half = len(fewer) // 2
    print(
        f"{language}: {kept} programs played within their certificates, {refused} refused; tool "
        f"{deviation:.1e} m off the path at most; points {fewer[0]:.1f} to {fewer[-1]:.1f} times "
        f"fewer than at 250 Hz, median {fewer[half]:.1f}; time {slower[half]:.3f} times the "
        f"plan's in the median, {slower[-1]:.3f} at most"
    )
    return refused == 0


def _fci(name: str, seed: int, count: int) -> bool:
    cycles = over = with_margin = 0
    shares, end = [0.0] * 3, 0.0
    for plan in itertools.islice(random_plans((name,), seed), count):
        found = judge(plan.time, plan.q, plan.ddq, _FRANKA[name])
        cycles, over = cycles + found.cycles, over + found.over
        with_margin += found.over_with_margin
        figures = (found.velocity, found.acceleration, found.jerk)
        shares = [max(pair) for pair in zip(shares, figures, strict=True)]
        end = max(end, found.end_acceleration)
    print(
        f"{name}: {count} plans, {cycles} cycles of 1 ms, {over} over a limit; largest share of "
        f"velocity {shares[0]:.4f}, acceleration {shares[1]:.4f}, jerk {shares[2]:.4f}; "
        f"acceleration at the ends {end:.1e}; {with_margin} cycles above the speeds less the "
        "margin for lost packets"
    )
    return over == 0 and end == 0.0


def main() -> int:
    """Play, judge, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=12, help="which series of requests")
    parser.add_argument("--plans", type=int, default=50, help="plans a language and an arm")
    every = ("urscript", *_POINTS, "fci")
    parser.add_argument("--languages", nargs="+", choices=every, default=every)
    options = parser.parse_args()
    kept = []
    if "urscript" in options.languages:
        kept += [_programs(variant, options.seed, options.plans) for variant in _UR]
    kept += [
        _points(language, options.seed, options.plans)
        for language in _POINTS
        if language in options.languages
    ]
    if "fci" in options.languages:
        kept += [_fci(name, options.seed, options.plans) for name in _FRANKA]
    return 0 if all(kept) else 1


if __name__ == "__main__":
    sys.exit(main())
