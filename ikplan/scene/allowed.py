"""Which links of a robot may touch: a rule without choice, and what its description says.

Two links may touch if

1. the SRDF of the robot says so (``disable_collisions``, with its reason), or its ``robot.yaml``;
2. they are adjacent: one is the nearest link with a shape above the other, and one joint of the
   chain is between them;
3. they touch in each of 256 configurations spread over the joint limits.

A pair that touches in none of them is checked all the same: that nothing was seen is no proof. For
the same reason a pair is checked that an SRDF gives the reason "Never", which its author's sampling
found; unless our shapes touch in one of the 256 configurations: they enclose the links, and what
touches there is what is between.
Links on one carrier never move against each other and are never checked.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ikplan.robots import Robot
from ikplan.robots.definition.collision import CollisionEntry
from ikplan.robots.urdf.srdf import read_allowed_pairs
from ikplan.scene.body import Body
from ikplan.scene.contacts import Contacts
from ikplan.scene.poses import carrier_poses
from ikplan.scene.robot_bodies import RobotBodies, SameBodies, robot_bodies

__all__ = ["SAMPLES", "SelfPairs", "self_pairs", "spread_configurations"]

Array = NDArray[np.float64]

SAMPLES = 256
"""Configurations in which a pair must touch to count as always touching."""

_NEVER = "SRDF: Never"
_ALWAYS = f"touch in each of {SAMPLES} configurations spread over the joint limits"

SelfPairs = tuple[NDArray[np.int64], tuple[tuple[str, str, str], ...]]
"""Indices of the bodies to be kept apart, shape (n, 2); names that may touch, and why."""


def self_pairs(robot: Robot, fixed_joints: Mapping[str, float] | None = None) -> SelfPairs:
    """Return the pairs of a robot's links that must not touch, and those that may.

    Args:
        robot: The robot.
        fixed_joints: Values of joints beside the chain [rad or m].

    Raises:
        InvalidRequest: No such joint beside the chain, or a value outside its limits.
        InvalidRobot: A shape or the SRDF makes no sense.
    """
    return _pairs(SameBodies(robot), tuple(sorted((fixed_joints or {}).items())))


def spread_configurations(robot: Robot, count: int) -> Array:
    """Configurations spread evenly over the joint limits, shape (count, dof) [rad or m].

    The additive recurrence of M. Roberts (2018): multiples of the powers of 1/g, g the root of
    x^(dof + 1) = x + 1, each modulo 1. Joints that turn without end are spread over one turn.
    """
    g = 2.0
    for _ in range(60):
        g = (1.0 + g) ** (1.0 / (robot.dof + 1))
    steps = g ** -np.arange(1.0, robot.dof + 1.0)
    shares = (0.5 + np.outer(np.arange(count), steps)) % 1.0
    lower = np.where(robot.continuous, -np.pi, robot.lower)
    upper = np.where(robot.continuous, np.pi, robot.upper)
    spread: Array = lower + shares * (upper - lower)
    return spread


@functools.lru_cache(maxsize=64)
def _pairs(same: SameBodies, fixed: tuple[tuple[str, float], ...]) -> SelfPairs:
    robot = same.robot
    found = robot_bodies(robot, dict(fixed))
    bodies = found.bodies
    said = _said(robot)
    allowed: dict[frozenset[str], str] = {}
    pairs = []
    for i, a in enumerate(bodies):
        for j in range(i + 1, len(bodies)):
            b = bodies[j]
            if a.carrier == b.carrier:
                continue
            names = frozenset((a.name, b.name))
            if names in said and said[names] != _NEVER:
                allowed[names] = said[names]
            elif _adjacent(a, b, found):
                allowed[names] = "adjacent"
            else:
                pairs.append((i, j))
    apart = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    named = [frozenset((bodies[i].name, bodies[j].name)) for i, j in apart]
    never = np.array([said.get(names) == _NEVER for names in named], dtype=np.bool_)
    touches = _touches(robot, bodies, apart, never)
    always, seen = touches == SAMPLES, never & (touches > 0)
    for k in np.flatnonzero(always | seen):
        allowed[named[k]] = _ALWAYS if always[k] else f"{_NEVER}; our shapes are larger and do"
    order = {body.name: k for k, body in enumerate(bodies)}
    listed = sorted((sorted(names, key=order.__getitem__), why) for names, why in allowed.items())
    return apart[~(always | seen)], tuple((a, b, why) for (a, b), why in listed)


def _said(robot: Robot) -> dict[frozenset[str], str]:
    """Pairs that the robot's description allows, and why."""
    source = robot.description.shapes
    pairs = read_allowed_pairs(source.srdf, robot=robot.name) if source.srdf else []
    said = {frozenset((a, b)): f"SRDF: {why}" for a, b, why in pairs}
    entry = CollisionEntry.model_validate_json(source.shapes or b"{}")
    return {**said, **{frozenset((a, b)): why for a, b, why in entry.allow}}


def _adjacent(a: Body, b: Body, found: RobotBodies) -> bool:
    shaped = {body.name for body in found.bodies}
    return any(
        _above(lower.name, shaped, found) == upper.name and lower.carrier - upper.carrier == 1
        for lower, upper in ((a, b), (b, a))
    )


def _above(link: str, shaped: set[str], found: RobotBodies) -> str | None:
    """The nearest link above that has a shape."""
    parent = found.links.parent.get(link)
    while parent is not None and parent not in shaped:
        parent = found.links.parent.get(parent)
    return parent


def _touches(
    robot: Robot,
    bodies: tuple[Body, ...],
    pairs: NDArray[np.int64],
    counted: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """In how many of the configurations pairs touch.

    Pairs that are not to be counted are left aside once they are seen apart.
    """
    count = np.zeros(len(pairs), dtype=np.int64)
    if not len(pairs):
        return count
    contacts = Contacts(bodies, pairs)
    for k, q in enumerate(spread_configurations(robot, SAMPLES)):
        still = np.flatnonzero((count == k) | counted)
        if not len(still):
            break
        count[still] += contacts.touching(*carrier_poses(robot, q), still)
    return count
