"""The certificate: an independent check of a finished trajectory.

Everything is computed from the timed samples, the request and the robot's Pinocchio model. What
the request asks for is read by :mod:`ikplan.certificate.requested`; nothing of the planner's path,
inverse kinematics, planning or timing is used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.arrays import Array, lengths_of, steps_of
from ikplan.certificate.claim import Claim
from ikplan.certificate.continuity import check_finite, discontinuities
from ikplan.certificate.coverage import left_out
from ikplan.certificate.deviation import MatchedLeg, Tool, match_legs, timed_legs
from ikplan.certificate.elongation import elongation_lower_bound
from ikplan.certificate.limits import measured_limits, measured_positions
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.polyline import polyline_deviation
from ikplan.certificate.requested import RequestedMotion, broken_order, read_motion
from ikplan.certificate.segments import segment_checks, timed_segments
from ikplan.certificate.singular_value import least_singular_value
from ikplan.certificate.stops import false_stops, stops
from ikplan.certificate.waypoints import met_waypoints, missed_waypoints, waypoint_misses
from ikplan.documents.certificate import Certificate
from ikplan.errors import CertificateViolated

__all__ = ["certify"]


def certify(claim: Claim) -> Certificate:
    """Check a trajectory and return its certificate.

    Raises:
        CertificateViolated: A promise is broken; carries the certificate and which.
    """
    check_finite(claim)
    violations = discontinuities(claim)
    elongation = float(_elongations(claim).sum())
    fields: dict[str, Any] = {
        "max_position_error": None,
        "max_orientation_error": None,
        "max_path_deviation": None,
        "max_orientation_deviation": None,
        "elongation_sum": elongation,
        "elongation_lower_bound": elongation,
    }
    motion: RequestedMotion | None = None
    matched: list[MatchedLeg] = []
    if claim.path is not None:
        wrong = [] if claim.order is None else broken_order(claim.path, claim.order)
        violations += wrong
        order = None if wrong else claim.order
        motion = read_motion(claim.robot, claim.path, claim.q_start, order)
        matched = _check_path(claim, motion, fields, violations)
    elif claim.joint_waypoints is not None:
        found, exceeded = polyline_deviation(claim, claim.joint_waypoints)
        fields |= found
        violations += exceeded
    for found, exceeded in (
        measured_positions(claim.robot, claim.time, claim.q),
        measured_limits(claim.robot, claim.limits, claim.time, claim.q, claim.dq, claim.ddq),
    ):
        fields |= found
        violations += exceeded
    fields["segments"], exceeded = segment_checks(claim, timed_segments(claim, motion, matched))
    violations += exceeded
    value, time = least_singular_value(claim, motion, matched)
    fields |= {"min_singular_value": value, "min_singular_value_time": time}
    fields["stops"] = stops(claim)
    violations += false_stops(claim)
    fields["assumptions"] = list(claim.robot.description.assumptions)
    certificate = Certificate(valid=not violations, **fields)
    if violations:
        raise CertificateViolated(
            f"the finished trajectory broke a promise: {'; '.join(violations)}",
            certificate=certificate.model_dump(),
            violations=violations,
        )
    return certificate


def _check_path(
    claim: Claim, motion: RequestedMotion, fields: dict[str, Any], violations: list[str]
) -> list[MatchedLeg]:
    """Hold a trajectory to its path; adds to the fields of the certificate and the violations."""
    assert claim.path is not None
    if len(motion.waypoints) != len(claim.waypoint_q):
        violations.append(
            f"the request has {len(motion.waypoints)} waypoints, the plan {len(claim.waypoint_q)}"
        )
        return []
    allowance, tool = Allowance(claim.path), Tool.of(claim, samples=bool(motion.legs))
    met = met_waypoints(claim, motion.waypoints, allowance, tool)
    misses = waypoint_misses(claim, met, allowance, tool)
    violations += missed_waypoints(met, allowance, misses)
    fields["max_position_error"] = float(misses.distance.max())
    if misses.oriented.any():
        fields["max_orientation_error"] = float(misses.angle[misses.oriented].max())
    fields["elongation_lower_bound"] = elongation_lower_bound(
        claim.robot, claim.q_start, motion.waypoints, allowance, misses
    )
    matched = match_legs(claim, timed_legs(claim, motion), tool)
    violations += _deviations(claim, allowance, matched, fields)
    for part in matched:
        distance, time = left_out(claim, part, tool, allowance)
        if distance > allowance.position:
            violations.append(f"a part of the path at {time:.4f} s is left out by {distance:.3g} m")
    return matched


def _deviations(
    claim: Claim, allowance: Allowance, matched: list[MatchedLeg], fields: dict[str, Any]
) -> list[str]:
    """Whether the tool leaves its paths by more than the tolerance, in words."""
    if not matched:
        return []
    left = []
    sample = np.concatenate([part.sample for part in matched])
    distance = np.concatenate([part.distance for part in matched])
    at = int(np.argmax(distance))
    fields["max_path_deviation"] = float(distance[at])
    fields["max_path_deviation_time"] = float(claim.time[sample[at]])
    if distance[at] > allowance.position:
        left.append(f"the path is left by {distance[at]:.3g} m")
    oriented = np.concatenate([part.oriented for part in matched])
    if oriented.any():
        angle = np.where(oriented, np.concatenate([part.angle for part in matched]), -1.0)
        at = int(np.argmax(angle))
        fields["max_orientation_deviation"] = float(angle[at])
        fields["max_orientation_deviation_time"] = float(claim.time[sample[at]])
        if angle[at] > allowance.orientation:
            left.append(f"the path is left by {angle[at]:.3g} rad")
    return left


def _elongations(claim: Claim) -> Array:
    """Joint distance of each waypoint from the one before, or the start, shape (n,)."""
    begin = claim.waypoint_q[:1] if claim.q_start is None else claim.q_start[None]
    return lengths_of(steps_of(np.vstack([begin, claim.waypoint_q])))
