"""Joint steps on which the spline through the waypoints keeps clear of contact.

The planner proves the straight joint motion from waypoint to waypoint. The spline through them
leaves it, the farther the longer the steps are, and may touch what the straight motion passes.
There points of the straight motion are added.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.collision.check import ContactCheck
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.planning.joint_route import JointRoute, RouteJointStep

__all__ = ["clear_joint_path"]

_ROUNDS = 8
"""How often points are added: at a corner the spline is off by half as much after each round."""


def clear_joint_path(
    route: JointRoute, limits: JointLimits, contact: ContactCheck | None
) -> tuple[JointRoute, JointPath]:
    """Lay the joint path of a route, with points added where its joint steps touch.

    Args:
        route: The route.
        limits: Position limits.
        contact: Proves; None: nothing is in the way.

    Returns:
        The route with the points added, and the spline through it. Steps whose straight motion is
        in contact are left as they are.
    """
    path = JointPath.through(route.q, limits, rest_at=route.rest)
    if contact is None or not route.joint_steps:
        return route, path
    for _ in range(_ROUNDS):
        before = _before_touching(route, path, contact)
        if not before:
            break
        route = _with_middles(route, before)
        path = JointPath.through(route.q, limits, rest_at=route.rest)
    return route, path


def _before_touching(route: JointRoute, path: JointPath, contact: ContactCheck) -> list[int]:
    """Configurations after which the spline touches and the straight motion does not."""
    found: list[int] = []
    for run in _runs(route, contact):
        knots = path.knot_of_waypoint[run.first : run.last + 1]
        a, b = int(knots[0]), int(knots[-1])
        if a == b:
            continue
        touches = contact.contacts_on_curve(
            path.s_knots[a : b + 1],
            path.q_knots[a : b + 1],
            (path.tangents_start[a:b], path.tangents_end[a:b]),
            run.segment,
            0.0,
        )
        for piece in np.flatnonzero(touches):
            before = run.first + int(np.flatnonzero(knots == a + piece)[-1])
            if contact.first_contact(route.q[before : before + 2], run.segment) is None:
                found.append(before)
    return found


def _runs(route: JointRoute, contact: ContactCheck) -> list[RouteJointStep]:
    """Joint steps, joined where one follows another and the same bodies are there."""
    runs: list[RouteJointStep] = []
    for step in route.joint_steps:
        last = runs[-1] if runs else None
        same = last is not None and (not contact.changes_by_segment or last.segment == step.segment)
        if last is not None and same and last.last == step.first:
            runs[-1] = replace(last, last=step.last)
        else:
            runs.append(step)
    return runs


def _with_middles(route: JointRoute, before: Sequence[int]) -> JointRoute:
    """The route with a configuration half-way after each of some."""
    rows = np.array(before, dtype=np.int64)
    middles = 0.5 * (route.q[rows] + route.q[rows + 1])
    q = np.insert(route.q, rows + 1, middles, axis=0)
    of = _shifted(len(route.q), rows)
    return replace(
        route,
        q=np.ascontiguousarray(q),
        rest=[int(of[k]) for k in route.rest],
        waypoints=[replace(x, index=int(of[x.index])) for x in route.waypoints],
        segments=[replace(x, first=int(of[x.first]), last=int(of[x.last])) for x in route.segments],
        moves=[replace(x, first=int(of[x.first]), last=int(of[x.last])) for x in route.moves],
        joint_steps=[
            replace(x, first=int(of[x.first]), last=int(of[x.last])) for x in route.joint_steps
        ],
    )


def _shifted(count: int, before: Indices) -> Indices:
    """Where each configuration is after one more was put behind some of them, shape (count,)."""
    added: Array = np.zeros(count)
    added[before + 1] = 1.0
    return np.asarray(np.arange(count) + np.cumsum(added).astype(np.int64))
