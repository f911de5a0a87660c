"""Around obstacles along a tool path, where few ways lead: the whole of what can be reached.

Layer by layer along the path, what the arm gets to of its self-motion is flooded (see
:mod:`ikplan.planning.around.flood_kernels`). Layers are filled sparsely first, and denser where
that leads nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array
from ikplan.planning.around.flood_kernels import FloodTree, flood_layer
from ikplan.planning.around.path_ladder import LONGEST, PathLadder
from ikplan.planning.segment_number import segment_number
from ikplan.planning.tracking.reference_path import (
    ReferencePath,
    initial_points,
    positions_missing,
)
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm

__all__ = ["flooded_sequences"]

_LAYER, _LAYER_SHARE = 0.01, 0.01
"""Length of a layer [m], and at least as a share of the path."""
_GRID = 32
"""Places of a layer."""
_EFFORTS = ((60, 0.003), (60, 0.0), (300, 0.003), (300, 0.0))
"""Nodes of a layer, and the gap on top of what is asked for [m], one after the other."""
_SPARSE = 2
"""So many of them, the first ones, take little time."""
_TRIES = 12
"""Neighbours tried for a node of a full layer."""
_WIDTHS = (0.08, 0.2, 0.4)
"""How far neighbours are tried [rad or m]."""
_AHEAD = (8, 4, 2)
"""By how many nodes a step of a way may be longer, the longest first."""
_APART = {60: 0.2, 300: 0.12}
"""How far apart nodes of a layer are, by how many there are [rad or m]."""


def flooded_sequences(
    arm: TrackedArm, reference: ReferencePath, starts: Array, *, sparse: bool = False
) -> Iterator[tuple[Array, Array]]:
    """Yield sequences along a path that keep clear of contact, found by ever denser floods.

    Of waypoints and corners close to one another most may be missing in them.

    Args:
        arm: The arm, with what refuses contact.
        reference: The path.
        starts: Configurations at the path's first pose, shape (c, dof) [rad or m].
        sparse: Whether the dense floods, which take long, are left out.

    Yields:
        Path positions, shape (m,), m odd, and configurations, shape (m, dof) [rad or m].

    Raises:
        BudgetExceeded: The time budget ran out.
    """
    assert arm.contact is not None
    for most, extra in _EFFORTS[:_SPARSE] if sparse else _EFFORTS:
        wider = replace(arm, contact=arm.contact.wider(extra))
        found = _Flood(wider, reference, starts, most).sequence()
        if found is not None:
            s, q = _with_fewer_nodes(wider, reference, *found)
            yield s, PathLadder(wider, reference, s).drawn_taut(q[0::2], q[1::2])


def _with_fewer_nodes(
    arm: TrackedArm, reference: ReferencePath, s: Array, q: Array
) -> tuple[Array, Array]:
    """Return a way without the nodes that it can do without; corners and waypoints stay."""
    nodes, node_s = q[0::2], s[0::2]
    required = np.concatenate([reference.corners, reference.waypoint_s])
    kept = np.flatnonzero(np.isin(node_s, required))
    s_way, q_way = [float(s[0])], [q[0]]
    at, last = 0, len(nodes) - 1
    while at < last:
        arm.clock.check()
        bound = min([int(k) for k in kept if k > at], default=last)
        for ahead in _AHEAD:
            to = min(at + ahead, bound)
            half = 0.5 * (node_s[at] + node_s[to])
            if np.abs(nodes[to] - nodes[at]).max() > LONGEST:
                continue
            ladder = PathLadder(arm, reference, np.array([node_s[at], half, node_s[to]]))
            middle = ladder.step(1, nodes[at], nodes[to])
            if middle is not None:
                break
        else:
            to, half, middle = at + 1, float(s[2 * at + 1]), q[2 * at + 1]
        s_way += [float(half), float(node_s[to])]
        q_way += [middle, nodes[to]]
        at = to
    return np.array(s_way), np.ascontiguousarray(q_way)


class _Flood:
    """A tree that grows along a path."""

    def __init__(self, arm: TrackedArm, reference: ReferencePath, starts: Array, most: int) -> None:
        assert arm.contact is not None
        self.arm, self.contact, self.reference, self.most = arm, arm.contact, reference, most
        spacing = max(_LAYER, _LAYER_SHARE * reference.length)
        layers = initial_points(reference, spacing, apart=spacing)
        if len(positions_missing(reference, layers)) > 0:
            layers = layers[
                ::2
            ]  # each about as long as the spacing; half-way points are not needed
        self.layers = layers
        steps = np.arange(_GRID) / _GRID
        grid = (self.layers[:-1, None] + np.diff(self.layers)[:, None] * steps).ravel()
        self.grid = np.append(grid, self.layers[-1])
        halves = np.empty(2 * len(self.grid) - 1)
        halves[0::2], halves[1::2] = self.grid, 0.5 * (self.grid[1:] + self.grid[:-1])
        self.halves = halves
        self.targets = arm.targets_at(reference, halves)
        self.rng = np.random.default_rng(0)
        rows, dof = len(starts) + len(self.layers) * most, starts.shape[1]
        self.tree = FloodTree(
            np.empty((rows, dof)),
            np.empty((rows, dof)),
            np.zeros(rows, dtype=np.int64),
            np.full(rows, -1, dtype=np.int64),
        )
        self.tree.q[: len(starts)] = starts
        self.starts = len(starts)

    def sequence(self) -> tuple[Array, Array] | None:
        """Path positions and configurations of the first way to the end of the path, or None."""
        first, count = 0, self.starts
        for k in range(len(self.layers)):
            if k > 0:
                before, first = first, count
                count = self._flood(k, (before, first), first, count)
                if count == first:
                    return None
            if k + 1 < len(self.layers):
                count = self._flood(k, (first, count), first, count)
        return self._way(first)

    def _flood(self, layer: int, sources: tuple[int, int], first: int, count: int) -> int:
        """Fill a layer from some nodes; returns the number of nodes."""
        self.arm.clock.check()
        arm = self.arm.arm
        places = layer * _GRID, (layer + 1) * _GRID
        arrays = self.contact.arrays(self._segment(layer))
        within = sources[0] >= first
        for width in _WIDTHS:
            count, spent = flood_layer(
                arrays, self.targets, self.tree, sources, first, count, places,
                self.most if within else (self.most + 1) // 2, _TRIES * self.most // 3,
                width, _APART[self.most], (arm.lower, arm.upper), EXACT, self.rng,
            )  # fmt: skip
            self.arm.clock.count(spent)
        return count

    def _segment(self, layer: int) -> int | None:
        """The segment of the request that a layer belongs to, where bodies depend on it."""
        if not self.contact.changes_by_segment:
            return None
        ahead = self.layers[layer : layer + 2]
        at = float(ahead.mean()) if layer + 1 < len(self.layers) else float(ahead[0])
        parts = [x for x in self.reference.segments if x.begin <= at <= x.end]
        return segment_number(parts[0].field) if parts else None

    def _way(self, node: int) -> tuple[Array, Array]:
        """The way through the tree to a node, with its half-way configurations."""
        tree, s, q = self.tree, list[float](), list[Array]()
        while node >= 0:
            place, parent = int(tree.place[node]), int(tree.parent[node])
            s.append(float(self.grid[place]))
            q.append(tree.q[node].copy())
            if parent >= 0:
                s.append(float(self.halves[place + int(tree.place[parent])]))
                q.append(tree.middle[node].copy())
            node = parent
        return np.array(s[::-1]), np.ascontiguousarray(q[::-1])
