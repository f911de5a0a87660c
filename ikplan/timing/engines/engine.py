"""The seam to the engines that choose the path speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ikplan.arrays import Array
from ikplan.timing.engines.rows import StageRows

__all__ = ["Check", "Engine", "EngineFailed", "checked", "unlimited"]

# Is called between steps of a long search, and raises an error of its own to end it.
Check = Callable[[], None]


def unlimited() -> None:
    """Let a search go on."""


class EngineFailed(Exception):
    """An engine found no path speed; stays inside the timing room.

    Attributes:
        stage: Interval where it gave up.
    """

    def __init__(self, stage: int) -> None:
        super().__init__(f"no path speed at interval {stage}")
        self.stage = stage


class Engine(Protocol):
    """Chooses the fastest path speed."""

    def solve(self, rows: StageRows) -> Array:
        """Return the squared path velocity at every node, shape (n + 1,).

        Args:
            rows: Constraints in natural units.

        Returns:
            As asked for at both ends, or lower where that is too fast; finite, and not zero at
            both ends of any interval.

        Raises:
            EngineFailed: No such speed was found.
        """
        ...


def checked(x: Array) -> Array:
    """Refuse speeds that are not finite, or that stand still over an interval.

    Args:
        x: Squared path velocities at the nodes, shape (n + 1,).

    Returns:
        The same array.

    Raises:
        EngineFailed: Names the interval.
    """
    bad = ~(np.isfinite(x[1:]) & (x[1:] + x[:-1] > 0.0))
    if bad.any():
        raise EngineFailed(int(np.argmax(bad)))
    return x
