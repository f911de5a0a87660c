"""Targets of a comparison."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.ik.arguments import check_start, target_of
from ikplan.ik.metaheuristic_seeds import generator
from ikplan.kinematics.target import Target
from ikplan.robots import Robot

__all__ = ["Problems", "make_problems"]

_DRAWN = 7
"""Context of the random numbers that draw targets: those of the searches are others."""


class Problems(NamedTuple):
    """What every solver is given.

    Attributes:
        targets: Tool poses or positions wanted.
        starts: Start configuration of each, shape (n, dof) [rad or m].
    """

    targets: list[Target]
    starts: Array


def make_problems(
    robot: Robot,
    targets: Any,
    kind: str,
    start: ArrayLike | None,
    start_distance: float | None,
    seed: int,
) -> Problems:
    """Return the targets of a comparison, given or drawn.

    Args:
        robot: The robot.
        targets: How many to draw, or a list of poses as for :func:`ikplan.solve_ik`.
        kind: What is drawn, "position" or "pose": that of a random configuration within the limits.
        start: Start configuration of all, shape (dof,) [rad or m]; None: home.
        start_distance: Where targets are drawn: each start is its configuration with every joint
            moved by up to this angle, to either side [rad], within the limits; None: ``start``.
        seed: Seed of what is drawn.

    Raises:
        InvalidRequest: An argument is wrong.
    """
    if kind not in ("position", "pose"):
        raise InvalidRequest(
            f"kind: must be position or pose, not {kind!r}",
            field="kind",
            allowed=["position", "pose"],
        )
    q_start = np.array(robot.home) if start is None else check_start(robot, start)
    if not isinstance(targets, int | np.integer):
        given = [target_of(pose) for pose in targets]
        if not given or start_distance is not None:
            raise InvalidRequest(
                "targets: a list must hold one at least, and goes with `start`, not with "
                "`start_distance`",
                field="targets",
            )
        return Problems(given, np.tile(q_start, (len(given), 1)))
    if targets < 1:
        raise InvalidRequest("targets: must be 1 at least", field="targets", allowed="at least 1")
    if start_distance is not None and (start is not None or not 0.0 < start_distance < np.inf):
        raise InvalidRequest(
            "start_distance: must be a finite angle above 0, and goes without `start`",
            field="start_distance",
            allowed="a finite number above 0",
        )
    rng = generator(seed, _DRAWN)
    drawn, starts = [], np.tile(q_start, (int(targets), 1))
    for k in range(int(targets)):
        q = robot.random_configuration(rng)
        pose = robot.fk(q)
        drawn.append(target_of(pose if kind == "pose" else pose.translation))
        if start_distance is not None:
            moved = q + start_distance * rng.uniform(-1.0, 1.0, robot.dof)
            starts[k] = np.clip(moved, robot.lower, robot.upper)
    return Problems(drawn, starts)
