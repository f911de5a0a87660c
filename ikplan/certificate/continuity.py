"""Whether samples are one motion: order of time, ends, no hidden jump."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import steps_of
from ikplan.certificate.claim import Claim
from ikplan.errors import CertificateViolated

__all__ = ["check_finite", "discontinuities"]

_ROUNDING = 1e-9
"""What joint values and velocities may be off by rounding [rad or m, and per second]."""


def check_finite(claim: Claim) -> None:
    """Refuse what is not finite before it slips through every comparison.

    Raises:
        CertificateViolated: Names the arrays.
    """
    names = ("waypoint_q", "waypoint_time", "time", "q", "dq", "ddq")
    bad = [name for name in names if not np.isfinite(getattr(claim, name)).all()]
    if bad:
        violation = f"not every number is finite in {', '.join(bad)}"
        raise CertificateViolated(
            f"the finished trajectory broke a promise: {violation}",
            certificate={},
            violations=[violation],
        )


def _wrong_ends(claim: Claim) -> list[str]:
    """What is wrong with the velocities at the ends, the duration and the dwells, in words."""
    wrong = []
    wanted = (claim.start_velocity, claim.end_velocity)
    if all(v is None for v in wanted):
        if claim.dq[0].any() or claim.dq[-1].any():
            wrong.append("the motion does not begin and end at rest")
    else:
        for at, name, v in ((0, "begin", wanted[0]), (-1, "end", wanted[1])):
            off = np.abs(claim.dq[at] - (0.0 if v is None else v))
            if (off > _ROUNDING).any():
                wrong.append(f"the motion does not {name} with the velocity asked for")
    if claim.duration is not None and abs(claim.time[-1] - claim.duration) > _ROUNDING:
        wrong.append("the motion does not take the time asked for")
    for row, time in enumerate(claim.times or ()):
        if time is not None and abs(claim.waypoint_time[row] - time) > _ROUNDING:
            wrong.append(f"waypoint {row} is not passed at {time:g} s")
    for row, seconds in claim.dwells:
        arrives = claim.waypoint_time[row]
        edge = _ROUNDING + 1e-12 * claim.time[-1]
        inside = (claim.time > arrives + edge) & (claim.time < arrives + seconds - edge)
        moves = np.abs(claim.dq[inside]).max(initial=0.0) > _ROUNDING
        away = np.abs(claim.q[inside] - claim.waypoint_q[row]).max(initial=0.0) > _ROUNDING
        if moves or away or arrives + seconds > claim.time[-1] + edge:
            wrong.append(f"the motion does not stand at waypoint {row} for {seconds:g} s")
    return wrong


def discontinuities(claim: Claim) -> list[str]:
    """Return what is wrong with the samples as one motion, in words.

    A joint whose acceleration never exceeds a moves, in a time t, at most a t^2 / 2 away from
    where its velocity would bring it: a sample or a waypoint farther off is a hidden jump.
    """
    wrong = []
    steps, end = steps_of(claim.time), claim.time[-1]
    if claim.time[0] != 0.0 or (steps <= 0.0).any():
        wrong.append("sample times do not increase strictly from 0")
    wrong += _wrong_ends(claim)
    if claim.q_start is not None and not np.array_equal(claim.q[0], claim.q_start):
        wrong.append("the first sample is not the start asked for")
    if not np.array_equal(claim.q[-1], claim.waypoint_q[-1]):
        wrong.append("the last sample is not the last waypoint")
    limits = claim.limits
    a = limits.largest_acceleration * (1.0 + 1e-6)
    dt = steps[:, None]
    if (np.abs(steps_of(claim.dq)) > a * dt + _ROUNDING).any():
        wrong.append("velocities jump between samples")
    off = np.abs(steps_of(claim.q) - claim.dq[:-1] * dt)
    if (off > 0.5 * a * dt**2 + _ROUNDING).any():
        wrong.append("positions jump between samples")
    passed = claim.waypoint_time
    stands = sum(seconds for row, seconds in claim.dwells if row == len(passed) - 1)
    last = passed[-1] + stands
    if (steps_of(passed) < 0.0).any() or passed[0] < 0.0 or abs(last - end) > 1e-9 * end:
        wrong.append("waypoint times do not increase to the end of the motion")
    # Seen from the sample before and from the sample after.
    at = np.maximum(np.searchsorted(claim.time, passed, side="right") - 1, 0)
    for k in (at, np.minimum(at + 1, len(claim.time) - 1)):
        away = (passed - claim.time[k])[:, None]
        reached = np.abs(claim.waypoint_q - claim.q[k] - claim.dq[k] * away)
        if (reached > 0.5 * a * away**2 + _ROUNDING).any():
            wrong.append("a waypoint is not passed at its time")
            break
    return wrong
