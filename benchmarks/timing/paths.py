"""Random joint paths: smooth, noisy, with duplicates, cusps and near-zero moves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ikplan.limits import JointLimits

__all__ = ["KINDS", "random_limits", "random_waypoints"]

Array = NDArray[np.float64]
Rng = np.random.Generator


def _smooth(rng: Rng, n: int, dof: int) -> Array:
    phase = np.linspace(0.0, rng.uniform(1.0, 10.0), n)[:, None]
    waves = rng.normal(size=(3, dof)), rng.uniform(0.2, 2.0, (3, dof)), rng.uniform(0, 6, (3, dof))
    q: Array = sum(
        (a * np.sin(f * phase + p) for a, f, p in zip(*waves, strict=True)), np.zeros(dof)
    )
    return q


def _scattered(rng: Rng, n: int, dof: int) -> Array:
    return rng.uniform(-1.0, 1.0, (n, dof))


def _noisy(rng: Rng, n: int, dof: int) -> Array:
    noise: Array = rng.normal(size=(n, dof)) * 10.0 ** rng.uniform(-4, -1.5)
    return _smooth(rng, n, dof) + noise


def _walk(rng: Rng, n: int, dof: int) -> Array:
    return np.cumsum(rng.normal(size=(n, dof)), axis=0)


def _duplicates(rng: Rng, n: int, dof: int) -> Array:
    return np.repeat(_smooth(rng, n, dof), rng.integers(1, 4, n), axis=0)[:n]


def _cusps(rng: Rng, n: int, dof: int) -> Array:
    there = _smooth(rng, max(n // 2, 1), dof)
    return np.concatenate([there, there[::-1]])[: max(n, 2)]


def _tiny(rng: Rng, n: int, dof: int) -> Array:
    return _smooth(rng, n, dof) * float(10.0 ** rng.uniform(-9, -3))


def _near_zero(rng: Rng, n: int, dof: int) -> Array:
    q = _smooth(rng, n, dof)
    repeated = np.repeat(q, 2, axis=0)[:n]
    noise: Array = rng.normal(size=repeated.shape) * 10.0 ** rng.uniform(-9, -5)
    return repeated + noise


def _axis(rng: Rng, n: int, dof: int) -> Array:
    q = np.zeros((n, dof))
    for i in range(1, n):
        q[i] = q[i - 1]
        q[i, rng.integers(dof)] += rng.normal()
    return q


KINDS: dict[str, Callable[[Rng, int, int], Array]] = {
    "smooth": _smooth,
    "scattered": _scattered,
    "noisy": _noisy,
    "walk": _walk,
    "duplicates": _duplicates,
    "cusps": _cusps,
    "tiny": _tiny,
    "near-zero moves": _near_zero,
    "axis by axis": _axis,
}


def random_waypoints(
    rng: Rng, kind: str, n: int, lower: Array, upper: Array, *, fill: bool
) -> Array:
    """Return waypoints of a kind inside position limits.

    Args:
        rng: Source of randomness.
        kind: One of KINDS.
        n: About how many waypoints.
        lower: Lower position limits, shape (dof,), may be -inf.
        upper: Upper position limits, shape (dof,), may be +inf.
        fill: Stretch the path to a random share of the limits; else move it inside at its size.

    Returns:
        Waypoints, shape (n', dof).
    """
    low, high = np.maximum(lower, -np.pi), np.minimum(upper, np.pi)
    q = KINDS[kind](rng, n, len(low))
    middle = 0.5 * (q.min(axis=0) + q.max(axis=0))
    half = np.maximum(0.5 * np.ptp(q, axis=0), 1e-300)
    room = 0.5 * (high - low) * rng.uniform(0.05, 1.0)
    factor = float((room / half).min())
    # A walk or a smooth curve larger than the room is shrunk; "tiny" stays tiny.
    if not fill:
        factor = min(factor, 1.0)
    inside: Array = np.clip(0.5 * (low + high) + factor * (q - middle), low, high)
    return inside


def random_limits(rng: Rng, dof: int) -> JointLimits:
    """Return random limits, some joints much weaker than others, one in three asymmetric."""
    velocity = 10.0 ** rng.uniform(-0.5, 0.7, dof)
    acceleration = 10.0 ** rng.uniform(-0.3, 1.5, dof)
    skew = rng.uniform(0.3, 1.0, (2, dof)) if rng.random() < 1 / 3 else np.ones((2, dof))
    return JointLimits(
        lower=-rng.uniform(0.5, 3.0, dof),
        upper=rng.uniform(0.5, 3.0, dof),
        velocity=velocity,
        acceleration=acceleration,
        joint_names=tuple(f"joint{j}" for j in range(dof)),
        velocity_lower=-velocity * skew[0],
        acceleration_lower=-acceleration * skew[1],
    )
