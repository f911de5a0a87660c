"""The seam to the engines that choose the path speed, and toppra behind it."""

from __future__ import annotations

import functools
import logging
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ikplan.timing.rows import StageRows

__all__ = ["Engine", "EngineFailed", "ToppraEngine", "natural_units"]

Array = NDArray[np.float64]


class EngineFailed(Exception):
    """An engine found no path speed; stays inside the timing room.

    Attributes:
        stage: Interval where it gave up.
    """

    def __init__(self, stage: int) -> None:
        super().__init__(f"no path speed at interval {stage}")
        self.stage = stage


class Engine(Protocol):
    """Chooses the fastest path speed, from rest to rest."""

    def solve(self, rows: StageRows) -> Array:
        """Return the squared path velocity at every node, shape (n + 1,).

        Args:
            rows: Constraints in natural units; x = 0, u = 0 keeps all of them.

        Raises:
            EngineFailed: No such speed was found.
        """
        ...


def natural_units(rows: StageRows) -> tuple[StageRows, float]:
    """Scale a problem so that lengths, speeds and accelerations are about one.

    toppra's solver has absolute tolerances, so that a motion of 1e-9 rad drowns in them.

    Args:
        rows: The problem.

    Returns:
        The scaled problem, and the factor that turns its x into the caller's.
    """
    length = float(rows.s[-1] - rows.s[0])
    s = (rows.s - rows.s[0]) / length
    finite = rows.x_max[np.isfinite(rows.x_max)]
    by_velocity = float(np.median(finite)) if len(finite) else np.inf
    slope = float(np.median(np.abs(rows.a).max(axis=1)))
    by_acceleration = length / slope if slope > 0.0 else np.inf
    unit = min(by_velocity, by_acceleration)
    if not np.isfinite(unit):
        unit = 1.0
    return (
        StageRows(s, rows.a * (unit / length), rows.b * unit, rows.x_max / unit),
        unit,
    )


class _Span:
    """What toppra asks of a path when all coefficients are given: its interval."""

    def __init__(self, s: Array) -> None:
        self.path_interval = (s[0], s[-1])

    def get_duration(self) -> float:
        return float(self.path_interval[1] - self.path_interval[0])


@functools.cache
def _toppra() -> tuple[Any, Any]:
    """Return toppra's algorithm and its base of linear constraints (a slow import)."""
    import toppra.algorithm
    import toppra.constraint

    # Without a handler, Python prints toppra's warnings on stderr; failures are raised here.
    logging.getLogger("toppra").addHandler(logging.NullHandler())

    class GivenRows(toppra.constraint.LinearConstraint):  # type: ignore[misc]
        """Rows that are ready, instead of coefficients computed from a path."""

        def __init__(self, rows: StageRows) -> None:
            super().__init__()
            self.rows = rows
            self.identical = True

        def compute_constraint_params(
            self, path: Any, gridpoints: Any, *args: Any
        ) -> tuple[Any, ...]:
            del path, gridpoints, args
            rows = self.rows
            m = rows.a.shape[1]
            a, b = (np.vstack([c, c[-1:]]) for c in (rows.a, rows.b))
            x_bound = np.column_stack([np.zeros(len(rows.s)), np.minimum(rows.x_max, 1e8)])
            return a, b, np.zeros_like(a), np.eye(m), np.ones(m), None, x_bound

    return toppra.algorithm.TOPPRA, GivenRows


class ToppraEngine:
    """Pham and Pham's TOPP-RA (IEEE T-RO 2018), by the toppra package."""

    def solve(self, rows: StageRows) -> Array:
        """Return the squared path velocity at every node; see Engine."""
        algorithm, constraint = _toppra()
        problem = algorithm([constraint(rows)], _Span(rows.s), rows.s, solver_wrapper="seidel")
        _, sdot, _, controllable = problem.compute_parameterization(0.0, 0.0, return_data=True)
        if sdot is None:
            # The backward pass leaves NaN at the stage it broke at, zeros before it.
            broken = np.isnan(controllable).any(axis=1)
            raise EngineFailed(int(np.argmax(broken)))
        x: Array = np.square(np.asarray(sdot, dtype=np.float64))
        if not np.isfinite(x).all():
            raise EngineFailed(int(np.argmax(~np.isfinite(x))) - 1)
        return x
