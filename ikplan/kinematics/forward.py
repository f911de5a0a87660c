"""Compiled forward kinematics, Jacobians and pose errors of a chain.

Poses are of the tool in the base. Jacobians are in the tool frame, linear rows first, as
Pinocchio's ``LOCAL`` frame Jacobians are.
"""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.kinematics.chain import Chain

__all__ = [
    "forward",
    "forward_batch",
    "forward_into",
    "jacobian",
    "jacobian_into",
    "moved",
    "placed",
    "pose_error",
    "rotation_log",
]


Frame = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""Columns x, y and z of a frame's rotation, and its origin [m], in the base."""


@leaf_kernel
def placed(T: Array, i: int, frame: Frame) -> Frame:
    """Return the frame moved by the constant placement i."""
    x0, x1, x2, y0, y1, y2, z0, z1, z2, p0, p1, p2 = frame
    a, b, c = T[i, 9], T[i, 10], T[i, 11]
    p0 += x0 * a + y0 * b + z0 * c
    p1 += x1 * a + y1 * b + z1 * c
    p2 += x2 * a + y2 * b + z2 * c
    a, b, c = T[i, 0], T[i, 3], T[i, 6]
    u0, u1, u2 = x0 * a + y0 * b + z0 * c, x1 * a + y1 * b + z1 * c, x2 * a + y2 * b + z2 * c
    a, b, c = T[i, 1], T[i, 4], T[i, 7]
    v0, v1, v2 = x0 * a + y0 * b + z0 * c, x1 * a + y1 * b + z1 * c, x2 * a + y2 * b + z2 * c
    z0, z1, z2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
    return u0, u1, u2, v0, v1, v2, z0, z1, z2, p0, p1, p2


@leaf_kernel
def moved(frame: Frame, value: float, slides: bool) -> Frame:
    """Return the frame turned about its z axis by ``value``, or slid along it."""
    x0, x1, x2, y0, y1, y2, z0, z1, z2, p0, p1, p2 = frame
    if slides:
        p0 += value * z0
        p1 += value * z1
        p2 += value * z2
        return x0, x1, x2, y0, y1, y2, z0, z1, z2, p0, p1, p2
    c, s = math.cos(value), math.sin(value)
    u0, u1, u2 = c * x0 + s * y0, c * x1 + s * y1, c * x2 + s * y2
    v0, v1, v2 = c * y0 - s * x0, c * y1 - s * x1, c * y2 - s * x2
    return u0, u1, u2, v0, v1, v2, z0, z1, z2, p0, p1, p2


@leaf_kernel
def forward_into(chain: Chain, q: Array, R: Array, p: Array, z: Array, o: Array) -> None:
    """Write the tool pose and every joint's axis and origin.

    Args:
        chain: The chain, n serial joints.
        q: Joint values, shape (dof,) [rad or m].
        R: Out: rotation of the tool in the base, shape (3, 3).
        p: Out: position of the tool in the base, shape (3,) [m].
        z: Out: joint axes in the base, shape (n, 3).
        o: Out: joint origins in the base, shape (n, 3) [m].
    """
    T, prismatic, coupled = chain.placements, chain.prismatic, chain.coupled
    coupling, offset = chain.coupling, chain.offset
    n = prismatic.shape[0]
    frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    for i in range(n):
        frame = placed(T, i, frame)
        z[i, 0], z[i, 1], z[i, 2] = frame[6], frame[7], frame[8]
        o[i, 0], o[i, 1], o[i, 2] = frame[9], frame[10], frame[11]
        if coupled:
            value = offset[i]
            for k in range(q.shape[0]):
                value += coupling[i, k] * q[k]
        else:
            value = q[i]
        frame = moved(frame, value, prismatic[i])
    frame = placed(T, n, frame)
    R[0, 0], R[1, 0], R[2, 0] = frame[0], frame[1], frame[2]
    R[0, 1], R[1, 1], R[2, 1] = frame[3], frame[4], frame[5]
    R[0, 2], R[1, 2], R[2, 2] = frame[6], frame[7], frame[8]
    p[0], p[1], p[2] = frame[9], frame[10], frame[11]


@leaf_kernel
def jacobian_into(chain: Chain, R: Array, p: Array, z: Array, o: Array, Jt: Array) -> None:
    """Write the transposed tool-frame Jacobian from what :func:`forward_into` left.

    Args:
        chain: The chain, n serial joints.
        R: Rotation of the tool in the base, shape (3, 3).
        p: Position of the tool in the base, shape (3,) [m].
        z: Joint axes in the base, shape (n, 3).
        o: Joint origins in the base, shape (n, 3) [m].
        Jt: Out: transposed Jacobian in the tool frame, shape (dof, 6), linear part first.
    """
    prismatic, coupled, coupling = chain.prismatic, chain.coupled, chain.coupling
    if coupled:
        Jt[:, :] = 0.0
    p0, p1, p2 = p[0], p[1], p[2]
    for i in range(prismatic.shape[0]):
        z0, z1, z2 = z[i, 0], z[i, 1], z[i, 2]
        if prismatic[i]:
            l0, l1, l2 = z0, z1, z2
            z0, z1, z2 = 0.0, 0.0, 0.0
        else:
            d0, d1, d2 = p0 - o[i, 0], p1 - o[i, 1], p2 - o[i, 2]
            l0, l1, l2 = z1 * d2 - z2 * d1, z2 * d0 - z0 * d2, z0 * d1 - z1 * d0
        for row in range(3):
            linear = R[0, row] * l0 + R[1, row] * l1 + R[2, row] * l2
            angular = R[0, row] * z0 + R[1, row] * z1 + R[2, row] * z2
            if coupled:
                for k in range(Jt.shape[0]):
                    Jt[k, row] += linear * coupling[i, k]
                    Jt[k, row + 3] += angular * coupling[i, k]
            else:
                Jt[i, row] = linear
                Jt[i, row + 3] = angular


