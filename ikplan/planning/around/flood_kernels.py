"""Flooding the self-motion manifold along a path, layer by layer, compiled.

A tree of configurations on the path grows from its begin. Places of the path are numbered on a fine
grid; the nodes of a layer are at the places of one stretch of it. Every edge leads forward along
the path, within a layer by the smallest step, so that a way through the tree is a motion along the
path in which the arm moves much and the tool little where it has to get around something.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices
from ikplan.collision.check import ContactArrays
from ikplan.collision.contact import first_pair
from ikplan.collision.motion import motion_contact
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import Workspace, new_workspace
from ikplan.planning.ladder.ik_candidates import Targets, target_at
from ikplan.planning.tracking.tracking_kernels import MIDPOINT_RATIO

__all__ = ["FloodTree", "flood_layer"]

_STEADY = 2
"""Every so many tries the neighbour tried is the configuration itself, brought further."""

_IDLE = 60
"""Tries without a new node, and two for each node, after which a layer counts as filled."""


class FloodTree(NamedTuple):
    """Configurations along a path.

    Attributes:
        q: Configurations, shape (cap, dof) [rad or m].
        middle: Configuration half-way from the parent, shape (cap, dof) [rad or m].
        place: Number of the place on the grid, shape (cap,).
        parent: Index of each node's parent, -1 of a begin, shape (cap,).
    """

    q: Array
    middle: Array
    place: Indices
    parent: Indices


@kernel
def _joined(
    arrays: ContactArrays,
    targets: Targets,
    tree: FloodTree,
    node: int,
    place: int,
    count: int,
    bounds: tuple[Array, Array],
    exact: float,
    w: Workspace,
) -> bool:
    """Whether the arm gets from a node along the path to the candidate in row ``count``.

    The half-way configuration is written to that row. Targets are those of the grid and of the
    middles between its places.
    """
    q, before, middle = tree.q[count], tree.q[node], tree.middle[count]
    step = 0.0
    for d in range(q.shape[0]):
        middle[d] = 0.5 * (before[d] + q[d])
        step += (q[d] - before[d]) ** 2
    target = target_at(targets, tree.place[node] + place)
    distance, angle, _ = refine(arrays.chain, target, middle, bounds[0], bounds[1], Effort(8, 8), w)
    if distance > exact or angle > exact:
        return False
    off = 0.0
    for d in range(q.shape[0]):
        off += (middle[d] - 0.5 * (before[d] + q[d])) ** 2
    if math.sqrt(off) > MIDPOINT_RATIO * math.sqrt(step) + 1e-7:
        return False
    for half in range(2):
        row, _ = motion_contact(
            arrays.chain, arrays.bodies, arrays.active, arrays.margin,
            middle if half else before, q if half else middle, arrays.scratch,
        )  # fmt: skip
        if row >= 0:
            return False
    return True


@kernel
def flood_layer(
    arrays: ContactArrays,
    targets: Targets,
    tree: FloodTree,
    sources: tuple[int, int],
    first: int,
    count: int,
    places: tuple[int, int],
    most: int,
    tries: int,
    width: float,
    apart: float,
    bounds: tuple[Array, Array],
    exact: float,
    rng: np.random.Generator,
) -> tuple[int, int]:
    """Add nodes to a layer from neighbours of nodes of the layer before, or of the same.

    Args:
        arrays: The arm and what must not be touched.
        targets: Targets of the places of the grid and of the middles between them, 2 n - 1.
        tree: The nodes; rows from ``count`` on are written.
        sources: Neighbours of the nodes from the first of these to before the second are tried.
        first: First node of the layer.
        count: Number of nodes so far.
        places: First place of the layer, and first place of the next one. Within the layer, a node
            is one place after its parent.
        most: Number of nodes at which the layer is full.
        tries: How many neighbours are tried.
        width: Standard deviation of neighbours [rad or m].
        apart: Nodes of a layer are at least this far apart in some joint [rad or m].
        bounds: Lower and upper position limits, shape (dof,) each [rad or m].
        exact: Error that counts as none [m and rad].
        rng: Draws the neighbours.

    Returns:
        The number of nodes, and evaluations spent.
    """
    chain, dof = arrays.chain, tree.q.shape[1]
    w = new_workspace(chain)
    lower, upper = bounds
    need = arrays.bodies.clearance + arrays.margin
    within = sources[0] >= first
    evaluations = idle = 0
    for attempt in range(tries):
        idle += 1
        if within and idle > _IDLE + 2 * (count - first):
            break
        last = count if within else sources[1]
        if count - first >= most or count >= tree.q.shape[0]:
            break
        if within:
            node = sources[0] + int(rng.random() * (last - sources[0]))
        else:
            node = sources[0] + attempt // _STEADY % (last - sources[0])
        place = tree.place[node] + 1 if within else places[0]
        if place >= places[1]:
            continue
        q = tree.q[count]
        noisy = within or attempt % _STEADY > 0
        for d in range(dof):
            q[d] = tree.q[node, d]
            if noisy:
                q[d] += width * rng.normal()
            q[d] = min(max(q[d], lower[d]), upper[d])
        target = target_at(targets, 2 * place)
        distance, angle, spent = refine(chain, target, q, lower, upper, Effort(15, 8), w)
        evaluations += spent
        if distance > exact or angle > exact:
            continue
        alone = True
        for k in range(first, count):
            away = 0.0
            for d in range(dof):
                away = max(away, abs(tree.q[k, d] - q[d]))
            if away < apart:
                alone = False
                break
        if not alone:
            continue
        if first_pair(chain, arrays.bodies, arrays.active, need, q, arrays.scratch) >= 0:
            continue
        if _joined(arrays, targets, tree, node, place, count, bounds, exact, w):
            tree.place[count] = place
            tree.parent[count] = node
            count += 1
            idle = 0
    return count, evaluations
