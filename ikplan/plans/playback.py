"""A plan at any time: exact from its polynomials, or by cubics between its samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.documents.timing_report import MotionPolynomials
    from ikplan.documents.trajectory import Trajectory

__all__ = ["JointState", "evaluate"]

JointState = tuple[Array, Array, Array]
"""Joint positions, velocities and accelerations."""


def evaluate(plan: PlanDocument, t: ArrayLike) -> JointState:
    """Evaluate a plan; see :meth:`ikplan.Plan.at`."""
    try:
        at = np.asarray(t, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest("t: times are numbers", field="t", allowed="numbers") from error
    if at.ndim > 1 or not np.isfinite(at).all():
        raise InvalidRequest(
            "t: must be a finite time or a list of them [s]", field="t", allowed="finite numbers"
        )
    times = np.clip(np.atleast_1d(at), 0.0, plan.duration)
    rows = _exact(plan.motion, times) if plan.motion else _hermite(plan.trajectory, times)
    q, dq, ddq = rows
    return (q[0], dq[0], ddq[0]) if at.ndim == 0 else (q, dq, ddq)


def _exact(motion: MotionPolynomials, t: Array) -> JointState:
    """Put the times into the path's motion, and that into the path."""
    if len(motion.s_knots) == 1:
        q = np.repeat(motion.q_knots, len(t), axis=0)
        return q, np.zeros_like(q), np.zeros_like(q)
    node = np.clip(np.searchsorted(motion.node_time, t, side="right") - 1, 0, None)
    node = np.minimum(node, len(motion.node_time) - 2)
    dt = t - motion.node_time[node]
    whole = motion.node_time[node + 1] - motion.node_time[node]
    v0, v1 = motion.node_sdot[node], motion.node_sdot[node + 1]
    if motion.node_sddot is None:
        a, jerk = (v1 - v0) / whole, np.zeros(len(t))
    else:
        a = motion.node_sddot[node]
        jerk = (motion.node_sddot[node + 1] - a) / whole
    s = motion.node_s[node] + dt * (v0 + dt * (a / 2.0 + dt * jerk / 6.0))
    v = v0 + dt * (a + dt * jerk / 2.0)
    if motion.node_sddot is None:
        piece = np.asarray(motion.pieces, dtype=np.int64)[node]
    else:
        piece = np.searchsorted(motion.s_knots, s, side="right") - 1
    q, qs, qss = _cubics(motion, np.clip(piece, 0, len(motion.s_knots) - 2), s)
    u = (a + dt * jerk)[:, None]
    v = v[:, None]
    return q, qs * v, qs * u + qss * v * v


def _cubics(motion: MotionPolynomials, piece: Indices, s: Array) -> JointState:
    """Values and derivatives by s of pieces of the path, each of shape (m, dof)."""
    begin, end = motion.s_knots[piece], motion.s_knots[piece + 1]
    ends = motion.q_knots[piece], motion.q_knots[piece + 1]
    return _cubic(s - begin, end - begin, *ends, motion.tangents_start[piece],
                  motion.tangents_end[piece])  # fmt: skip


def _hermite(samples: Trajectory, t: Array) -> JointState:
    """Join samples by the cubics that have their positions and velocities."""
    time, q, dq = samples.time, samples.q, samples.dq
    if len(time) == 1:
        still = np.repeat(q, len(t), axis=0)
        return still, np.zeros_like(still), np.zeros_like(still)
    k = np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 2)
    at, length = t - time[k], time[k + 1] - time[k]
    position, velocity, _ = _cubic(at, length, q[k], q[k + 1], dq[k], dq[k + 1])
    # Linear between samples, so that it never exceeds a limit that the samples keep.
    x = (at / length)[:, None]
    return position, velocity, (1.0 - x) * samples.ddq[k] + x * samples.ddq[k + 1]


def _cubic(at: Array, length: Array, q0: Array, q1: Array, m0: Array, m1: Array) -> JointState:
    """Cubics by their values and slopes at both ends, and two derivatives.

    Args:
        at: Where, from the beginnings, shape (m,).
        length: Lengths of the cubics, shape (m,).
        q0: Values at the beginnings, shape (m, dof).
        q1: Values at the ends.
        m0: Slopes at the beginnings.
        m1: Slopes at the ends.
    """
    h = length[:, None]
    x = at[:, None] / h
    r = 1.0 - x
    chord = (q1 - q0) / h
    q = q0 * r * r * (1 + 2 * x) + q1 * x * x * (1 + 2 * r) + h * x * r * (m0 * r - m1 * x)
    dq = m0 * r * (1 - 3 * x) + m1 * x * (3 * x - 2) + 6 * x * r * chord
    ddq = ((6 * x - 4) * m0 + (6 * x - 2) * m1 + (6 - 12 * x) * chord) / h
    return q, dq, ddq