@kernel
def forward(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Return the tool pose.

    Args:
        chain: The chain.
        q: Joint values, shape (dof,) [rad or m].

    Returns:
        Rotation of the tool in the base, shape (3, 3), and its position, shape (3,) [m].
    """
    n = chain.prismatic.shape[0]
    R, p = np.empty((3, 3)), np.empty(3)
    z, o = np.empty((n, 3)), np.empty((n, 3))
    forward_into(chain, q, R, p, z, o)
    return R, p


@kernel
def forward_batch(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Return the tool poses of many configurations.

    Args:
        chain: The chain.
        q: Joint values, shape (m, dof) [rad or m].

    Returns:
        Rotations, shape (m, 3, 3), and positions, shape (m, 3) [m], of the tool in the base.
    """
    m, n = q.shape[0], chain.prismatic.shape[0]
    R, p = np.empty((m, 3, 3)), np.empty((m, 3))
    z, o = np.empty((n, 3)), np.empty((n, 3))
    for k in range(m):
        forward_into(chain, q[k], R[k], p[k], z, o)
    return R, p


@kernel
def jacobian(chain: Chain, q: Array) -> Array:
    """Return the tool-frame Jacobian, shape (6, dof), linear rows first.

    Args:
        chain: The chain.
        q: Joint values, shape (dof,) [rad or m].
    """
    n = chain.prismatic.shape[0]
    R, p = np.empty((3, 3)), np.empty(3)
    z, o = np.empty((n, 3)), np.empty((n, 3))
    Jt = np.empty((q.shape[0], 6))
    forward_into(chain, q, R, p, z, o)
    jacobian_into(chain, R, p, z, o, Jt)
    return Jt.T.copy()


@leaf_kernel
def rotation_log(R: Array, out: Array) -> float:
    """Write the rotation vector of a rotation matrix; return its angle.

    Exact to rounding at every angle, near the identity and near half turns too.

    Args:
        R: Rotation, shape (3, 3).
        out: Out: rotation vector, first three entries [rad].

    Returns:
        The angle, in [0, pi] [rad].
    """
    s0, s1, s2 = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    sine = 0.5 * math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    cosine = 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)
    angle = math.atan2(sine, cosine)
    if cosine > -0.5:
        # angle / sin(angle) is 1 to rounding below 1e-8.
        scale = 0.5 if sine < 1e-8 else 0.5 * angle / sine
        out[0], out[1], out[2] = scale * s0, scale * s1, scale * s2
        return angle
    # Towards a half turn the skew part fades, and the symmetric part, cos I + (1 - cos) a a^T, has
    # the axis; its largest column is the best conditioned.
    k = 0
    for i in range(1, 3):
        if R[i, i] > R[k, k]:
            k = i
    versine = 1.0 - cosine
    length = math.sqrt((R[k, k] - cosine) / versine)
    for i in range(3):
        out[i] = angle * (0.5 * (R[i, k] + R[k, i]) / (versine * length) if i != k else length)
    # Of a and -a, the one that agrees with what there is of the skew part.
    if s0 * out[0] + s1 * out[1] + s2 * out[2] < 0.0:
        out[0], out[1], out[2] = -out[0], -out[1], -out[2]
    return angle


@leaf_kernel
def pose_error(
    R: Array, p: Array, R_target: Array, p_target: Array, E: Array, e: Array, turn: Array
) -> tuple[float, float]:
    """Write the error of a pose, in its own frame: what a motion of the tool has to make up.

    Args:
        R: Rotation of the tool in the base, shape (3, 3).
        p: Position of the tool in the base, shape (3,) [m].
        R_target: Rotation wanted, shape (3, 3).
        p_target: Position wanted, shape (3,) [m].
        E: Work space, shape (3, 3).
        e: Out: R^T (p_target - p) and log(R^T R_target), shape (6,) [m, rad].
        turn: Work space, shape (3,).

    Returns:
        Distance [m] and rotation angle [rad] from the target.
    """
    d0, d1, d2 = p_target[0] - p[0], p_target[1] - p[1], p_target[2] - p[2]
    for i in range(3):
        r0, r1, r2 = R[0, i], R[1, i], R[2, i]
        e[i] = r0 * d0 + r1 * d1 + r2 * d2
        for k in range(3):
            E[i, k] = r0 * R_target[0, k] + r1 * R_target[1, k] + r2 * R_target[2, k]
    angle = rotation_log(E, turn)
    e[3], e[4], e[5] = turn[0], turn[1], turn[2]
    return math.sqrt(d0 * d0 + d1 * d1 + d2 * d2), angle
