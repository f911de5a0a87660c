"""Follow a target that jumps at 10 Hz: each tenth of a second a new motion from the state then.

Prints, for each piece, its duration, how far position and velocity jump to it, and what its
certificate says.
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

import ikplan

Array = NDArray[np.float64]

CYCLE = 0.1
"""Time between two targets [s]."""


def pieces(robot: ikplan.Robot, q: Array, targets: Array) -> list[ikplan.Plan]:
    """Plan a motion to each target from the state of the motion before, a cycle after its begin.

    Args:
        robot: The robot.
        q: Joint values at the begin, at rest, shape (dof,) [rad or m].
        targets: Joint values to go to, one after the other, shape (n, dof) [rad or m].
    """
    plans: list[ikplan.Plan] = []
    dq = np.zeros_like(q)
    for target in targets:
        plan = ikplan.time_path(robot, [q, target], start_velocity=dq)
        q, dq, _ = plan.at(CYCLE)
        plans.append(plan)
    return plans


def main() -> int:
    """Follow twenty targets with a UR5 and print what happens."""
    robot = ikplan.load_robot("ur5")
    rng = np.random.default_rng(0)
    home = np.array([0.0, -1.2, 1.5, -1.8, -1.5, 0.2])
    targets = home + rng.uniform(-0.8, 0.8, (20, robot.dof))
    before: tuple[Array, Array] | None = None
    for k, plan in enumerate(pieces(robot, home, targets)):
        jump = [0.0, 0.0]
        if before is not None:
            jump = [float(np.abs(a - b).max()) for a, b in zip(before, plan.at(0.0), strict=False)]
        before = plan.at(CYCLE)[:2]
        print(
            f"{k * CYCLE:.1f} s: {plan.duration:.3f} s to the target, jumps of {jump[0]:.1e} rad "
            f"and {jump[1]:.1e} rad/s, certified: {plan.certificate.valid}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
