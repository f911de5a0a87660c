"""Compiled velocities and accelerations of the tool for given joint motions."""

from __future__ import annotations

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array, Indices
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import moved, placed

__all__ = ["disc_rows", "speed_bounds", "tool_rates", "tool_ratios"]


@leaf_kernel
def _carry(d0: float, d1: float, d2: float, v: Array, a: Array) -> None:
    """Move the point whose velocity v and acceleration a are moved by d within its body."""
    w0, w1, w2 = v[3], v[4], v[5]
    t0, t1, t2 = w1 * d2 - w2 * d1, w2 * d0 - w0 * d2, w0 * d1 - w1 * d0
    v[0] += t0
    v[1] += t1
    v[2] += t2
    a[0] += a[4] * d2 - a[5] * d1 + w1 * t2 - w2 * t1
    a[1] += a[5] * d0 - a[3] * d2 + w2 * t0 - w0 * t2
    a[2] += a[3] * d1 - a[4] * d0 + w0 * t1 - w1 * t0


@kernel
def tool_rates(chain: Chain, q: Array, dq: Array, ddq: Array) -> tuple[Array, Array]:
    """Return the velocity and the acceleration of the tool, joint by joint from the base.

    Args:
        chain: The chain from base to tool.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).

    Returns:
        Velocities and classical accelerations of the tool frame's origin, linear part first, in
        the axes of the base, each of shape (m, 6) [m/s, rad/s] and [m/s^2, rad/s^2].
    """
    m, n = q.shape[0], chain.prismatic.shape[0]
    velocity, acceleration = np.zeros((m, 6)), np.zeros((m, 6))
    for row in range(m):
        v, a = velocity[row], acceleration[row]
        frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        for i in range(n):
            p0, p1, p2 = frame[9], frame[10], frame[11]
            frame = placed(chain.placements, i, frame)
            if chain.coupled:
                value, rate, change = chain.offset[i], 0.0, 0.0
                for k in range(q.shape[1]):
                    value += chain.coupling[i, k] * q[row, k]
                    rate += chain.coupling[i, k] * dq[row, k]
                    change += chain.coupling[i, k] * ddq[row, k]
            else:
                value, rate, change = q[row, i], dq[row, i], ddq[row, i]
            slides = chain.prismatic[i]
            if slides:
                frame = moved(frame, value, True)
            _carry(frame[9] - p0, frame[10] - p1, frame[11] - p2, v, a)
            z0, z1, z2 = frame[6], frame[7], frame[8]
            # What the body before adds by turning the joint's own velocity.
            w0, w1, w2 = v[3], v[4], v[5]
            c0, c1, c2 = w1 * z2 - w2 * z1, w2 * z0 - w0 * z2, w0 * z1 - w1 * z0
            part, twist = (0, 2.0 * rate) if slides else (3, rate)
            v[part] += rate * z0
            v[part + 1] += rate * z1
            v[part + 2] += rate * z2
            a[part] += change * z0 + twist * c0
            a[part + 1] += change * z1 + twist * c1
            a[part + 2] += change * z2 + twist * c2
            if not slides:
                frame = moved(frame, value, False)
        p0, p1, p2 = frame[9], frame[10], frame[11]
        frame = placed(chain.placements, n, frame)
        _carry(frame[9] - p0, frame[10] - p1, frame[11] - p2, v, a)
    return velocity, acceleration


@kernel
def speed_bounds(V: Array, linear: float, angular: float) -> Array:
    """Return the highest squared path velocities that limits of the tool's speed allow.

    Args:
        V: The tool's twists for joint velocities q', shape (m, 6).
        linear: Square of the limit of its linear speed, inf where there is none.
        angular: The same of its angular speed.

    Returns:
        Shape (m,); inf where nothing is bounded.
    """
    out = np.full(len(V), np.inf)
    for row in range(len(V)):
        for part, square in ((0, linear), (3, angular)):
            norm = V[row, part] * V[row, part] + V[row, part + 1] * V[row, part + 1]
            norm += V[row, part + 2] * V[row, part + 2]
            if norm > 0.0:
                out[row] = min(out[row], square / norm)
    return out


@kernel
def disc_rows(P: Array, R: Array, directions: int, limit: float) -> tuple[Array, Array]:
    """Return rows that keep |p u + r x| <= limit: a polygon in the disc in the plane of p and r.

    Args:
        P: Vectors p, shape (m, 3).
        R: Vectors r, shape (m, 3).
        directions: Number of sides of the polygon.
        limit: Radius of the disc, > 0.

    Returns:
        Coefficients of u and x in rows a u + b x <= 1, each of shape (m, directions).
    """
    m = P.shape[0]
    half = np.pi / directions
    angle = half * (2.0 * np.arange(directions) + 1.0)
    cosine, sine = np.cos(angle) / np.cos(half) / limit, np.sin(angle) / np.cos(half) / limit
    a, b = np.empty((m, directions)), np.empty((m, directions))
    for i in range(m):
        p0, p1, p2 = P[i]
        r0, r1, r2 = R[i]
        size = np.sqrt(p0 * p0 + p1 * p1 + p2 * p2)
        along = (p0 * r0 + p1 * r1 + p2 * r2) / size if size > 0.0 else 0.0
        part = along / size if size > 0.0 else 0.0
        c0, c1, c2 = r0 - part * p0, r1 - part * p1, r2 - part * p2
        across = np.sqrt(c0 * c0 + c1 * c1 + c2 * c2)
        for k in range(directions):
            a[i, k] = size * cosine[k]
            b[i, k] = along * cosine[k] + across * sine[k]
    return a, b


@kernel
def tool_ratios(V: Array, A: Array, index: Indices, u: Array, x: Array, limits: Array) -> Array:
    """Return by how much u and x would have to be divided to keep limits of the tool.

    Args:
        V: The tool's twists for joint velocities q', shape (m, 6).
        A: Their derivatives, shape (m, 6): its acceleration is V u + A x.
        index: Rows of both, shape (p,).
        u: Path accelerations there, shape (p,).
        x: Squared path velocities there, shape (p,).
        limits: Of linear and angular speed, and of linear and angular acceleration, shape (4,).

    Returns:
        Shape (p, 4).
    """
    out = np.empty((len(index), 4))
    for row in range(len(index)):
        for part in range(2):
            speed, pull = 0.0, 0.0
            for k in range(3 * part, 3 * part + 3):
                v = V[index[row], k]
                total = v * u[row] + A[index[row], k] * x[row]
                speed += v * v
                pull += total * total
            out[row, part] = speed * x[row] / (limits[part] * limits[part])
            out[row, 2 + part] = np.sqrt(pull) / limits[2 + part]
    return out
