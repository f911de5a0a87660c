"""How far the tool is off its path between samples, by the certificate's own evaluation."""

from __future__ import annotations

from typing import Any

import numpy as np

from ikplan.certificate.claim import Claim
from ikplan.certificate.deviation import Tool, match_legs, timed_legs
from ikplan.certificate.offsets import Allowance
from ikplan.certificate.requested import read_motion
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.corner_stops.exact_corners import (
    stopping_at,
    stops_allowed,
    without_blends,
)
from ikplan.pipeline.resolve import resolve_robot
from ikplan.plans.plan import Plan

__all__ = ["as_polynomial", "share_between"]

MOST = 40_000
"""Most times that are looked at."""


def as_polynomial(request: dict[str, Any]) -> dict[str, Any]:
    """Return a request whose plan can be evaluated at any time."""
    return {**request, "sampling": {**request.get("sampling", {}), "form": "polynomial"}}


def share_between(request: dict[str, Any], plan: Plan, finer: int) -> float:
    """Return the largest share of the path's tolerances used at times between the samples.

    A motion that stops at a corner in the place of a blend is held to the exact corner.

    Args:
        request: The request, asked as :func:`as_polynomial`.
        plan: Its plan.
        finer: How many times denser than the samples to look.

    Returns:
        The share; 0 where there is no tool path.
    """
    document = PlanRequest.model_validate(request)
    paths = [document.path]
    if plan.certificate.stops:
        stopped = np.flatnonzero(np.isin(plan.waypoints.time, plan.certificate.stops))
        stops = stops_allowed(document.path) & set(stopped.tolist())
        exact = without_blends(document.path)
        paths += [] if exact is None else [exact]
        paths.append(stopping_at(document.path, stops, start_free=document.start == "free"))
    return min(_share(document, path, plan, finer) for path in paths)


def _share(document: PlanRequest, path: PathRequest, plan: Plan, finer: int) -> float:
    """Share of the tolerances that a plan uses of one reading of its path."""
    robot = resolve_robot(document)
    q_start = None if document.start == "free" else plan.q[0]
    motion = read_motion(robot, path, q_start)
    if not motion.legs or plan.duration == 0.0:
        return 0.0
    time = np.linspace(0.0, plan.duration, min(finer * len(plan.time), MOST))
    waypoints = plan.waypoints
    claim = Claim(
        robot,
        path,
        q_start,
        np.asarray(waypoints.q),
        np.asarray(waypoints.time),
        time,
        *plan.at(time),
        MotionLimits.of(robot, document.limits),
    )
    allowance = Allowance(path)
    legs = match_legs(claim, timed_legs(claim, motion), Tool.of(claim, samples=True))
    shares = [
        np.maximum(leg.distance / allowance.position, leg.angle / allowance.orientation).max()
        for leg in legs
    ]
    return float(max(shares, default=0.0))
