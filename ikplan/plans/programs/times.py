"""What the steps of a program may take."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ANY_TIMES", "Times"]


@dataclass(frozen=True)
class Times:
    """What the steps of a program may take.

    Attributes:
        tick: Steps are whole multiples of this [us].
        shortest: No step is shorter, but where that leaves a single one [s].
    """

    tick: int
    shortest: float


ANY_TIMES = Times(1, 0.0)
"""Whole microseconds."""
