"""Which places of a plan become points of a program."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.plans.programs.certificate import ProgramInterpolation
from ikplan.plans.programs.interpolation import interpolate
from ikplan.plans.programs.pace import outwards, slowed
from ikplan.plans.programs.reference import Reference

__all__ = ["Aim", "RowChoice"]

Aim = tuple[float, float, float]
_ROUNDS = 60
# Corners sharper than this share of the limits are given more room where there is some.
_SHARP = 1.3
_UNLIKE = 1.5
_OUTWARDS = 3.0


@dataclass(frozen=True)
class RowChoice:
    """The choice of rows of a grid.

    Attributes:
        reference: The plan on the grid.
        kind: What the controller does between points.
        limits: Joint velocities and accelerations, shape (dof,) each.
        aim: How far the tool may be off [m], turned [rad], and early or late [s].
        shortest: Least time of a step of the program; shorter ones are slowed [s].
        apart: Least time between two rows in the plan [s].
    """

    reference: Reference
    kind: ProgramInterpolation
    limits: tuple[Array, Array]
    aim: Aim
    shortest: float
    apart: float

    def points(self) -> tuple[Indices, Array, Array]:
        """Return the rows that become points, when they are due [s], and the points."""
        rows = self._first()
        for _ in range(_ROUNDS):
            new = self._more_rows(rows)
            if not len(new):
                break
            rows = np.union1d(rows, new)
        return rows, *self._placed(rows)

    def _placed(self, rows: Indices) -> tuple[Array, Array]:
        """When the points at rows are due, and the points, with corners moved outwards."""
        points = self.reference.q[rows]
        if self.kind == "blended":
            points = outwards(self.reference.time[rows], points)
        due = slowed(self.kind, self.reference.time[rows], points, self.limits, self.shortest)
        return due, outwards(due, self.reference.q[rows]) if self.kind == "blended" else points

    def _more_rows(self, rows: Indices) -> Indices:
        """Rows that a program needs beside those it has."""
        if self.kind == "blended":
            due = self.reference.time[rows]
            uneven = self._uneven(due, outwards(due, self.reference.q[rows]), rows)
            uneven = self._apart(rows, uneven)
            if len(uneven):
                return uneven
        due, points = self._placed(rows)
        return self._apart(rows, self._halves(rows, due, points))

    def _apart(self, rows: Indices, new: Indices) -> Indices:
        """Those of new rows that leave no two rows closer in time than they may be."""
        k = np.searchsorted(rows, new)
        time = self.reference.time
        gap = np.minimum(time[new] - time[rows[k - 1]], time[rows[k]] - time[new])
        return new[gap >= self.apart]

    def _first(self) -> Indices:
        """Rows by the longest steps whose own interpolation keeps the tolerance."""
        least = max(math.ceil(self.apart / self.reference.time[1] - 1e-9), 1)
        # Corners that are moved outwards leave a part of what the moves between them are off.
        loose = _OUTWARDS if self.kind == "blended" else 1.0
        aim = (loose * self.aim[0], loose * self.aim[1], self.aim[2])
        rows, last = [0], len(self.reference.time) - 1
        step = 1
        while rows[-1] < last:
            begin = rows[-1]
            low, high = begin + 1, begin + max(step, 1) + 1
            while high <= last and self._step_fits(begin, high, aim):
                low, high = high, begin + 2 * (high - begin)
            high = min(high, last + 1)
            while high - low > 1:
                middle = (low + high) // 2
                if self._step_fits(begin, middle, aim):
                    low = middle
                else:
                    high = middle
            low = max(low, begin + least)
            # What is left for the last step is not shorter either.
            rows.append(low if low + least <= last else last)
            low = rows[-1]
            step = (low - begin) // 2
        return np.array(rows, dtype=np.int64)

    def _step_fits(self, begin: int, end: int, aim: Aim) -> bool:
        x = np.linspace(0.0, 1.0, end - begin + 1)[:, None]
        q0, q1 = self.reference.q[begin], self.reference.q[end]
        q = q0 + (q1 - q0) * x
        if self.kind == "spline":
            # A cubic by the slopes of the motion at its ends.
            h = (end - begin) * 1.0
            m0, m1 = (self._slope(row) * h for row in (begin, end))
            bend0, bend1 = m0 - (q1 - q0), m1 - (q1 - q0)
            q = q + x * (1.0 - x) ** 2 * bend0 - x**2 * (1.0 - x) * bend1
        found = self.reference.errors(q, np.arange(begin, end + 1, dtype=np.int64))
        return all(bool(error.max() <= most) for error, most in zip(found, aim, strict=True))

    def _slope(self, row: int) -> Array:
        """The motion's change of joint values a row, by central differences."""
        before, after = max(row - 1, 0), min(row + 1, len(self.reference.q) - 1)
        if after - before < 2:
            return np.zeros(self.reference.q.shape[1])
        return np.asarray((self.reference.q[after] - self.reference.q[before]) / 2.0)

    def _uneven(self, due: Array, points: Array, rows: Indices) -> Indices:
        """Middles of steps beside corners that are too sharp as the other step is much shorter.

        A corner is rounded over the shorter of its two steps.
        """
        h = np.diff(due)
        change = np.diff(np.diff(points, axis=0) / h[:, None], axis=0)
        rate = np.abs(change) / np.minimum(h[:-1], h[1:])[:, None]
        sharp = np.nonzero((rate / self.limits[1]).max(axis=1) > _SHARP)[0]
        longer = np.where(h[sharp] > h[sharp + 1], sharp, sharp + 1)
        shorter = 2 * sharp + 1 - longer
        longer = longer[h[longer] > _UNLIKE * h[shorter]]
        middles = (rows[longer] + rows[longer + 1]) // 2
        return np.unique(middles[middles > rows[longer]])

    def _halves(self, rows: Indices, due: Array, points: Array) -> Indices:
        """Middles of the steps in which the whole motion is too far from the path."""
        expected = np.arange(len(self.reference.time), dtype=np.int64)
        q = interpolate(self.kind, due, points).at(np.interp(expected, rows, due))
        found = np.array(self.reference.errors(q, expected))
        over = expected[(found > np.array(self.aim)[:, None]).any(axis=0)]
        steps = np.unique(np.clip(np.searchsorted(rows, over, side="right") - 1, 0, len(rows) - 2))
        middles = (rows[steps] + rows[steps + 1]) // 2
        return np.asarray(middles[middles > rows[steps]])
