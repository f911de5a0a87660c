"""Compiled joint torques of given motions: Newton's and Euler's equations along a chain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ikplan._jit import kernel, leaf_kernel
from ikplan.arrays import Array
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import moved, placed

__all__ = ["Bodies", "joint_torques"]


class Bodies(NamedTuple):
    """The bodies that the n joints of a chain move, in the frames of the chain's joints.

    Attributes:
        mass: Shape (n,) [kg].
        centre: Centres of mass, shape (n, 3) [m].
        inertia: About the centres of mass, shape (n, 3, 3) [kg m^2].
        armature: Inertias of the rotors as the joints see them, shape (n,) [kg m^2 or kg].
        gravity: Acceleration of free fall in the base, shape (3,) [m/s^2].
    """

    mass: Array
    centre: Array
    inertia: Array
    armature: Array
    gravity: Array


@leaf_kernel
def _cross(a: Array, b: Array, out: Array) -> None:
    """Add the cross product of a and b to out."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@leaf_kernel
def _add(factor: float, a: Array, out: Array) -> None:
    """Add a multiple of a to out."""
    for k in range(3):
        out[k] += factor * a[k]


@leaf_kernel
def _clear(a: Array) -> None:
    for k in range(3):
        a[k] = 0.0


@leaf_kernel
def _inertia_times(R: Array, inertia: Array, v: Array, out: Array) -> None:
    """Add to out the product of a body's inertia, in its own axes R, and v."""
    v0 = R[0, 0] * v[0] + R[1, 0] * v[1] + R[2, 0] * v[2]
    v1 = R[0, 1] * v[0] + R[1, 1] * v[1] + R[2, 1] * v[2]
    v2 = R[0, 2] * v[0] + R[1, 2] * v[1] + R[2, 2] * v[2]
    for j in range(3):
        along = inertia[j, 0] * v0 + inertia[j, 1] * v1 + inertia[j, 2] * v2
        for k in range(3):
            out[k] += R[k, j] * along


@kernel
def joint_torques(chain: Chain, bodies: Bodies, q: Array, dq: Array, ddq: Array) -> Array:
    """Return the torques of the serial joints, by the recursion of Luh, Walker and Paul (1980).

    Args:
        chain: The chain.
        bodies: What it moves.
        q: Joint values, shape (m, dof) [rad or m].
        dq: Joint velocities, shape (m, dof).
        ddq: Joint accelerations, shape (m, dof).

    Returns:
        Shape (m, n) [N m or N].
    """
    m, n = q.shape[0], chain.prismatic.shape[0]
    out = np.empty((m, n))
    axis, arm, force, moment = (
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((n, 3)),
    )
    R = np.empty((3, 3))
    w, dw, a, c = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    spin, before = np.empty(3), np.empty(3)
    changes = np.empty(n)
    for row in range(m):
        _clear(w)
        _clear(dw)
        _clear(before)
        # As if the base were accelerated upwards, instead of every body pulled down.
        _clear(a)
        _add(-1.0, bodies.gravity, a)
        frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        for i in range(n):
            frame = placed(chain.placements, i, frame)
            if chain.coupled:
                value, rate, change = chain.offset[i], 0.0, 0.0
                for k in range(q.shape[1]):
                    value += chain.coupling[i, k] * q[row, k]
                    rate += chain.coupling[i, k] * dq[row, k]
                    change += chain.coupling[i, k] * ddq[row, k]
            else:
                value, rate, change = q[row, i], dq[row, i], ddq[row, i]
            changes[i] = change
            slides = chain.prismatic[i]
            frame = moved(frame, value, slides)
            R[0, 0], R[1, 0], R[2, 0] = frame[0], frame[1], frame[2]
            R[0, 1], R[1, 1], R[2, 1] = frame[3], frame[4], frame[5]
            R[0, 2], R[1, 2], R[2, 2] = frame[6], frame[7], frame[8]
            z, d, f, t = axis[i], arm[i], force[i], moment[i]
            z[0], z[1], z[2] = frame[6], frame[7], frame[8]
            # The origin of this joint's frame, moved with the body before.
            d[0], d[1], d[2] = frame[9] - before[0], frame[10] - before[1], frame[11] - before[2]
            before[0], before[1], before[2] = frame[9], frame[10], frame[11]
            _clear(spin)
            _cross(w, d, spin)
            _cross(dw, d, a)
            _cross(w, spin, a)
            _clear(spin)
            if slides:
                _add(2.0 * rate, z, spin)
                _cross(w, spin, a)
                _add(change, z, a)
            else:
                _add(rate, z, spin)
                _cross(w, spin, dw)
                _add(change, z, dw)
                _add(rate, z, w)
            for k in range(3):
                c[k] = (
                    R[k, 0] * bodies.centre[i, 0]
                    + R[k, 1] * bodies.centre[i, 1]
                    + R[k, 2] * bodies.centre[i, 2]
                )
            _clear(spin)
            _cross(w, c, spin)
            _clear(f)
            _cross(dw, c, f)
            _cross(w, spin, f)
            for k in range(3):
                f[k] = bodies.mass[i] * (f[k] + a[k])
            _clear(t)
            _inertia_times(R, bodies.inertia[i], dw, t)
            _clear(spin)
            _inertia_times(R, bodies.inertia[i], w, spin)
            _cross(w, spin, t)
            _cross(c, f, t)
        for i in range(n - 1, -1, -1):
            if i + 1 < n:
                _cross(arm[i + 1], force[i + 1], moment[i])
                _add(1.0, moment[i + 1], moment[i])
                _add(1.0, force[i + 1], force[i])
            along = force[i] if chain.prismatic[i] else moment[i]
            out[row, i] = bodies.armature[i] * changes[i] + (
                axis[i, 0] * along[0] + axis[i, 1] * along[1] + axis[i, 2] * along[2]
            )
    return out
