"""How near a motion comes to a singularity, in the directions that its targets ask for."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Flags, Indices, clamped
from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import MatchedLeg
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedMotion

__all__ = ["least_singular_value"]


_LOOKS = 128


def least_singular_value(
    claim: Claim, motion: RequestedMotion | None, matched: list[MatchedLeg]
) -> tuple[float, float]:
    """Return the smallest singular value of the tool Jacobian over the samples, and its time [s].

    Rows are the tool's linear velocity, and what the target at that instant asks of its angular
    velocity: all of it, none where the orientation is free, that across the free axis. On a joint
    motion they are those of the waypoints at its ends. An arm with fewer joints than rows is
    measured on the linear ones. Looked for on 128 samples spread evenly, then on every sample
    around the smallest of them.

    Args:
        claim: The trajectory.
        motion: What the path asks for; None: joint waypoints, whose tool is measured in all rows.
        matched: Where the tool is on its paths.
    """
    oriented = _oriented(claim, motion, matched)
    axis = None if claim.path is None else Allowance(claim.path).free_axis
    count = len(claim.time)
    stride = max(1, count // _LOOKS)
    coarse = np.append(np.arange(0, count, stride), count - 1)
    looked = _values(claim, coarse, oriented, axis)
    centre = int(coarse[np.argmin(looked)])
    if stride == 1:  # that was every sample
        return float(looked[centre]), float(claim.time[centre])
    fine = np.arange(max(0, centre - stride), min(count, centre + stride + 1))
    found = _values(claim, fine, oriented, axis)
    k = int(np.argmin(found))
    return float(found[k]), float(claim.time[fine[k]])


def _oriented(claim: Claim, motion: RequestedMotion | None, matched: list[MatchedLeg]) -> Flags:
    """Whether an orientation is asked for at each sample, shape (m,)."""
    if claim.path is None or motion is None:
        return np.ones(len(claim.time), dtype=np.bool_)
    if claim.path.orientation_free == "all":
        return np.zeros(len(claim.time), dtype=np.bool_)
    asked = np.array([w.R is not None for w in motion.waypoints])
    after = clamped(np.searchsorted(claim.waypoint_time, claim.time), 0, len(asked) - 1)
    before = np.maximum(after - 1, 0)
    oriented = asked[after] | asked[before]
    for part in matched:
        oriented[part.sample] = part.oriented
    return np.asarray(oriented)


def _values(claim: Claim, samples: Indices, oriented: Flags, axis: int | None) -> Array:
    J = claim.robot.jacobians(claim.q[samples])
    full = [0, 1, 2, *(3 + k for k in range(3) if k != axis)]
    if claim.robot.dof < len(full):
        full = [0, 1, 2]
    turned = oriented[samples]
    if turned.all():
        return _least(J if len(full) == 6 else J[:, full])
    values = np.empty(len(samples))
    for here, rows in ((turned, full), (~turned, [0, 1, 2])):
        if here.any():
            values[here] = _least(J[here][:, rows])
    return values


def _least(J: Array) -> Array:
    """Smallest singular values of matrices, shape (m, r, c), shape (m,)."""
    transposed = J.transpose(0, 2, 1)
    gram = J @ transposed if J.shape[1] <= J.shape[2] else transposed @ J
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(gram)[:, 0], 0.0)))
