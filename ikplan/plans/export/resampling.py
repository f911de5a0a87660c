"""A plan's joint values at a controller's cycle, whatever samples the plan has."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.plans.playback import evaluate

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.documents.trajectory import Trajectory

__all__ = ["CLOSE_ENOUGH", "positions_at_cycle"]


CLOSE_ENOUGH = 1e-5
"""How far values between samples may be from the motion [rad or m]."""
# A time within this share of a cycle of a sample is at the sample.
_SAME = 1e-6


def positions_at_cycle(plan: PlanDocument, cycle: float) -> Array:
    """Return the joint values of a plan once a cycle.

    The last values are those of the end, held until the cycle in which the motion ends is over.
    Samples at those times are taken as they are. Between samples the motion is that of
    :meth:`ikplan.Plan.at`: exact where the plan has its polynomials, otherwise cubics.

    Args:
        plan: The plan.
        cycle: Time between two rows [s].

    Returns:
        Shape (n + 1, dof) [rad or m], the first at time 0.

    Raises:
        InvalidRequest: The samples are too far apart to tell what is between them.
    """
    motion = plan.trajectory
    count = max(math.ceil(plan.duration / cycle - _SAME), 0)
    times = np.minimum(np.arange(count + 1) * cycle, plan.duration)
    after = np.clip(np.searchsorted(motion.time, times), 1, max(len(motion.time) - 1, 1))
    if len(motion.time) == 1:
        return np.array(motion.q)
    nearer = times - motion.time[after - 1] < motion.time[after] - times
    nearest = np.where(nearer, after - 1, after)
    if np.abs(motion.time[nearest] - times).max() <= _SAME * cycle:
        return np.array(motion.q[nearest])
    if plan.motion is None and (off := _between(motion)) > CLOSE_ENOUGH:
        raise InvalidRequest(
            f"the plan's samples are too far apart for a controller with a cycle of {cycle:g} s: "
            f"between them the joints are known to {off:.2g} only; leave sampling.rate_hz out (one "
            'sample a cycle), or ask for sampling.form "polynomial"',
            field="sampling.rate_hz",
            allowed=f"null, or a multiple of {1.0 / cycle:g} Hz",
        )
    return np.asarray(evaluate(plan, times)[0])


def _between(samples: Trajectory) -> float:
    """Return how far cubics between samples may be from the motion, judged by accelerations.

    A cubic has the positions and velocities of both samples; by how much its accelerations miss
    those of the samples, times the square of the step over 32, bounds the difference to the
    quintic that has them too.
    """
    h = np.diff(samples.time)[:, None]
    chord = np.diff(samples.q, axis=0) / h
    v0, v1 = samples.dq[:-1], samples.dq[1:]
    first = (6.0 * chord - 4.0 * v0 - 2.0 * v1) / h
    last = (2.0 * v0 + 4.0 * v1 - 6.0 * chord) / h
    miss = np.maximum(np.abs(first - samples.ddq[:-1]), np.abs(last - samples.ddq[1:]))
    return float((miss * h**2).max() / 32.0)
