"""toppra behind the engine seam."""

from __future__ import annotations

import functools
import logging
import math
from typing import Any

import numpy as np

from ikplan._kernels.clock import counting
from ikplan.arrays import Array, steps_of
from ikplan.timing.engines.engine import EngineFailed, checked
from ikplan.timing.engines.rows import StageRows
from ikplan.timing.engines.toppra_import import libraries_on_first_use

__all__ = ["ToppraEngine"]


# As in toppra's forward pass: where rounding makes a program infeasible, the speed is lowered a
# little and the program solved again. Lowering it at every stage, as toppra does, would cost more
# than the whole acceleration limit on an interval of 1e-10.
_BACK_OFF = 1e-10
_TRIES = 10
# toppra's own bound of every variable.
_HIGHEST = 1e8


class _Span:
    """What toppra's solver asks of a path when all coefficients are given."""

    def __init__(self, length: float) -> None:
        self.length = length

    def get_duration(self) -> float:
        return self.length


class _Ready(np.ndarray[Any, np.dtype[np.float64]]):
    """Coefficients that need no product with a constraint matrix.

    toppra multiplies them by its matrix F, here the identity; on grids of some hundred nodes that
    product wakes the threads of the linear algebra library, which takes longer than the timing.
    """

    def dot(self, *_: Any) -> Any:
        """Return the coefficients as they are."""
        return np.asarray(self)


@functools.cache
def _solver() -> Any:
    """Return a factory of toppra's solver for given rows (its import is slow)."""
    with counting(), libraries_on_first_use():
        import toppra.constraint
        from toppra.solverwrapper.cy_seidel_solverwrapper import seidelWrapper

    # Without a handler, Python prints toppra's warnings on stderr; failures are raised here.
    logging.getLogger("toppra").addHandler(logging.NullHandler())

    class GivenRows(toppra.constraint.LinearConstraint):  # type: ignore[misc]
        """Rows that are ready, instead of coefficients computed from a path."""

        def __init__(self, rows: StageRows) -> None:
            super().__init__()
            self.rows = rows
            self.identical = True

        def compute_constraint_params(self, *_: Any) -> tuple[Any, ...]:
            rows = self.rows
            m = rows.a.shape[1]
            a, b = (np.vstack([c, c[-1:]]).view(_Ready) for c in (rows.a, rows.b))
            highest = np.minimum(rows.x_max, _HIGHEST)
            x_bound = np.column_stack([np.zeros(len(rows.s)), highest])
            return a, b, np.zeros_like(a), np.empty((m, 0)), np.ones(m), None, x_bound

    def solver(rows: StageRows) -> Any:
        span = _Span(float(rows.s[-1]))
        return seidelWrapper([GivenRows(rows)], span, rows.s, True).solve_stagewise_optim

    return solver


class ToppraEngine:
    """TOPP-RA (Pham and Pham, IEEE T-RO 2018) on the linear programs of the toppra package.

    toppra's own driver solves three programs a stage. Rest keeps every row here, so that the
    lower ends of the controllable sets are zero and two are enough; the programs are solved by
    toppra as they are.
    """

    def solve(self, rows: StageRows) -> Array:
        """Return the squared path velocity at every node; see Engine."""
        program = _solver()(rows)
        n, nan = len(rows.s) - 1, math.nan
        controllable = [0.0] * n + [rows.ends[1]]
        # The weight of u breaks the tie between equal x, as in toppra's backward pass.
        highest_x = np.array([1e-9, -1.0])
        for i in range(n - 1, -1, -1):
            top = program(i, None, highest_x, nan, nan, 0.0, controllable[i + 1])[1]
            if top > 0.0:
                controllable[i] = top
            elif math.isnan(top):
                raise EngineFailed(i)
        h = steps_of(rows.s).tolist()
        x = [min(rows.ends[0], controllable[0])] + [0.0] * n
        highest_next = np.array([0.0, -1.0])
        for i in range(n):
            highest_next[0] = -2.0 * h[i]
            here, following = x[i], controllable[i + 1]
            u = program(i, None, highest_next, here, here, 0.0, following)[0]
            tries = 0
            while math.isnan(u) and tries < _TRIES:
                tries += 1
                here = max(here - _BACK_OFF, 0.999 * here)
                u = program(i, None, highest_next, here, here, 0.0, following)[0]
            if math.isnan(u):
                raise EngineFailed(i)
            x[i] = here
            ahead = here + 2.0 * h[i] * u
            x[i + 1] = 0.0 if ahead < 0.0 else min(ahead, following)
        return checked(np.array(x))
