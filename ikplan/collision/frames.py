"""Frames of all links of a chain at a configuration, compiled."""

from __future__ import annotations

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.kinematics.chain import Chain
from ikplan.kinematics.forward import moved, placed

__all__ = ["link_frames"]


@leaf_kernel
def link_frames(chain: Chain, q: Array, R: Array, p: Array) -> None:
    """Write the frame of the base and of every link; the z axis of frame k is that of joint k.

    Args:
        chain: The chain, n serial joints.
        q: Joint values, shape (dof,) [rad or m].
        R: Out: rotations in the base, shape (n + 1, 3, 3).
        p: Out: origins in the base, shape (n + 1, 3) [m].
    """
    frame = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    for k in range(chain.prismatic.shape[0] + 1):
        if k > 0:
            frame = placed(chain.placements, k - 1, frame)
            if chain.coupled:
                value = chain.offset[k - 1]
                for d in range(q.shape[0]):
                    value += chain.coupling[k - 1, d] * q[d]
            else:
                value = q[k - 1]
            frame = moved(frame, value, chain.prismatic[k - 1])
        R[k, 0, 0], R[k, 1, 0], R[k, 2, 0] = frame[0], frame[1], frame[2]
        R[k, 0, 1], R[k, 1, 1], R[k, 2, 1] = frame[3], frame[4], frame[5]
        R[k, 0, 2], R[k, 1, 2], R[k, 2, 2] = frame[6], frame[7], frame[8]
        p[k, 0], p[k, 1], p[k, 2] = frame[9], frame[10], frame[11]
