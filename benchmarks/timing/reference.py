"""The optimum of toppra itself, by its own constraints and its own driver."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits

__all__ = ["toppra_duration"]

Array = NDArray[np.float64]


def toppra_duration(path: JointPath, limits: JointLimits, s: Array) -> float | None:
    """Return the duration that toppra finds on a grid, or None where it finds none.

    Args:
        path: The path, without rest points inside.
        limits: Joint limits.
        s: Grid, shape (n + 1,).
    """
    import toppra.algorithm
    import toppra.constraint
    from toppra.interpolator import AbstractGeometricPath

    logging.getLogger("toppra").addHandler(logging.NullHandler())

    class Adapter(AbstractGeometricPath):  # type: ignore[misc]
        dof = path.dof
        path_interval = np.array([0.0, path.length])
        duration = path.length
        waypoints: Any = None

        def __call__(self, at: Any, order: int = 0) -> Array:
            q = path(at, order)
            return q if np.ndim(at) else q[0]

    velocity = toppra.constraint.JointVelocityConstraint(
        np.column_stack([limits.velocity_lower, limits.velocity])
    )
    acceleration = toppra.constraint.JointAccelerationConstraint(
        np.column_stack([limits.acceleration_lower, limits.acceleration]),
        discretization_scheme=toppra.constraint.DiscretizationType.Interpolation,
    )
    problem = toppra.algorithm.TOPPRA(
        [velocity, acceleration], Adapter(), gridpoints=s, solver_wrapper="seidel"
    )
    _, sdot, _ = problem.compute_parameterization(0.0, 0.0)
    if sdot is None or not np.isfinite(sdot).all():
        return None
    mean = 0.5 * (sdot[1:] + sdot[:-1])
    if not (mean > 0.0).all():
        return None
    return float(np.sum(np.diff(s) / mean))
