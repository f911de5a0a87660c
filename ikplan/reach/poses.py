"""Positions on a grid and orientations spread evenly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest

__all__ = ["MAX_POSES", "grid_positions", "spread_orientations"]

MAX_POSES = 5_000_000
"""Most poses of one map: some 1 GB."""
_GOLDEN = math.pi * (3.0 - math.sqrt(5.0))


def grid_positions(lower: ArrayLike, upper: ArrayLike, spacing: float) -> Array:
    """Return the points of a grid, x slowest, shape (m, 3) [m].

    Args:
        lower: Its first corner, shape (3,) [m].
        upper: Its last corner, shape (3,) [m]; the grid ends there or less than a spacing before.
        spacing: Distance of neighbours [m].

    Raises:
        InvalidRequest: A corner or the spacing makes no sense, or there are too many points.
    """
    corners = [_vector("lower", lower), _vector("upper", upper)]
    if not 0.0 < spacing < math.inf:
        raise InvalidRequest("spacing: must be above 0", field="spacing", allowed="above 0 [m]")
    if (corners[1] < corners[0]).any():
        raise InvalidRequest("upper: must not be below lower", field="upper")
    counts = np.floor((corners[1] - corners[0]) / spacing * (1.0 + 1e-12)).astype(int) + 1
    if counts.prod() > MAX_POSES:
        raise InvalidRequest(
            f"spacing: the grid has {counts.prod():,} points", field="spacing", allowed=MAX_POSES
        )
    axes = [corners[0][k] + spacing * np.arange(counts[k]) for k in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def spread_orientations(
    directions: int,
    rolls: int,
    *,
    toward: Sequence[float] = (0.0, 0.0, -1.0),
    within: float = math.pi,
) -> Array:
    """Return orientations whose z axes are spread evenly over a cone, shape (n, 3, 3).

    Args:
        directions: Number of directions of the z axis.
        rolls: Number of turns about each, evenly over the circle.
        toward: Axis of the cone.
        within: Half its angle, in (0, pi] [rad]; pi: all directions.

    Returns:
        Rotations; those of one direction follow each other. Source: the Fibonacci lattice,
        González, Math. Geosciences 2010, 42.

    Raises:
        InvalidRequest: A number makes no sense.
    """
    for field, count in (("directions", directions), ("rolls", rolls)):
        if count < 1:
            raise InvalidRequest(f"{field}: must be 1 or more", field=field, allowed="1 or more")
    if not 0.0 < within <= math.pi:
        raise InvalidRequest("within: must be in (0, pi]", field="within", allowed=[0.0, math.pi])
    axis = _vector("toward", toward)
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        raise InvalidRequest("toward: must not be zero", field="toward")
    k = np.arange(directions)
    if directions == 1:
        cosine = np.ones(1)
    else:
        cosine = 1.0 - (1.0 - math.cos(within)) * (k + 0.5) / directions
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine * cosine))
    local = np.stack([sine * np.cos(_GOLDEN * k), sine * np.sin(_GOLDEN * k), cosine], axis=1)
    z = local @ _frame(axis / length).T
    turned = []
    for direction in z:
        R = _frame(direction / np.linalg.norm(direction))
        for roll in 2.0 * math.pi * np.arange(rolls) / rolls:
            c, s = math.cos(roll), math.sin(roll)
            turned.append(R @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    return np.array(turned)


def _frame(z: Array) -> Array:
    """A rotation whose z axis is a unit vector, shape (3, 3)."""
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _vector(field: str, value: Any) -> Array:
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(f"{field}: must be three numbers", field=field) from error
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InvalidRequest(f"{field}: must be three finite numbers", field=field)
    return vector
