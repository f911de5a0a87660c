"""The arrays that the code works on, by what they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Flags", "Indices"]

Array = NDArray[np.float64]
"""Numbers: joint values, positions, times."""
Flags = NDArray[np.bool_]
"""Masks, one truth value each."""
Indices = NDArray[np.int64]
"""Indices and counts."""
