"""Limits of the joint torques."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.timing.constraints.constraints import MARGIN, ConstraintRows, Label, PathPoints

__all__ = ["InverseDynamics", "TorqueLimits"]

# (q, dq, ddq) to joint torques or forces, all of shape (m, dof): gravity and payload included.
InverseDynamics = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True, eq=False)
class TorqueLimits:
    """Upper bounds of the joint torques that the motion needs.

    Along a path, tau = g(q) + M(q) q' u + (M(q) q'' + c(q, q')) x. The rows bound the part of the
    motion by what gravity leaves of the limit.

    Attributes:
        inverse_dynamics: Torques for given joint motions.
        effort: Limits, both ways, shape (dof,) [N m or N].
        joint_names: Names of the joints.
        start: Where the limits begin, as a path position s.
        end: Where they end.

    Raises:
        InvalidRequest: A limit is not positive (names the joint), or there are too many or few.
    """

    inverse_dynamics: InverseDynamics
    effort: ArrayLike
    joint_names: tuple[str, ...]
    start: float = 0.0
    end: float = np.inf

    def __post_init__(self) -> None:
        effort = np.array(self.effort, dtype=np.float64)
        if effort.shape != (len(self.joint_names),):
            raise InvalidRequest(
                f"limits.effort must have {len(self.joint_names)} values, not shape {effort.shape}",
                field="limits.effort",
                allowed=f"{len(self.joint_names)} numbers",
            )
        bad = ~(effort > 0.0)
        if bad.any():
            j = int(np.argmax(bad))
            raise InvalidRequest(
                f"the torque limit of joint {self.joint_names[j]!r} must be positive, "
                f"not {effort[j]:g}",
                field=f"limits.effort[{j}]",
                allowed="a positive number",
            )
        effort.setflags(write=False)
        object.__setattr__(self, "effort", effort)

    @property
    def labels(self) -> tuple[Label, ...]:
        """One limit a joint."""
        return tuple(("torque", name) for name in self.joint_names)

    def _room(self, q: Array, margin: float, places: Array | None) -> tuple[Array, Array, Array]:
        """Return gravity's torques and what they leave of the upper and the lower limits.

        Args:
            q: Joint positions, shape (m, dof).
            margin: Fraction of the limits that is kept as a margin.
            places: Where on the path they are, as shares of its length, shape (m,); None: unknown.
        """
        zero = np.zeros_like(q)
        gravity = self.inverse_dynamics(q, zero, zero)
        limit = np.asarray(self.effort) * (1.0 - margin)
        up, down = limit - gravity, limit + gravity
        worst = np.minimum(up, down)
        if (worst <= 0.0).any():
            row, j = (int(i) for i in np.unravel_index(int(np.argmin(worst)), worst.shape))
            where = None if places is None else float(places[row])
            raise TimingFailed(
                f"joint {self.joint_names[j]!r} needs {abs(gravity[row, j]):.4g} to stand still "
                + (f"at {where:.4f} of the path" if where is not None else "on the path")
                + f", more than its torque limit of {np.asarray(self.effort)[j]:.4g}",
                position=where,
                joint=self.joint_names[j],
                limit="torque",
            )
        return gravity, up, down

    def at(self, points: PathPoints) -> ConstraintRows:
        """Write the limits at points of a path; see PathConstraint."""
        gravity, up, down = self._room(points.q, MARGIN, points.s / points.length)
        zero = np.zeros_like(points.q)
        of_u = self.inverse_dynamics(points.q, zero, points.qs) - gravity
        of_x = self.inverse_dynamics(points.q, points.qs, points.qss) - gravity

        def ratios(index: Indices, u: Array, x: Array) -> Array:
            motion = of_u[index] * u[:, None] + of_x[index] * x[:, None]
            needed: Array = np.maximum(motion / up[index], -motion / down[index])
            return needed

        def coefficients(index: Indices) -> tuple[Array, Array]:
            above, below = up[index], down[index]
            u, x = of_u[index], of_x[index]
            return np.hstack([u / above, -u / below]), np.hstack([x / above, -x / below])

        columns = 2 * len(self.joint_names)
        return ConstraintRows(columns, coefficients, np.full(len(points.s), np.inf), ratios)

    def ratio(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return how far joint motions use the limits; see PathConstraint."""
        torques = self.inverse_dynamics(q, dq, ddq)
        ratio = np.asarray((np.abs(torques) / np.asarray(self.effort)).max(axis=1))
        over = ratio > 1.0
        if over.any():
            gravity, up, down = self._room(q[over], 0.0, None)
            motion = torques[over] - gravity
            ratio[over] = np.maximum(motion / up, -motion / down).max(axis=1)
        return ratio

    def scaled(self, label: Label, factor: float) -> TorqueLimits:
        """Return the limits with one multiplied; see PathConstraint."""
        if label not in self.labels:
            return self
        effort = np.array(self.effort)
        effort[self.joint_names.index(str(label[1]))] *= factor
        return replace(self, effort=effort)
