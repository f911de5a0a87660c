"""Compiled evaluation of piecewise cubic joint paths, along the path and along time."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Array, Indices

__all__ = ["evaluate_path", "evaluate_timed", "interval_near", "interval_of", "slopes_on"]


@kernel
def _piece(
    h: float, t: float, q0: float, q1: float, m0: float, m1: float
) -> tuple[float, float, float]:
    """Return q, dq/ds and d2q/ds2 of a cubic Hermite piece of length h at t = (s - s0) / h."""
    r = 1.0 - t
    d = (q1 - q0) / h
    # The weights of q0 and q1 are exact at both ends, and so are the values there.
    q = q0 * r * r * (1.0 + 2.0 * t) + q1 * t * t * (1.0 + 2.0 * r) + h * t * r * (m0 * r - m1 * t)
    qs = m0 * r * (1.0 - 3.0 * t) + m1 * t * (3.0 * t - 2.0) + 6.0 * t * r * d
    qss = ((6.0 * t - 4.0) * m0 + (6.0 * t - 2.0) * m1 + (6.0 - 12.0 * t) * d) / h
    return q, qs, qss


@kernel
def interval_of(nodes: Array, value: float) -> int:
    """Return i with nodes[i] <= value < nodes[i + 1], clipped to the intervals there are."""
    low, high = 0, nodes.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if nodes[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@kernel
def interval_near(nodes: Array, value: float, near: int) -> int:
    """Return what interval_of does, sought from an interval on: values that rise are soon found."""
    while near > 0 and nodes[near] > value:
        near -= 1
    while near < nodes.shape[0] - 2 and nodes[near + 1] <= value:
        near += 1
    return near


@kernel
def evaluate_path(
    s_knots: Array, q: Array, m0: Array, m1: Array, pieces: Indices, s: Array
) -> tuple[Array, Array, Array]:
    """Evaluate the pieces of a joint path.

    Args:
        s_knots: Knots, shape (k + 1,).
        q: Joint positions at the knots, shape (k + 1, dof).
        m0: Tangents at the start of each piece, shape (k, dof).
        m1: Tangents at the end of each piece, shape (k, dof).
        pieces: Piece to use for each value, shape (n,): it decides the side at a knot. A negative
            one asks for the piece that begins at or before the value.
        s: Path positions, shape (n,).

    Returns:
        q, dq/ds and d2q/ds2, each of shape (n, dof).
    """
    n, dof = s.shape[0], q.shape[1]
    out0, out1, out2 = np.empty((n, dof)), np.empty((n, dof)), np.empty((n, dof))
    for i in range(n):
        k = pieces[i] if pieces[i] >= 0 else interval_of(s_knots, s[i])
        h = s_knots[k + 1] - s_knots[k]
        t = min(max((s[i] - s_knots[k]) / h, 0.0), 1.0)
        for j in range(dof):
            out0[i, j], out1[i, j], out2[i, j] = _piece(
                h, t, q[k, j], q[k + 1, j], m0[k, j], m1[k, j]
            )
    return out0, out1, out2


@kernel
def slopes_on(
    s_knots: Array, q: Array, m0: Array, m1: Array, pieces: Indices, s: Array
) -> tuple[Array, Array, Array]:
    """Return dq/ds and d2q/ds2 at both ends of the intervals of a grid.

    Args:
        s_knots: Knots, shape (k + 1,).
        q: Joint positions at the knots, shape (k + 1, dof).
        m0: Tangents at the start of each piece, shape (k, dof).
        m1: Tangents at the end of each piece, shape (k, dof).
        pieces: Piece of each interval, shape (n,).
        s: Nodes, shape (n + 1,).

    Returns:
        dq/ds at the starts, d2q/ds2 at the starts and d2q/ds2 at the ends, each of shape (n, dof).
    """
    n, dof = pieces.shape[0], q.shape[1]
    qs0, qss0, qss1 = np.empty((n, dof)), np.empty((n, dof)), np.empty((n, dof))
    chord = np.empty(dof)
    known = -1
    for i in range(n):
        k = pieces[i]
        h = s_knots[k + 1] - s_knots[k]
        if k != known:
            known = k
            for j in range(dof):
                chord[j] = (q[k + 1, j] - q[k, j]) / h
        t = min(max((s[i] - s_knots[k]) / h, 0.0), 1.0)
        e = min(max((s[i + 1] - s_knots[k]) / h, 0.0), 1.0)
        r = 1.0 - t
        for j in range(dof):
            a, b, d = m0[k, j], m1[k, j], chord[j]
            qs0[i, j] = a * r * (1.0 - 3.0 * t) + b * t * (3.0 * t - 2.0) + 6.0 * t * r * d
            qss0[i, j] = ((6.0 * t - 4.0) * a + (6.0 * t - 2.0) * b + (6.0 - 12.0 * t) * d) / h
            qss1[i, j] = ((6.0 * e - 4.0) * a + (6.0 * e - 2.0) * b + (6.0 - 12.0 * e) * d) / h
    return qs0, qss0, qss1


@kernel
def evaluate_timed(
    s_knots: Array,
    q: Array,
    m0: Array,
    m1: Array,
    pieces: Indices,
    time: Array,
    s: Array,
    sdot: Array,
    times: Array,
) -> tuple[Array, Array, Array]:
    """Evaluate a joint path whose parameter moves with constant acceleration between nodes.

    Args:
        s_knots: Knots of the path, shape (k + 1,).
        q: Joint positions at the knots, shape (k + 1, dof).
        m0: Tangents at the start of each piece, shape (k, dof).
        m1: Tangents at the end of each piece, shape (k, dof).
        pieces: Piece of each interval between nodes, shape (n,).
        time: Times of the nodes [s], shape (n + 1,).
        s: Path positions of the nodes, shape (n + 1,).
        sdot: Path velocities at the nodes [1/s], shape (n + 1,).
        times: Times asked for [s], shape (m,); clipped to the ends.

    Returns:
        Joint positions, velocities and accelerations, each of shape (m, dof).
    """
    n, dof = times.shape[0], q.shape[1]
    out0, out1, out2 = np.empty((n, dof)), np.empty((n, dof)), np.empty((n, dof))
    for row in range(n):
        t = min(max(times[row], time[0]), time[-1])
        i = interval_of(time, t)
        k = pieces[i]
        h = s[i + 1] - s[i]
        # u = d2s/dt2 from ds/dt at both nodes: (v1^2 - v0^2) / (2 h).
        # Where the motion stands for a while, h is 0.
        u = (sdot[i + 1] - sdot[i]) * (sdot[i + 1] + sdot[i]) / (2.0 * h) if h > 0.0 else 0.0
        # Measured from the nearer end, so that both nodes are met exactly.
        before, after = t - time[i], time[i + 1] - t
        if before <= after:
            v = sdot[i] + u * before
            where = s[i] + before * (sdot[i] + 0.5 * u * before)
        else:
            v = sdot[i + 1] - u * after
            where = s[i + 1] - after * (sdot[i + 1] - 0.5 * u * after)
        v = max(v, 0.0)
        length = s_knots[k + 1] - s_knots[k]
        where = min(max(where, s[i]), s[i + 1])
        fraction = min(max((where - s_knots[k]) / length, 0.0), 1.0)
        for j in range(dof):
            position, qs, qss = _piece(length, fraction, q[k, j], q[k + 1, j], m0[k, j], m1[k, j])
            out0[row, j] = position
            out1[row, j] = qs * v
            out2[row, j] = qs * u + qss * v * v
    return out0, out1, out2
