"""Whether configurations and joint paths of one arm are free of contact with one set of bodies."""

from __future__ import annotations

import copy
from collections import Counter

import numpy as np

from ikplan.arrays import Array, Flags, Indices
from ikplan.collision.bodies import flat_bodies
from ikplan.collision.check import Contact, ContactArrays
from ikplan.collision.contact import contacts, gaps
from ikplan.collision.depth import overlap_depth
from ikplan.collision.motion import curve_contacts, motion_contact
from ikplan.collision.scratch import new_scratch
from ikplan.kinematics.arm import arm_of
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["CollisionChecker"]

_OVERLAPS = 1e-9
"""Distance of hulls up to which they overlap [m]."""


_DECIDED = 1e-6
"""How much nearer than allowed two bodies are where that is no matter of rounding [m]."""


class CollisionChecker:
    """Compiled checks of one arm against one model; one thread at a time.

    Attributes:
        model: The bodies, the pairs and the clearance.
    """

    def __init__(self, robot: Robot, model: CollisionModel, margin: float = 0.0) -> None:
        """Prepare the bodies for the kernels.

        Args:
            robot: The robot, with its tool.
            model: Its bodies and those around it.
            margin: Gap asked for on top of the clearance [m].
        """
        self.model = model
        self._chain = arm_of(robot).chain
        self._bodies = flat_bodies(robot, model)
        self._scratch = new_scratch(self._chain, self._bodies)
        self._margin = margin
        self._all = np.ones(len(self._bodies.pairs), dtype=np.bool_)
        windows = [(b.first_segment, b.last_segment) for b in model.bodies]
        self._windowed = any(window != (None, None) for window in windows)

    @property
    def changes_by_segment(self) -> bool:
        """Whether bodies are attached on some segments only."""
        return self._windowed

    def wider(self, extra: float) -> CollisionChecker:
        """Return the same check with a larger gap asked for; both share their work space.

        Args:
            extra: What is asked for on top [m].
        """
        other = copy.copy(self)
        other._margin = self._margin + extra
        return other

    def touching(self, q: Array, segment: int | None = None) -> Indices:
        """Return the rows of the model's pairs that are nearer than allowed, in their order.

        Args:
            q: Joint values, shape (dof,) [rad or m].
            segment: The segment it belongs to.
        """
        found = np.empty(len(self._all))
        q = np.ascontiguousarray(q, dtype=np.float64)
        gaps(self._chain, self._bodies, self.active(segment), q, np.inf, self._scratch, found)
        near = found <= self.model.clearance + self._margin
        return np.unique(self._bodies.pair_of[near])

    def tool_contact(self, q: Array, segment: int | None = None) -> tuple[str, str] | None:
        """Return a pair in contact of which one moves with the tool and the other stands still.

        Such a pair is in contact in every configuration that has the tool in the same place.

        Args:
            q: Joint values, shape (dof,) [rad or m].
            segment: The segment it belongs to.
        """
        tip = len(self._chain.prismatic)
        exact = self.wider(-self._margin - _DECIDED)
        for row in exact.touching(q, segment):
            a, b = (self.model.bodies[k] for k in np.asarray(self.model.pairs).reshape(-1, 2)[row])
            if {a.carrier, b.carrier} == {0, tip}:
                return a.name, b.name
        return None

    def ignoring(self, rows: Indices) -> CollisionChecker:
        """Return the same check without some rows of the model's pairs."""
        other = copy.copy(self)
        other._all = self._all & ~np.isin(self._bodies.pair_of, rows)
        return other

    def active(self, segment: int | None) -> Flags:
        """Return which pairs of pieces count in a segment, shape (m,); None: all of them."""
        if segment is None or not self._windowed:
            return self._all
        there = np.array(
            [
                (b.first_segment is None or b.first_segment <= segment)
                and (b.last_segment is None or segment <= b.last_segment)
                for b in self.model.bodies
            ]
        )
        pairs = np.asarray(self.model.pairs).reshape(-1, 2)
        together = there[pairs[:, 0]] & there[pairs[:, 1]]
        return np.asarray(together[self._bodies.pair_of] & self._all)

    def pairs_in_contact(
        self, q: Array, segment: int | None = None
    ) -> list[tuple[str, str] | None]:
        """Return for each configuration a pair that is nearer than allowed, or None.

        Args:
            q: Configurations, shape (m, dof) [rad or m].
            segment: The segment they belong to; None: attached bodies are there throughout.
        """
        return [None if row < 0 else self._names(int(row)) for row in self._rows(q, segment)]

    def free(self, q: Array, segment: int | None = None) -> Flags:
        """Return which configurations are free of contact, shape (m,); see above."""
        return np.array(self._rows(q, segment) < 0, dtype=np.bool_)

    def first_contact(self, q: Array, segment: int | None = None) -> Contact | None:
        """Return where straight joint motions from row to row first meet a body, or None.

        Without a contact, the whole of the motion is proven to be free.

        Args:
            q: Configurations, shape (m, dof) [rad or m].
            segment: The segment they belong to.
        """
        q = np.ascontiguousarray(q, dtype=np.float64)
        active = self.active(segment)
        if len(q) and (row := self._rows(q[:1], segment)[0]) >= 0:
            return Contact(0, 0.0, q[0].copy(), self._names(row))
        for k in range(len(q) - 1):
            row, share = motion_contact(
                self._chain, self._bodies, active, self._margin, q[k], q[k + 1], self._scratch
            )
            if row >= 0:
                return Contact(k, share, q[k] + share * (q[k + 1] - q[k]), self._names(row))
        return None

    def contacts_on_curve(
        self, s: Array, q: Array, m: tuple[Array, Array], segment: int | None, extra: float
    ) -> Flags:
        """Return which pieces of a motion that is cubic from knot to knot are not proven free.

        Args:
            s: Knots, shape (k + 1,), strictly increasing.
            q: Values at the knots, shape (k + 1, dof) [rad or m].
            m: Derivatives by s at the begin and at the end of each piece, each (k, dof).
            segment: The segment it belongs to.
            extra: Gap asked for on top of the margin of this check [m].

        Returns:
            Shape (k,).
        """
        found = np.full(len(s) - 1, -1, dtype=np.int64)
        if len(self._all):
            curve_contacts(
                self._chain,
                self._bodies,
                self.active(segment),
                self._margin + extra,
                np.ascontiguousarray(s),
                np.ascontiguousarray(q),
                np.ascontiguousarray(m[0]),
                np.ascontiguousarray(m[1]),
                self._scratch,
                found,
            )
        return np.asarray(found >= 0)

    def arrays(self, segment: int | None) -> ContactArrays:
        """Return what the kernels of a search take, for the pairs that count in a segment."""
        return ContactArrays(
            self._chain, self._bodies, self.active(segment), self._margin, self._scratch
        )

    def least_gap(self, q: Array, segment: int | None = None) -> tuple[float, tuple[str, str]]:
        """Return the smallest gap of a configuration [m], 0 in contact, and its pair.

        Args:
            q: Joint values, shape (dof,) [rad or m].
            segment: The segment it belongs to.
        """
        found = np.empty(len(self._all))
        q = np.ascontiguousarray(q, dtype=np.float64)
        row = gaps(self._chain, self._bodies, self.active(segment), q, np.inf, self._scratch, found)
        if row < 0:
            return float("inf"), ("", "")
        return max(float(found[row]), 0.0), self._names(row)

    def shortfall(self, q: Array, pair: tuple[str, str], segment: int | None = None) -> float:
        """Return by how much the gap of two bodies falls short of the clearance [m].

        Of bodies in each other it is the clearance and the depth: the length of the shortest shift
        that takes their pieces apart, of those two that are deepest in each other.

        Args:
            q: Joint values, shape (dof,) [rad or m].
            pair: Names of the bodies.
            segment: The segment the configuration belongs to.
        """
        found = np.empty(len(self._all))
        q = np.ascontiguousarray(q, dtype=np.float64)
        gaps(self._chain, self._bodies, self.active(segment), q, np.inf, self._scratch, found)
        rows = [
            k for k in np.flatnonzero(np.isfinite(found)) if set(self._names(int(k))) == set(pair)
        ]
        least = min((self._signed_gap(int(k), float(found[k])) for k in rows), default=np.inf)
        return max(self.model.clearance - least, 0.0)

    def _signed_gap(self, row: int, gap: float) -> float:
        """The gap of two pieces at the configuration looked at last, less than 0 in overlap [m]."""
        b, (i, j) = self._bodies, self._bodies.pairs[row]
        reach = float(b.radius[i] + b.radius[j])
        if gap > -reach + _OVERLAPS:
            return gap
        placed = []
        for piece in (i, j):
            carrier = b.carrier[piece]
            own = b.points[b.first[piece] : b.first[piece + 1]]
            placed.append(own @ self._scratch.R[carrier].T + self._scratch.p[carrier])
        return -reach - overlap_depth(*placed)

    def commonest(self, q: Array, segment: int | None = None) -> list[tuple[tuple[str, str], int]]:
        """Return the pairs that hold configurations in contact and how many, most first."""
        named = [pair for pair in self.pairs_in_contact(q, segment) if pair is not None]
        return sorted(Counter(named).items(), key=lambda item: (-item[1], item[0]))

    def _rows(self, q: Array, segment: int | None) -> Indices:
        q = np.ascontiguousarray(q, dtype=np.float64)
        out = np.full(len(q), -1, dtype=np.int64)
        if len(self._all):
            contacts(
                self._chain, self._bodies, self.active(segment), self._margin, q, self._scratch, out
            )
        return out

    def _names(self, row: int) -> tuple[str, str]:
        a, b = np.asarray(self.model.pairs).reshape(-1, 2)[self._bodies.pair_of[row]]
        return self.model.bodies[a].name, self.model.bodies[b].name
