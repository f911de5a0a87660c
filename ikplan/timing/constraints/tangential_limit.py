"""A limit of the rate at which the speed of the tool changes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest
from ikplan.timing.constraints.constraints import MARGIN, ConstraintRows, Label, PathPoints
from ikplan.timing.constraints.tool_limits import ToolRates

__all__ = ["TangentialLimit"]

_STANDS = 1e-9
"""Speed of the tool, per path length or time, below which it has no direction [m]."""


@dataclass(frozen=True, eq=False)
class TangentialLimit:
    """Upper bound of the tangential acceleration of the tool frame's origin, |d|v| / dt|.

    Along a path v = V sdot and dv/dt = V u + A x, so that it is |V| u + (V . A / |V|) x; where the
    tool stands, |A| x: it sets out in the direction of A. The centripetal share is free.

    Attributes:
        motion: The tool's velocity and acceleration for given joint motions.
        acceleration: The bound, both ways [m/s^2].
        start: Where it begins, as a path position s.
        end: Where it ends.

    Raises:
        InvalidRequest: The limit is not positive and finite.
    """

    motion: ToolRates
    acceleration: float
    start: float = 0.0
    end: float = np.inf

    def __post_init__(self) -> None:
        if not (np.isfinite(self.acceleration) and self.acceleration > 0.0):
            raise InvalidRequest(
                "the tool's tangential acceleration limit must be positive and finite, "
                f"not {self.acceleration!r}",
                field="limits.tool_acceleration.tangential",
                allowed="a positive number",
            )

    @property
    def labels(self) -> tuple[Label, ...]:
        """The limit."""
        return (("tool_tangential_acceleration", None),)

    def at(self, points: PathPoints) -> ConstraintRows:
        """Write the limit at points of a path; see PathConstraint."""
        limit = self.acceleration * (1.0 - MARGIN)
        rates = self.motion(points.q, points.qs, points.qss)
        of_u, of_x = _along(*rates)

        def coefficients(index: Indices) -> tuple[Array, Array]:
            a, b = of_u[index] / limit, of_x[index] / limit
            return np.stack([a, -a], axis=1), np.stack([b, -b], axis=1)

        def ratios(index: Indices, u: Array, x: Array) -> Array:
            return np.asarray(np.abs(of_u[index] * u + of_x[index] * x)[:, None] / limit)

        return ConstraintRows(2, coefficients, np.full(len(points.s), np.inf), ratios)

    def ratio(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return how far joint motions use the limit; see PathConstraint."""
        _, along = _along(*self.motion(q, dq, ddq))
        return np.abs(along) / self.acceleration

    def scaled(self, label: Label, factor: float) -> TangentialLimit:
        """Return the limit multiplied; see PathConstraint."""
        if label not in self.labels:
            return self
        return replace(self, acceleration=self.acceleration * factor)


def _along(V: Array, A: Array) -> tuple[Array, Array]:
    """Size of velocities, shape (m, 6), and accelerations along them: linear parts, (m,) each."""
    speed = np.linalg.norm(V[:, :3], axis=1)
    stands = speed < _STANDS
    along = (V[:, :3] * A[:, :3]).sum(axis=1) / np.where(stands, 1.0, speed)
    return speed, np.where(stands, np.linalg.norm(A[:, :3], axis=1), along)
