"""The least distance at one configuration, as :meth:`ikplan.Robot.clearance` answers it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Clearance"]


@dataclass(frozen=True, eq=False)
class Clearance:
    """The nearest two bodies at one configuration.

    Attributes:
        distance: Their distance [m]; negative: how deep they overlap. Of the bodies' convex
            pieces, which enclose what they stand for; at most 5e-6 m too large.
        pair: Their names.
        points: The nearest point of each, in the robot's base frame, shape (2, 3) [m].
        pairs_checked: How many pairs were checked.
        unchecked: Names of links of which no shape is known.
    """

    distance: float
    pair: tuple[str, str]
    points: NDArray[np.float64]
    pairs_checked: int
    unchecked: tuple[str, ...]
