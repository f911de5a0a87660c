"""Whether the tool is within a region, at a configuration and all along a cubic, and how to get in.

A cubic is cut in halves until, at the middle of each part, the tool is farther inside than the
joints can carry it within that part: by the largest distance of a Bezier control value from the
middle, times how far a unit of each joint value turns or moves the tool at most.
"""

from __future__ import annotations

import math

from ikplan._jit import leaf_kernel
from ikplan.arrays import Array
from ikplan.kinematics.forward import forward_into, jacobian_into
from ikplan.planning.moves.region.tool_region import RegionScratch, ToolRegion

__all__ = ["cubic_inside", "excess", "project", "straight_inside"]

_HALVINGS = 14
"""How often a part is halved before it counts as outside."""
_STEPS = 20
"""Steps of a projection."""
_INWARDS = 0.9
"""Share of the region that a projection gets into: motions between two places in it bulge."""


@leaf_kernel
def excess(region: ToolRegion, share: float, q: Array, w: RegionScratch) -> tuple[float, float]:
    """Return by how much the tool is outside: of the cone [rad], of the box [m]; < 0: inside.

    Args:
        region: The region.
        share: Share of its cone and of its box that is asked for.
        q: Joint values, shape (dof,) [rad or m].
        w: Work space; has the tool pose and the joint axes afterwards.
    """
    forward_into(region.chain, q, w.R, w.p, w.z, w.o)
    a0, a1, a2 = w.R[0, region.axis], w.R[1, region.axis], w.R[2, region.axis]
    d = region.direction
    c0, c1, c2 = a1 * d[2] - a2 * d[1], a2 * d[0] - a0 * d[2], a0 * d[1] - a1 * d[0]
    across = math.sqrt(c0 * c0 + c1 * c1 + c2 * c2)
    angle = math.atan2(across, a0 * d[0] + a1 * d[1] + a2 * d[2])
    outside = -math.inf
    for k in range(3):
        along = 0.0
        for i in range(3):
            along += region.R[i, k] * (w.p[i] - region.middle[i])
        outside = max(outside, abs(along) - share * region.half[k])
    turned = angle - share * region.cone if region.cone < math.pi else -math.inf
    return turned, outside


@leaf_kernel
def _proven(region: ToolRegion, share: float, top: int, w: RegionScratch) -> int:
    """Look at the cubic on top of the stack: 1 all is inside, -1 its middle is not, 0 else."""
    c = w.controls[top]
    turned = moved = 0.0
    for d in range(c.shape[1]):
        middle = 0.125 * (c[0, d] + 3.0 * (c[1, d] + c[2, d]) + c[3, d])
        w.q[d] = middle
        most = 0.0
        for k in range(4):
            most = max(most, abs(c[k, d] - middle))
        turned += region.turn[d] * most
        moved += region.reach[d] * most
    angle, distance = excess(region, share, w.q, w)
    if angle > 0.0 or distance > 0.0:
        return -1
    return 1 if angle + turned <= 0.0 and distance + moved <= 0.0 else 0


@leaf_kernel
def cubic_inside(region: ToolRegion, share: float, w: RegionScratch) -> bool:
    """Whether the tool is proven inside along the cubic in ``w.controls[0]``, which is used up."""
    w.halvings[0] = 0.0
    top = 0
    while top >= 0:
        verdict = _proven(region, share, top, w)
        if verdict < 0:
            return False
        if verdict > 0:
            top -= 1
            continue
        if w.halvings[top] >= _HALVINGS or top + 1 >= w.controls.shape[0]:
            return False
        c, second = w.controls[top], w.controls[top + 1]
        for d in range(c.shape[1]):
            c0, c1, c2, c3 = c[0, d], c[1, d], c[2, d], c[3, d]
            m01, m12, m23 = 0.5 * (c0 + c1), 0.5 * (c1 + c2), 0.5 * (c2 + c3)
            left, right = 0.5 * (m01 + m12), 0.5 * (m12 + m23)
            middle = 0.5 * (left + right)
            c[1, d], c[2, d], c[3, d] = m01, left, middle
            second[0, d], second[1, d], second[2, d], second[3, d] = middle, right, m23, c3
        w.halvings[top] += 1.0
        w.halvings[top + 1] = w.halvings[top]
        top += 1
    return True


@leaf_kernel
def straight_inside(region: ToolRegion, share: float, a: Array, b: Array, w: RegionScratch) -> bool:
    """Whether the tool is proven inside along the straight motion from a to b."""
    for d in range(a.shape[0]):
        third = (b[d] - a[d]) / 3.0
        w.controls[0, 0, d], w.controls[0, 3, d] = a[d], b[d]
        w.controls[0, 1, d], w.controls[0, 2, d] = a[d] + third, b[d] - third
    return cubic_inside(region, share, w)


@leaf_kernel
def project(region: ToolRegion, lower: Array, upper: Array, q: Array, w: RegionScratch) -> bool:
    """Move a configuration into the region, in place; whether that was done.

    Each step puts right what is violated, one after the other, by the shortest joint motion to
    first order.

    Args:
        region: The region.
        lower: Lower bounds, shape (dof,) [rad or m].
        upper: Upper bounds, shape (dof,) [rad or m].
        q: The configuration, shape (dof,) [rad or m].
        w: Work space.
    """
    dof = q.shape[0]
    for _ in range(_STEPS):
        angle, distance = excess(region, _INWARDS, q, w)
        if angle <= 0.0 and distance <= 0.0:
            return True
        jacobian_into(region.chain, w.R, w.p, w.z, w.o, w.Jt)
        for row in range(-1, 3):
            missing, n0, n1, n2 = 0.0, 0.0, 0.0, 0.0
            if row < 0:
                if angle <= 0.0:
                    continue
                missing = angle
                a0, a1, a2 = w.R[0, region.axis], w.R[1, region.axis], w.R[2, region.axis]
                d = region.direction
                n0, n1, n2 = a2 * d[1] - a1 * d[2], a0 * d[2] - a2 * d[0], a1 * d[0] - a0 * d[1]
            else:
                along = 0.0
                for i in range(3):
                    along += region.R[i, row] * (w.p[i] - region.middle[i])
                missing = abs(along) - _INWARDS * region.half[row]
                if missing <= 0.0:
                    continue
                sign = 1.0 if along > 0.0 else -1.0
                n0, n1, n2 = (
                    sign * region.R[0, row],
                    sign * region.R[1, row],
                    sign * region.R[2, row],
                )
            norm = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
            if norm < 1e-9:
                return False
            square, first = 0.0, 3 if row < 0 else 0
            # The normal in the tool frame, in which the Jacobian is.
            t0 = (w.R[0, 0] * n0 + w.R[1, 0] * n1 + w.R[2, 0] * n2) / norm
            t1 = (w.R[0, 1] * n0 + w.R[1, 1] * n1 + w.R[2, 1] * n2) / norm
            t2 = (w.R[0, 2] * n0 + w.R[1, 2] * n1 + w.R[2, 2] * n2) / norm
            for j in range(dof):
                J = w.Jt[j]
                w.step[j] = J[first] * t0 + J[first + 1] * t1 + J[first + 2] * t2
                square += w.step[j] * w.step[j]
            if square < 1e-12:
                return False
            for j in range(dof):
                q[j] -= missing * w.step[j] / square
        for j in range(dof):
            q[j] = min(max(q[j], lower[j]), upper[j])
    return False
