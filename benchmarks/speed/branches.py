"""All branches of a pose in closed form: the method, and what a planner's waypoint costs."""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from benchmarks.speed.measure import Figure, FkClock, Section
from ikplan import load_robot, solve_ik
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import pose_target
from ikplan.planning.ladder.ik_candidates import IkCandidates, sample_ik_solutions
from ikplan.planning.waypoints.stack import stack_targets

__all__ = ["SECTION"]

ROBOTS = ("ur5", "kuka_kr6_r900_2", "staubli_rx160", "kinova_j2s6s200")
FK = 0.55e-6
"""One call of the forward kinematics where the goals were set [s]."""


def _study(name: str, count: int, repeats: int) -> Iterator[Figure]:
    robot = load_robot(name)
    arm, rng = arm_of(robot), np.random.default_rng(2026)
    poses = [robot.fk(robot.random_configuration(rng)) for _ in range(count)]
    worst = 0.0
    for pose in poses:
        q = solve_ik(robot, pose, method="closed-form").q
        worst = max(worst, float(np.abs(pin.log6(robot.fk(q).actInv(pose)).vector).max()))
    calls = [functools.partial(solve_ik, robot, pose, method="closed-form") for pose in poses]
    clock = FkClock(robot)
    yield Figure(f"{name}: worst error of {count} poses", worst, "m, rad", most=1e-6)
    yield Figure(f"{name}: solve_ik", clock.ratio(calls, repeats), "x FK", most=20.0)
    targets = stack_targets([pose_target(pose.translation, pose.rotation) for pose in poses])
    no_seeds, home = np.empty((count, 0, arm.dof)), np.array(robot.home)

    def waypoints() -> IkCandidates:
        return sample_ik_solutions(
            arm.chain,
            targets,
            no_seeds,
            home,
            arm.lower,
            arm.upper,
            40,
            100,
            4,
            0.5,
            1e-9,
            arm.closed_form,
        )

    waypoints()
    ratio = clock.ratio([waypoints] * 3, repeats) / count
    yield Figure(f"{name}: candidates of a waypoint", ratio, "x FK", most=1e-5 / FK)


def run(effort: float) -> list[Figure]:
    """Solve and time poses on each arm."""
    count, repeats = max(20, int(500 * effort)), max(1, round(5 * effort))
    return [figure for name in ROBOTS for figure in _study(name, count, repeats)]


SECTION = Section("branches", "random reachable poses in closed form, solve_ik() from home", run)
