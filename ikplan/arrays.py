"""The arrays that the code works on, by what they hold."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Flags", "Indices", "clamped", "length_of", "lengths_of", "steps_of"]

Values = TypeVar("Values", "Array", "Indices")

Array = NDArray[np.float64]
"""Numbers: joint values, positions, times."""
Flags = NDArray[np.bool_]
"""Masks, one truth value each."""
Indices = NDArray[np.int64]
"""Indices and counts."""


def length_of(v: Array) -> float:
    """Return the length of one vector, shape (n,): to the last digit that of numpy.linalg.norm.

    It takes a fifth of the time, which counts where it is asked for at every waypoint.
    """
    return math.sqrt(v.dot(v))


def lengths_of(rows: Array) -> Array:
    """Return the lengths of vectors, shape (m, n) -> (m,): to the last digit as numpy.linalg.norm.

    For few of them it takes half of the time.
    """
    return np.asarray(np.sqrt(np.add.reduce(rows * rows, axis=1)))


def steps_of(values: Values) -> Values:
    """Return what each row adds to the one before, shape (n - 1, ...), as numpy.diff does.

    For short arrays it takes a third of the time.

    Args:
        values: Numbers, shape (n, ...).
    """
    steps: Values = values[1:] - values[:-1]
    return steps


def clamped(values: Values, low: Values | float, high: Values | float) -> Values:
    """Return values within bounds as numpy.clip does, in a third of the time for short arrays.

    Args:
        values: Numbers of any shape.
        low: Least values; an integer for indices.
        high: Largest values.
    """
    return np.minimum(np.maximum(values, low), high)
