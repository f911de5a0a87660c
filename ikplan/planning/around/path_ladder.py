"""Points of a tool path, what the arm can do at them, and a way through them drawn taut."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.collision.check import ContactArrays
from ikplan.planning.around.rung_kernels import join_rungs
from ikplan.planning.ladder.free_ladder import shortest_way
from ikplan.planning.ladder.ik_candidates import Targets, sample_ik_solutions
from ikplan.planning.segment_number import segment_number
from ikplan.planning.tracking.reference_path import ReferencePath
from ikplan.planning.tracking.tracked_arm import EXACT, TrackedArm
from ikplan.planning.tracking.tracking_kernels import project_onto_targets

__all__ = ["LONGEST", "PathLadder"]

LONGEST = 0.7
"""How far a joint may move from point to point [rad or m]."""
_MOST = 80
"""Candidates of a point."""
_TRIED = 12
"""Steps to a candidate that are looked at, shortest way first, before it is given up."""
_FRESH = 24
"""Evenly spread seeds of a point."""
_BESIDE = (0.1, 0.3)
"""How far beside a candidate its self-motion is tried, one after the other [rad or m]."""
_TAUT = (0.12, 0.06, 0.06, 0.03, 0.03, 0.015)
"""How far beside the way solutions are tried to make it shorter, round by round [rad or m]."""
_NEAR = 5
"""Such solutions of a point in a round."""


class PathLadder:
    """Points of a path, and what the arm can do at them."""

    def __init__(self, arm: TrackedArm, reference: ReferencePath, s: Array) -> None:
        """Prepare the points.

        Args:
            arm: The arm, with what refuses contact.
            reference: The path.
            s: Path positions, an odd number m of them; every other is half-way between two rungs.
        """
        assert arm.contact is not None
        self.arm, self.contact = arm, arm.contact
        self.reference, self.s = reference, s
        self.targets = arm.targets_at(reference, s)
        self.rng = np.random.default_rng(0)

    def _target(self, point: int) -> Targets:
        """The target of one point as an array of one."""
        one = slice(point, point + 1)
        t = self.targets
        return Targets(t.R[one], t.p[one], t.oriented[one], t.weight[one], t.freedom)

    def _free(self, rung: int, q: Array) -> Array:
        """Those of configurations of a rung that are clear of contact."""
        segment = None
        if self.contact.changes_by_segment:
            at = self.s[2 * rung]
            parts = [x for x in self.reference.segments if x.begin <= at <= x.end]
            segment = segment_number(parts[0].field) if parts else None
        return np.ascontiguousarray(q[self.contact.free(q, segment)]) if len(q) else q

    def candidates(self, k: int, before: Array, q_near: Array) -> Array:
        """Solutions of rung k that are clear of contact, shape (c, dof) [rad or m]."""
        arm = self.arm.arm
        some = before[: _MOST // 2]
        width = _BESIDE[k % len(_BESIDE)]
        beside = some + width * self.rng.normal(size=some.shape)
        seeds = np.clip(np.vstack([before, beside]), arm.lower, arm.upper)
        found = sample_ik_solutions(
            arm.chain, self._target(2 * k), np.ascontiguousarray(seeds[None]), q_near,
            arm.lower, arm.upper, 3 * _MOST, _FRESH, 0, (0.5 + k * 0.6180339887498949) % 1.0, EXACT,
        )  # fmt: skip
        self.arm.clock.count(int(found.evaluations[0]))
        free = self._free(k, found.q[0, : found.counts[0]])
        if len(free) <= _MOST:
            return free
        # Those that follow come first; what is left out is left out evenly.
        kept = np.unique(np.linspace(0, len(free) - 1, _MOST).astype(np.int64))
        return np.ascontiguousarray(free[kept])

    def beside(self, k: int, way: Array, width: float) -> Array:
        """The configuration of a way at rung k and solutions near to it, shape (c, dof)."""
        arm = self.arm.arm
        after = way[min(k + 1, len(way) - 1)]
        middle = 0.5 * (way[k - 1] + after)
        tried = way[k] + width * self.rng.normal(size=(_NEAR - 2, way.shape[1]))
        tried = np.vstack([middle, 0.5 * (middle + way[k]), tried])
        q = np.ascontiguousarray(np.clip(tried, arm.lower, arm.upper))
        one = self._target(2 * k)
        rows = np.zeros(len(q), dtype=np.int64)
        targets = Targets(
            np.ascontiguousarray(one.R[rows]), np.ascontiguousarray(one.p[rows]),
            one.oriented[rows], one.weight[rows], one.freedom,
        )  # fmt: skip
        left, spent = project_onto_targets(arm.chain, targets, q, arm.lower, arm.upper)
        self.arm.clock.count(spent)
        return np.vstack([way[k], self._free(k, q[left <= EXACT])])

    def step(self, k: int, before: Array, after: Array) -> Array | None:
        """The configuration half-way of a step along the path to rung k; None: not to be taken."""
        _, parent, middle = self.join(k, np.zeros(1), before[None], after[None])
        return None if parent[0] < 0 else np.asarray(middle[0])

    def join(
        self, k: int, cost: Array, before: Array, after: Array
    ) -> tuple[Array, Indices, Array]:
        """Reach the candidates of rung k by the shortest ways whose last step can be taken.

        Args:
            k: The rung.
            cost: Joint motion to each candidate of the rung before, shape (b,) [rad or m].
            before: These candidates, shape (b, dof) [rad or m].
            after: The candidates, shape (c, dof) [rad or m].

        Returns:
            Joint motion to each, shape (c,); the candidates before them, shape (c,), -1 where
            there is none; and the configurations half-way, shape (c, dof).
        """
        arm = self.arm.arm
        halves = self._bodies(2 * k - 2), self._bodies(2 * k - 1)
        reached, parent, middles, spent = join_rungs(
            halves, self._target(2 * k - 1), cost, np.ascontiguousarray(before),
            np.ascontiguousarray(after), LONGEST, _TRIED, (arm.lower, arm.upper), EXACT,
        )  # fmt: skip
        self.arm.clock.count(spent)
        return reached, parent, middles

    def _bodies(self, point: int) -> ContactArrays:
        """What must not be touched from a point to the next: all that is there on a part of it."""
        arrays = self.contact.arrays(None)
        if not self.contact.changes_by_segment or not self.reference.segments:
            return arrays
        begin, end = self.s[point], self.s[point + 1]
        active = np.zeros_like(arrays.active)
        for part in self.reference.segments:
            if end > part.begin and begin < part.end:
                active |= self.contact.arrays(segment_number(part.field)).active
        return arrays._replace(active=active)

    def drawn_taut(self, nodes: Array, middles: Array) -> Array:
        """Return a way made shorter among solutions near to it, still clear of contact.

        Args:
            nodes: Its configurations at the n rungs, shape (n, dof) [rad or m].
            middles: Those half-way between, shape (n - 1, dof) [rad or m].

        Returns:
            Configurations at all positions, shape (m, dof) [rad or m].
        """
        way = nodes, middles
        for width in _TAUT:
            self.arm.clock.check()
            near = [way[0][:1], *(self.beside(k, way[0], width) for k in range(1, len(nodes)))]
            shorter = shortest_way(near, np.zeros(1), self.join)
            way = way if shorter is None else shorter
        q = np.empty((len(self.s), nodes.shape[1]))
        q[0::2], q[1::2] = way
        return q
