"""When a motion rests between its ends.

The timing says when; a stop shorter than the samples are apart is not seen in them. Each that is
said is held to the samples beside it, and what they show besides is a stop as well.
"""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Flags, clamped, lengths_of, steps_of
from ikplan.certificate.claim import Claim

__all__ = ["false_stops", "stops"]


_STILL = 1e-9
"""Share of the velocity limits below which a sample is at rest."""
_STRAIGHT = 0.1
"""How far, as a share of its speed, a motion that comes to rest may be from a straight one."""
_SLACK = 1.0 + 1e-6
_ROUNDING = 1e-9
"""What velocities may be off by rounding [rad/s or m/s]."""


def stops(claim: Claim) -> list[float]:
    """Return the times at which all joints rest, between the first and the last sample [s]."""
    h = float(steps_of(claim.time).max(initial=0.0))
    said = claim.stop_time
    seen = [t for t in _seen(claim) if not len(said) or np.abs(said - t).min() > h]
    return [float(t) for t in np.sort(np.concatenate([said, seen]))]


def false_stops(claim: Claim) -> list[str]:
    """Return which stops the samples do not bear out, in words.

    A joint at rest has, a time t away, at most the velocity of its acceleration limit times t.
    """
    wrong = []
    limits = claim.limits
    a = limits.largest_acceleration * (1.0 + 1e-6)
    after = clamped(np.searchsorted(claim.time, claim.stop_time), 1, len(claim.time) - 1)
    for k in (after - 1, after):
        away = np.abs(claim.time[k] - claim.stop_time)[:, None]
        moves = (np.abs(claim.dq[k]) > a * away + _ROUNDING).any(axis=1)
        wrong += [f"the motion does not rest at {t:.4f} s" for t in claim.stop_time[moves]]
    return wrong


def _seen(claim: Claim) -> Array:
    """The times at which the samples show that all joints rest [s].

    A motion is at rest between two samples where the velocities of the first, changed by its
    accelerations, come to zero all at once, those of the second, backwards, too, and both within
    the time between them. Of samples at rest in a row the first counts.
    """
    limit = np.minimum(claim.limits.velocity, -claim.limits.velocity_lower)
    v, a = claim.dq / limit, claim.ddq / limit
    speed = np.abs(v).max(axis=1)
    still = speed <= _STILL
    ahead, straight_ahead = _to_rest(v[:-1], a[:-1])
    back, straight_back = _to_rest(v[1:], -a[1:])
    h = steps_of(claim.time)
    moving = ~still[:-1] & ~still[1:]
    between = moving & straight_ahead & straight_back & (ahead + back <= h * _SLACK)
    found = list(claim.time[:-1][between] + ahead[between])
    begins = np.flatnonzero(still[1:-1] & ~still[:-2]) + 1
    last_moving = int(np.flatnonzero(~still)[-1]) if not still.all() else 0
    found += [claim.time[k] for k in begins if k < last_moving]
    return np.sort(np.array(found, dtype=np.float64))


def _to_rest(v: Array, a: Array) -> tuple[Array, Flags]:
    """Time until velocities, changed by accelerations, are least, and whether they are about 0."""
    square = np.maximum((a * a).sum(axis=1), 1e-300)
    after = np.maximum(-(v * a).sum(axis=1) / square, 0.0)
    left = lengths_of(v + after[:, None] * a)
    return after, left <= _STRAIGHT * lengths_of(v)
