"""A dense search over the self-motion of an arm along a line: which windows can be passed at all.

Layer by layer along the line, the part of the self-motion manifold that the arm gets to is flooded:
from every configuration reached, random neighbours are brought onto the line, kept where they are
free, apart from others and joined to it by a motion that stays on the line, and flooded on within
the layer. What is found is confirmed at close places by coal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.collision.oracle import Oracle
from ikplan.collision.checker import CollisionChecker
from ikplan.kinematics.arm import Arm, arm_of
from ikplan.kinematics.target import Freedom
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.tracking_kernels import project_onto_targets
from ikplan.robots import Robot

__all__ = ["FloodedLine", "flood_line"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_LAYER = 0.01
"""Distance of layers [m]."""
_APART = 0.12
"""Configurations of a layer are at least this far apart in some joint [rad]."""
_MOST = 2500
"""Configurations of a layer."""
_WIDTHS = (0.15, 0.3)
"""How far neighbours are tried, one after the other [rad]."""
_ROUNDS = 60
"""Rounds of flooding a layer, at most."""
_BATCH = 400
"""Neighbours of a round."""
_EXACT = 1e-9
_CLOSE = 0.02
"""Joint motion between places that coal looks at [rad]."""


@dataclass(frozen=True)
class FloodedLine:
    """What a dense search found.

    Attributes:
        reached: How far along the line a free motion gets [m].
        length: Length of the line [m].
        q: Configurations from begin to end, shape (m, dof) [rad], and
        s: their places, shape (m,) [m]; empty where none gets to the end.
        counts: Configurations of each layer.
    """

    reached: float
    length: float
    q: Array
    s: Array
    counts: list[int]

    @property
    def passed(self) -> bool:
        """Whether a free motion gets to the end."""
        return len(self.q) > 0


class _Flood:
    """A line, and configurations on it that are reached."""

    def __init__(
        self, robot: Robot, oracle: Oracle, q_start: Array, end: Array, freedom: Freedom
    ) -> None:
        self.arm: Arm = arm_of(robot)
        self.check = CollisionChecker(robot, oracle.model)
        T = robot.fk(q_start)
        self.R, self.begin, self.end = T.rotation.copy(), T.translation.copy(), end
        self.length = float(np.linalg.norm(end - self.begin))
        self.freedom = freedom
        self.rng = np.random.default_rng(0)

    def targets(self, s: Array) -> Targets:
        """The targets of places, shape (m,)."""
        m = len(s)
        p = self.begin + (self.end - self.begin) * (s / self.length)[:, None]
        R = np.ascontiguousarray(np.broadcast_to(self.R, (m, 3, 3)))
        on = np.ones(m, dtype=np.bool_)
        return Targets(R, np.ascontiguousarray(p), on, np.full(m, 0.3), self.freedom)

    def onto(self, s: Array, q: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Configurations brought onto the line, and which got there."""
        q = np.ascontiguousarray(np.clip(q, self.arm.lower, self.arm.upper))
        left, _ = project_onto_targets(
            self.arm.chain, self.targets(s), q, self.arm.lower, self.arm.upper
        )
        return q, np.asarray(left <= _EXACT)

    def joined(self, s_a: float, a: Array, s_b: float, b: Array) -> bool:
        """Whether the arm gets from one to the other along the line, clear of contact."""
        if np.abs(b - a).max() > 0.5:
            return False
        at = np.array([0.25, 0.5, 0.75])
        straight = a + at[:, None] * (b - a)
        q, met = self.onto(s_a + at * (s_b - s_a), straight)
        if not met.all():
            return False
        if np.linalg.norm(q - straight, axis=1).max() > 0.25 * np.linalg.norm(b - a) + 1e-7:
            return False
        return self.check.first_contact(np.vstack([a, q, b])) is None

    def spread(self, s_from: float, rows: Array, s: float, into: list[Array], width: float) -> Ints:
        """Add neighbours of configurations at one place that are on the line at another.

        Returns:
            For each one added, the row that it is a neighbour of.
        """
        parents: list[int] = []
        tried = rows + width * self.rng.normal(size=rows.shape)
        q, met = self.onto(np.full(len(rows), s), tried)
        free = met & self.check.free(q)
        for k in np.flatnonzero(free):
            if len(into) >= _MOST:
                break
            if into and (np.abs(np.array(into) - q[k]).max(axis=1) < _APART).any():
                continue
            if self.joined(s_from, rows[k], s, q[k]):
                into.append(q[k])
                parents.append(int(k))
        return np.array(parents, dtype=np.int64)


def flood_line(
    robot: Robot, oracle: Oracle, q_start: Array, end: Array, freedom: Freedom
) -> FloodedLine:
    """Search for a free motion along a line from a configuration.

    Args:
        robot: The robot.
        oracle: The bodies.
        q_start: The configuration, shape (dof,) [rad].
        end: Where the line ends in the base, shape (3,) [m].
        freedom: What the orientation leaves free.
    """
    flood = _Flood(robot, oracle, q_start, end, freedom)
    s = np.linspace(0.0, flood.length, int(np.ceil(flood.length / _LAYER)) + 1)
    layers: list[Array] = []
    origins: list[list[tuple[int, int]]] = []  # layer and row of each one's parent
    for k, here in enumerate(s):
        into: list[Array] = []
        origin: list[tuple[int, int]] = []
        if k == 0:
            into, origin = [q_start], [(-1, -1)]
        else:
            for width in (0.0, *_WIDTHS):
                parents = flood.spread(float(s[k - 1]), layers[-1], float(here), into, width)
                origin += [(k - 1, int(p)) for p in parents]
        idle = 0
        for turn in range(_ROUNDS):
            if not into or len(into) >= _MOST or idle > 3:
                break
            chosen = flood.rng.integers(0, len(into), _BATCH)
            rows = np.array(into)[chosen]
            before = len(into)
            width = _WIDTHS[turn % len(_WIDTHS)]
            parents = flood.spread(float(here), rows, float(here), into, width)
            origin += [(k, int(chosen[p])) for p in parents]
            idle = 0 if len(into) > before + before // 50 else idle + 1
        counts = [len(layer) for layer in layers]
        if not into:
            empty = np.empty((0, robot.dof))
            return FloodedLine(float(s[max(k - 1, 0)]), flood.length, empty, np.empty(0), counts)
        layers.append(np.array(into))
        origins.append(origin)
    counts = [len(layer) for layer in layers]
    way, places = list[Array](), list[float]()
    at = (len(layers) - 1, 0)
    while at[0] >= 0:
        way.append(layers[at[0]][at[1]])
        places.append(float(s[at[0]]))
        at = origins[at[0]][at[1]]
    q, along = np.array(way[::-1]), np.array(places[::-1])
    if not _confirmed(flood, oracle, along, q):
        return FloodedLine(-1.0, flood.length, np.empty((0, robot.dof)), np.empty(0), counts)
    return FloodedLine(flood.length, flood.length, q, along, counts)


def _confirmed(flood: _Flood, oracle: Oracle, s: Array, q: Array) -> bool:
    """Whether coal finds a motion free at close places."""
    for a, b, s_a, s_b in zip(q, q[1:], s, s[1:], strict=False):
        n = max(2, int(np.ceil(np.abs(b - a).max() / _CLOSE)))
        at = np.linspace(0.0, 1.0, n + 1)
        rows, met = flood.onto(s_a + at * (s_b - s_a), a + at[:, None] * (b - a))
        if not met.all() or any(oracle.distances(row).min() <= 0.0 for row in rows):
            return False
    return True
