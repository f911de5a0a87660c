"""Whether the tool goes all the way along its paths, and leaves no part of them out.

A sample can be near its path where two parts of the path are near one another, as about the crest
of a hairpin: the tool may turn round before the crest and never be far from the path, while the
crest is far from the tool.
"""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array, Indices, clamped, steps_of
from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import MatchedLeg, Tool
from ikplan.certificate.elongation import joint_reach
from ikplan.certificate.offsets import Allowance

__all__ = ["left_out"]


_WITHIN = np.linspace(0.0, 1.0, 17)
_PLACES = 65
_MOST = 24
"""Most steps that are looked at closely, those that gain most on the tool first."""


def left_out(
    claim: Claim, part: MatchedLeg, tool: Tool, allowance: Allowance
) -> tuple[float, float]:
    """Return how far the tool is from the part of a path that it comes least near to.

    Only where the path between two samples is longer than the way of the tool by more than the
    tolerance is there anything to leave out. There, places of the path are held to the motion of
    all samples that are about there, by the cubics that have their joint values and velocities.

    Args:
        claim: The trajectory.
        part: Where the tool is on a path.
        tool: Poses of the tool.
        allowance: What is allowed.

    Returns:
        Distance beyond the box, and beyond what the motion may do unseen between samples [m], and
        the time [s]; 0: the tool keeps up with the path.
    """
    path, s = part.leg.path, part.s
    if len(s) < 2:
        return 0.0, 0.0
    # Of what need not be followed, nothing can be left out.
    ahead = clamped(np.maximum.accumulate(s), *part.leg.followed)
    steps = steps_of(tool.p[part.sample])
    way = np.sqrt((steps * steps).sum(axis=1))
    box = float(np.linalg.norm(allowance.box_position))
    unseen = _unseen(claim)
    slack = 2.0 * (allowance.position + box)
    gained = steps_of(ahead) - way - allowance.position
    middle = path.piece_at(0.5 * (ahead[1:] + ahead[:-1]))
    gained[path.spots[middle]] = -np.inf
    worst, when = 0.0, 0.0
    for k in np.argsort(-gained, kind="stable")[:_MOST]:
        if gained[k] <= 0.0:
            break
        low, high = ahead[k], ahead[k + 1]
        nodes = path.nodes[(path.nodes > low) & (path.nodes < high)]
        places = np.concatenate([np.linspace(low, high, _PLACES), nodes[: 8 * _PLACES]])
        piece = path.piece_at(places)
        p = path.derivatives(piece, places - path.begins[piece]).p
        # All samples that are about there, or are between such: which of two strands a sample is
        # on does not follow from where it is.
        width = high - low + slack
        first, last = np.searchsorted(ahead, [low - width, high + width])
        here = (s[:-1] <= high + width) & (s[1:] >= low - width)
        here[max(first - 1, 0) : last + 1] = True
        about = np.flatnonzero(here)
        far = float(_distances(p, _between(claim, part.sample[about])).max()) - box - unseen
        if far > worst:
            worst, when = far, float(claim.time[part.sample[k]])
    return worst, when


def _unseen(claim: Claim) -> float:
    """How far the tool may be, between samples, from where their cubics have it [m].

    Within a time h, an acceleration that is anywhere between its limits moves a joint at most
    a h^2 / 8 away from the straight line between its ends, and the cubic is no farther off.
    """
    limits = claim.limits
    a = limits.largest_acceleration
    h = float(steps_of(claim.time).max())
    return float(joint_reach(claim.robot) @ a) * h * h / 8.0


def _between(claim: Claim, first: Indices) -> Array:
    """Positions of the tool between some samples and the next, shape (n, 17, 3) [m]."""
    q0, q1, v0, v1 = claim.q[first], claim.q[first + 1], claim.dq[first], claim.dq[first + 1]
    h = (claim.time[first + 1] - claim.time[first])[:, None, None]
    x = _WITHIN[None, :, None]
    rise = (q1 - q0)[:, None]
    d0, d1 = h * v0[:, None], h * v1[:, None]
    q = q0[:, None] + x * (d0 + x * (3.0 * rise - 2.0 * d0 - d1 + x * (d0 + d1 - 2.0 * rise)))
    _, p = claim.robot.poses(q.reshape(-1, q.shape[2]))
    return np.asarray(p.reshape(len(first), len(_WITHIN), 3))


def _distances(p: Array, motion: Array) -> Array:
    """Distance of points, shape (k, 3), from polylines, shape (n, j, 3), whichever is nearest."""
    a = motion[:, :-1].reshape(-1, 3)
    along = motion[:, 1:].reshape(-1, 3) - a
    square = (along * along).sum(axis=1)
    nearest = np.full(len(p), np.inf)
    for k, point in enumerate(p):
        share = ((point - a) * along).sum(axis=1) / np.where(square > 0.0, square, 1.0)
        off = point - a - np.clip(share, 0.0, 1.0)[:, None] * along
        nearest[k] = np.sqrt((off * off).sum(axis=1).min())
    return nearest
