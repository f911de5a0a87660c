"""Full turns at the begin of a tool path: which 2 pi copy of a tracked sequence to take.

A sequence that is tracked as if turning joints had no limits is one for all copies of its start: a
copy goes through where the ranges of its joints, shifted, lie within the limits. Each joint chooses
its turn by itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Flags
from ikplan.kinematics.arm import Arm
from ikplan.planning.ladder.equivalent_configurations import joints_with_full_turn
from ikplan.planning.ladder.motion_cost import MotionCost

__all__ = ["StartCopies", "distinct_modulo_turns", "turning_joints", "without_limits"]

_TURN = 2.0 * math.pi
_ROUNDING = 1e-10
"""How far past a limit a shifted joint may come by rounding [rad]: it is put on the limit."""


def turning_joints(arm: Arm) -> Flags:
    """Return which joints have limits and room for a full turn within them, shape (dof,)."""
    turns = joints_with_full_turn(arm.chain, arm.lower, arm.upper)
    return np.asarray(turns & np.isfinite(arm.upper - arm.lower))


def without_limits(arm: Arm) -> Arm:
    """Return the arm without the position limits of its turning joints."""
    turns = turning_joints(arm)
    lower, upper = np.where(turns, -np.inf, arm.lower), np.where(turns, np.inf, arm.upper)
    return replace(arm, lower=lower, upper=upper, bounded=False)


def distinct_modulo_turns(arm: Arm, rows: Array) -> Array:
    """Return those of configurations, shape (m, dof), that are no copy of one before."""
    turns = turning_joints(arm)
    kept: list[int] = []
    for k, q in enumerate(rows):
        gap = np.abs(rows[kept] - q)
        wrapped = np.abs(gap - _TURN * np.round(gap / _TURN))
        if not (np.where(turns, wrapped, gap).max(axis=1, initial=0.0) < 1e-6).any():
            kept.append(k)
    return rows[kept]


@dataclass(frozen=True)
class StartCopies:
    """A begin that may be in any copy of its configuration.

    Attributes:
        near: The configuration that it should be near to, shape (dof,) [rad or m].
        counted: Whether the motion from there to the begin counts; otherwise nearness only
            decides between motions that are equally long.
        posture: What motions cost where a posture is preferred; None: joint motion alone counts.
    """

    near: Array
    counted: bool
    posture: MotionCost | None = None

    def cost(self, q: Array) -> float:
        """Return the joint motion to a begin, shape (dof,), that counts [rad or m]."""
        weights = 1.0 if self.posture is None else self.posture.weights
        return float(np.linalg.norm(weights * (q - self.near))) if self.counted else 0.0

    def fitting(self, arm: Arm, q: Array) -> tuple[Array, bool]:
        """Return the copy of a sequence within the limits whose begin is nearest.

        Args:
            arm: The arm.
            q: The sequence, shape (m, dof) [rad or m].

        Returns:
            The copy, shape (m, dof), and whether it is within the limits; where none is, the one
            that is so for longest.
        """
        copy = q.copy()
        fits = True
        for j in np.flatnonzero(turning_joints(arm)):
            shift, inside = self._shift(q[:, j], int(j), arm.lower[j], arm.upper[j])
            copy[:, j] += shift
            fits = fits and inside
            if inside:
                copy[:, j] = np.clip(copy[:, j], arm.lower[j], arm.upper[j])
        return copy, fits

    def _shift(self, values: Array, j: int, lower: float, upper: float) -> tuple[float, bool]:
        """Return the full turns of one joint, shape (m,) [rad], and whether they fit."""
        first = math.ceil((lower - values[0] - _ROUNDING) / _TURN)
        last = math.floor((upper - values[0] + _ROUNDING) / _TURN)
        best, best_rank = 0.0, (-1, -math.inf)
        for turn in range(first, last + 1):
            shifted = values + _TURN * turn
            out = (shifted < lower - _ROUNDING) | (shifted > upper + _ROUNDING)
            reached = int(np.argmax(out)) if out.any() else len(values)
            # Between copies as near as each other, such as at half a turn, the lower one.
            rank = (reached, -round(self._away(shifted, j), 9))
            if rank > best_rank:
                best, best_rank = _TURN * turn, rank
        return best, best_rank[0] == len(values)

    def _away(self, values: Array, j: int) -> float:
        """How far one joint is from where it should be near to."""
        away = abs(float(values[0]) - self.near[j])
        if self.posture is not None and self.posture.pull > 0.0:
            low, high = self.posture.lower[j], self.posture.upper[j]
            past = np.maximum(np.maximum(low - values, values - high), 0.0)
            away += self.posture.pull * float(past.mean())
        return float(away)
