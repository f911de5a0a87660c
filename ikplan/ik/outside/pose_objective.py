"""The objective of a pose as a vectorised function, for optimisers that know nothing of arms."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ikplan._jit import kernel
from ikplan.arrays import Array, Flags
from ikplan.errors import InvalidRequest
from ikplan.ik.objective import Objective, evaluate

__all__ = ["BudgetSpent", "PoseObjective"]


class BudgetSpent(Exception):
    """The evaluations of a search are spent. A solver lets it pass; its caller keeps the best."""


@kernel
def _evaluate_rows(objective: Objective, X: Array, F: Array) -> None:
    """Write the value of every row of X to F."""
    for i in range(X.shape[0]):
        F[i] = evaluate(objective, X[i])


@dataclass
class PoseObjective:
    """What a search minimises, one call for any number of candidates.

    A candidate outside the bounds is evaluated at the bound, as ``bounds: clip`` of the project's
    own searches. Every row counts as one evaluation.

    Attributes:
        data: The target and its weights, as the compiled searches take them.
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        start: Start configuration, shape (dof,) [rad or m].
        budget: Most evaluations; None: no bound.
        spent: Evaluations so far.
        best_x: Best candidate so far, within the bounds, shape (dof,) [rad or m].
        best_f: Its value; infinity before the first.
        improvements: Evaluations spent and best value, each time the best value fell; within a
            call the candidates count in their order.
        cut: Shape (1,); once another thread makes it true, the next call ends the search.
    """

    data: Objective
    lower: Array
    upper: Array
    start: Array
    budget: int | None = None
    spent: int = 0
    best_x: Array = field(default_factory=lambda: np.empty(0))
    best_f: float = np.inf
    improvements: list[tuple[int, float]] = field(default_factory=list)
    cut: Flags = field(default_factory=lambda: np.zeros(1, dtype=np.bool_))

    def __post_init__(self) -> None:
        if not self.best_x.size:
            self.best_x = 0.5 * (self.lower + self.upper)

    @property
    def dof(self) -> int:
        """Number of joint values of a candidate."""
        return len(self.lower)

    @property
    def remaining(self) -> int | None:
        """Evaluations left; None: no bound."""
        return None if self.budget is None else self.budget - self.spent

    def __call__(self, X: ArrayLike) -> Array:
        """Return the values of candidates.

        Args:
            X: Candidates, shape (n, dof), or one of shape (dof,) [rad or m].

        Returns:
            Values, shape (n,), or a number of shape () for one candidate.

        Raises:
            BudgetSpent: The budget does not reach for all of them; those it reaches for count.
            InvalidRequest: Wrong shape, or a candidate that is not finite.
        """
        given = np.asarray(X, dtype=np.float64)
        rows = np.atleast_2d(given)
        if given.ndim not in (1, 2) or rows.shape[1] != self.dof:
            raise InvalidRequest(
                f"candidates: must have shape (n, {self.dof}) or ({self.dof},), not {given.shape}",
                field="candidates",
                allowed=[f"(n, {self.dof})", f"({self.dof},)"],
            )
        if not np.isfinite(rows).all():
            raise InvalidRequest(
                "candidates: must be finite", field="candidates", allowed="finite numbers"
            )
        if self.cut[0]:
            raise BudgetSpent
        within = np.ascontiguousarray(np.clip(rows, self.lower, self.upper))
        reached = within if self.budget is None else within[: max(self.budget - self.spent, 0)]
        values = np.empty(len(reached))
        _evaluate_rows(self.data, reached, values)
        self._record(reached, values)
        if len(reached) < len(rows):
            raise BudgetSpent
        return values if given.ndim == 2 else values.reshape(())

    def _record(self, rows: Array, values: Array) -> None:
        if not len(values):
            return
        falling = np.minimum.accumulate(values)
        better = np.flatnonzero((falling < self.best_f) & (values == falling))
        for i in better:
            if values[i] < self.best_f:
                self.best_f = float(values[i])
                self.best_x = rows[i].copy()
                self.improvements.append((self.spent + int(i) + 1, self.best_f))
        self.spent += len(values)
