"""Dense distances by coal and Pinocchio, against what was proven."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from benchmarks.collision.drawing import draw_case
from benchmarks.collision.oracle import COAL_ERROR, Oracle
from ikplan.certificate.clearance import ClearanceResult, JointCurve, prove_clearance
from ikplan.documents.clearance import NearestPlace
from ikplan.robots import Robot, load_robot
from ikplan.scene.body import CollisionModel

__all__ = ["ROBOTS", "Verdicts", "falsify", "judge"]

Array = NDArray[np.float64]
Prover = Callable[[Robot, CollisionModel, JointCurve], ClearanceResult]

ROBOTS = ("panda", "ur5", "kinova_j2s6s200", "mh5", "dobot_magician", "tiago")
"""Turning, endless, sliding and coupled joints; axes along and across the frames."""
OWN_BODIES = ("panda", "ur5", "ur10", "kinova_j2s6s200", "z1", "iiwa14")
"""Robots whose own bodies are taken: hulls, pieces of split meshes, capsules and cylinders."""
STEP = 5e-4


@dataclass
class Verdicts:
    """What became of many motions.

    Attributes:
        proven: How many were proven.
        refused: How many were not.
        broken: Bounds that a dense distance falls below, in words.
        false: Violations where coal sees none at the place named, in words.
        slack: Dense distance less the bound of each group of each motion [m].
    """

    proven: int = 0
    refused: int = 0
    broken: list[str] = field(default_factory=list)
    false: list[str] = field(default_factory=list)
    slack: list[float] = field(default_factory=list)


def judge(
    verdicts: Verdicts, name: str, robot: Robot, model: CollisionModel, curve: JointCurve,
    result: ClearanceResult, step: float = STEP,
) -> None:  # fmt: skip
    """Hold one result to dense distances.

    Args:
        verdicts: Added to.
        name: Of the motion, for messages.
        robot: The robot.
        model: The bodies.
        curve: The motion.
        result: What was proven.
        step: Most that a joint moves between instants [rad or m].
    """
    oracle = Oracle(robot, model)
    dense = oracle.least(curve, step)
    places: list[NearestPlace] = [result.clearance.self_, result.clearance.scene]
    for place, distance in zip(places, dense, strict=True):
        if place.least is None:
            continue
        verdicts.slack.append(float(distance) - place.least)
        if distance < place.least - COAL_ERROR:
            verdicts.broken.append(f"{name}: {distance} < {place.least}, {place.pair}")
        if place.proven and not distance > 0.0:
            verdicts.broken.append(f"{name}: contact is proven not to be")
    if result.proven:
        verdicts.proven += 1
        return
    verdicts.refused += 1
    violation = result.violation
    assert violation is not None
    if oracle.distances(violation.q).min() > violation.gap + COAL_ERROR:
        verdicts.false.append(f"{name}: {violation}")


def falsify(
    count: int, *, seed: int = 0, first: int = 0, prover: Prover = prove_clearance,
    reach: float = 0.6, step: float = STEP, robots: Sequence[Robot] = (), own: bool = False,
) -> Verdicts:  # fmt: skip
    """Draw motions and hold what is proven of them to dense distances.

    Args:
        count: How many motions.
        seed: Of the random numbers.
        first: Number of the first motion; each has random numbers of its own.
        prover: What is held to them.
        reach: Most that joint values leave those in the middle of a motion [rad or m].
        step: Most that a joint moves between instants [rad or m].
        robots: Taken in turn; none: six of the catalogue.
        own: Whether links have the bodies of the robots' descriptions; otherwise drawn ones.
    """
    robots = robots or [load_robot(name) for name in (OWN_BODIES if own else ROBOTS)]
    verdicts = Verdicts()
    for i in range(first, first + count):
        rng = np.random.default_rng([seed, i])
        robot = robots[i % len(robots)]
        knots = int(rng.integers(2, 6))
        model, curve = draw_case(
            robot, rng, reach=float(rng.uniform(0.2, 1.0)) * reach, knots=knots, obstacles=4,
            own=own,
        )  # fmt: skip
        judge(verdicts, f"{robot.name} {i}", robot, model, curve, prover(robot, model, curve), step)
    return verdicts
