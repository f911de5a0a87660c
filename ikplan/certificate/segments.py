"""The certificate of parts of a motion with limits of their own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Flags
from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import MatchedLeg
from ikplan.certificate.limits import measured_limits
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import RequestedMotion
from ikplan.documents.certificate import SegmentCertificate
from ikplan.limits.motion_limits import MotionLimits

__all__ = ["TimedSegment", "segment_checks", "timed_segments"]


_EDGE = 1e-9
"""A sample this near to an end of a segment, as a share of the duration, is of its neighbour."""


@dataclass(frozen=True, eq=False)
class TimedSegment:
    """Limits that hold between two times.

    Attributes:
        field: The field of the request.
        begin: When they begin [s].
        end: When they end [s].
        limits: All limits of the motion there.
    """

    field: str
    begin: float
    end: float
    limits: MotionLimits


def timed_segments(
    claim: Claim, motion: RequestedMotion | None, matched: list[MatchedLeg]
) -> list[TimedSegment]:
    """Return when each segment with limits of its own is passed.

    Between waypoints, it is passed between their times. A rounded corner belongs to both its
    neighbours: there, from where the tool enters it to where it leaves it.

    Args:
        claim: The trajectory.
        motion: What the path asks for; None: there is no path.
        matched: Where the tool is on its paths.
    """
    robot, limits, times = claim.robot, claim.limits, claim.waypoint_time
    found = [
        TimedSegment(
            part.field,
            float(times[part.first]),
            float(times[part.last]),
            limits.within(robot, part.limits, f"{part.field}.limits"),
        )
        for part in claim.segments
    ]
    if claim.path is None or motion is None:
        return found
    own = {
        f"path.segments[{k}]": segment.limits
        for k, segment in enumerate(claim.path.segments or ())
        if segment.limits is not None
    }
    if not own:
        return found
    passed = _passed(claim, motion, matched)
    for field, asked in own.items():
        begin, end = passed.get(field, (times[motion.last_rows[field]],) * 2)
        within = limits.within(robot, asked, f"{field}.limits")
        found.append(TimedSegment(field, float(begin), float(end), within))
    return found


def _passed(
    claim: Claim, motion: RequestedMotion, matched: list[MatchedLeg]
) -> dict[str, tuple[float, float]]:
    """When the segments of a path are passed, those of no length left out."""
    times = claim.waypoint_time
    passed = {}
    for joint in motion.joint_segments:
        begin = claim.time[0] if joint.begin_row is None else times[joint.begin_row]
        passed[joint.field] = (begin, times[joint.end_row])
    assert claim.path is not None
    allowance = Allowance(claim.path)
    # How far off the tool may be along its path without leaving it.
    slack = 2.0 * (allowance.position + float(np.linalg.norm(allowance.box_position)))
    for part in matched:
        leg, when = part.leg, claim.time[part.sample]
        ahead = np.maximum.accumulate(part.s)
        for segment in leg.path.segments:
            begin, end = np.interp([segment.begin, segment.end], leg.s, leg.time)
            if segment.rounded_begin:
                inside = when[ahead >= segment.begin + slack]
                begin = inside[0] if len(inside) else when[-1]
            if segment.rounded_end:
                inside = when[ahead <= segment.end - slack]
                end = inside[-1] if len(inside) else when[0]
            passed[segment.field] = (begin, end)
    return passed


def segment_checks(
    claim: Claim, parts: list[TimedSegment]
) -> tuple[list[SegmentCertificate], list[str]]:
    """Measure the limit ratios of a motion on its segments.

    Returns:
        Their part of the certificate, and which limits are exceeded, in words.
    """
    found, exceeded = [], []
    edge = _EDGE * float(claim.time[-1])
    for part in parts:
        inside = (claim.time > part.begin + edge) & (claim.time < part.end - edge)
        # The samples at rest are of the first and of the last segment.
        lasts = part.end > part.begin
        inside[0] |= lasts and part.begin <= 0.0
        inside[-1] |= lasts and part.end >= claim.time[-1] - edge
        certificate, words = _measured(claim, part, inside)
        found.append(certificate)
        exceeded += [f"{part.field}: {word}" for word in words]
    return found, exceeded


def _measured(
    claim: Claim, part: TimedSegment, inside: Flags
) -> tuple[SegmentCertificate, list[str]]:
    certificate = SegmentCertificate(field=part.field, begin=part.begin, end=part.end)
    if not inside.any():
        return certificate, []
    motion = (claim.time[inside], claim.q[inside], claim.dq[inside], claim.ddq[inside])
    measured, exceeded = measured_limits(claim.robot, part.limits, *motion)
    known = {key: value for key, value in measured.items() if key != "jerk_limited"}
    return certificate.model_copy(update=known), exceeded
