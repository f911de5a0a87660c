"""What happens to a position outside the bounds; none of the papers says it.

``CLIP`` sets the component to the bound, ``REFLECT`` mirrors it there, ``RESAMPLE`` draws it anew,
uniformly within the bounds. The velocity of that component becomes zero, for ``REFLECT`` its
negative.
"""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["BOUNDS", "CLIP", "REFLECT", "RESAMPLE", "bound", "bound_flight", "clip"]


BOUNDS = ("clip", "reflect", "resample")
CLIP, REFLECT, RESAMPLE = range(3)


@kernel
def clip(x: Array, lower: Array, upper: Array) -> None:
    """Clip a position, shape (D,), to the bounds, in place."""
    for k in range(x.shape[0]):
        if x[k] < lower[k]:
            x[k] = lower[k]
        elif x[k] > upper[k]:
            x[k] = upper[k]


@kernel
def _inside(value: float, low: float, high: float, mode: int, rng: np.random.Generator) -> float:
    """Return a value outside the bounds brought inside."""
    if mode == RESAMPLE:
        return low + rng.random() * (high - low)
    if mode == REFLECT:
        value = 2.0 * low - value if value < low else 2.0 * high - value
    return min(max(value, low), high)


@kernel
def bound(x: Array, lower: Array, upper: Array, mode: int, rng: np.random.Generator) -> None:
    """Bring a position inside the bounds, in place.

    Args:
        x: Position, shape (D,) [rad or m].
        lower: Lower bounds, shape (D,) [rad or m].
        upper: Upper bounds, shape (D,) [rad or m].
        mode: CLIP, REFLECT or RESAMPLE.
        rng: Random numbers, drawn from by RESAMPLE only.
    """
    for k in range(x.shape[0]):
        if x[k] < lower[k] or x[k] > upper[k]:
            x[k] = _inside(x[k], lower[k], upper[k], mode, rng)


@kernel
def bound_flight(
    x: Array, v: Array, lower: Array, upper: Array, mode: int, rng: np.random.Generator
) -> None:
    """Bring a position inside the bounds and stop its velocity there, in place.

    Args:
        x: Position, shape (D,) [rad or m].
        v: Velocity, shape (D,) [rad or m per iteration].
        lower: Lower bounds, shape (D,) [rad or m].
        upper: Upper bounds, shape (D,) [rad or m].
        mode: CLIP, REFLECT or RESAMPLE.
        rng: Random numbers, drawn from by RESAMPLE only.
    """
    for k in range(x.shape[0]):
        if x[k] < lower[k] or x[k] > upper[k]:
            x[k] = _inside(x[k], lower[k], upper[k], mode, rng)
            v[k] = -v[k] if mode == REFLECT else 0.0
