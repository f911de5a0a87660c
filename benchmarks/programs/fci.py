"""The Franka Control Interface's view of a trajectory: differences of positions, one a millisecond.

libfranka (include/franka/rate_limiting.h and its source) takes the velocity, acceleration and jerk
of a commanded joint position from the positions of the cycles before, as differences over 1 ms,
the arm at rest before the first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["FER", "FR3", "FciLimits", "Judged", "judge"]

Array = NDArray[np.float64]

_PERIOD = 1e-3
_EPS = 1e-3  # kLimitEps


@dataclass(frozen=True)
class FciLimits:
    """Joint limits of an arm, seven numbers each, as libfranka prints them [rad and s]."""

    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    packets_lost: float


FER = FciLimits(
    (2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
    (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
    (7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0),
    3.0,
)
"""libfranka 0.9.2, the Panda; velocities before the margin for lost packets."""
FR3 = FciLimits(
    (2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26),
    (10.0,) * 7,
    (5000.0,) * 7,
    0.0,
)
"""libfranka 0.21.3, and the velocities of franka_description."""


@dataclass(frozen=True)
class Judged:
    """What the controller finds.

    Attributes:
        cycles: Number of cycles looked at.
        over: Cycles in which a velocity, an acceleration or a jerk exceeds its limit.
        velocity: Largest share of a velocity limit.
        acceleration: Largest share of an acceleration limit.
        jerk: Largest share of a jerk limit.
        end_acceleration: Largest acceleration of the samples at both ends [rad/s^2].
        over_with_margin: Cycles in which a velocity exceeds what the rate limiter allows, which
            keeps a margin for lost packets.
    """

    cycles: int
    over: int
    velocity: float
    acceleration: float
    jerk: float
    end_acceleration: float
    over_with_margin: int


def judge(time: Array, q: Array, ddq: Array, limits: FciLimits) -> Judged:
    """Judge a trajectory as the controller does.

    Args:
        time: Sample times, shape (m,) [s], one a millisecond.
        q: Joint values, shape (m, 7) [rad].
        ddq: Joint accelerations, shape (m, 7) [rad/s^2].
        limits: The arm's limits.

    Raises:
        ValueError: The samples are not one a millisecond.
    """
    if np.abs(time - np.arange(len(time)) * _PERIOD).max() > 1e-9:
        raise ValueError("the samples are not one a millisecond")
    # At rest before and after: the controller holds the first and the last position.
    held = np.vstack([np.repeat(q[:1], 3, axis=0), q, np.repeat(q[-1:], 3, axis=0)])
    velocity = np.diff(held, axis=0) / _PERIOD
    acceleration = np.diff(velocity, axis=0) / _PERIOD
    jerk = np.diff(acceleration, axis=0) / _PERIOD
    rates = (velocity[2:], acceleration[1:], jerk)
    bounds = (limits.velocity, limits.acceleration, limits.jerk)
    shares = [
        np.abs(rate) / (np.array(bound) - _EPS) for rate, bound in zip(rates, bounds, strict=True)
    ]
    margin = _EPS + limits.packets_lost * _PERIOD * (np.array(limits.acceleration) - _EPS)
    tight = np.abs(rates[0]) > np.array(limits.velocity) - margin
    worst = np.max([share.max(axis=1) for share in shares], axis=0)
    return Judged(
        cycles=len(worst),
        over=int((worst > 1.0).sum()),
        velocity=float(shares[0].max()),
        acceleration=float(shares[1].max()),
        jerk=float(shares[2].max()),
        end_acceleration=float(np.abs(ddq[[0, -1]]).max()),
        over_with_margin=int(tight.any(axis=1).sum()),
    )
