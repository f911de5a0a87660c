"""Two arms that run together: a path for each, one timing for both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate import Claim, certify
from ikplan.certificate.limits import measured_limits
from ikplan.documents import parse
from ikplan.documents.certificate import Certificate
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.trajectory import Trajectory
from ikplan.errors import CertificateViolated, InvalidRequest
from ikplan.ik.arguments import check_start
from ikplan.limits.motion_limits import MotionLimits
from ikplan.pipeline.corner_stops.exact_corners import without_blends
from ikplan.pipeline.plan import make_plan
from ikplan.pipeline.resolve import resolve_robot
from ikplan.pipeline.retime import time_request
from ikplan.plans.plan import Plan
from ikplan.robots import Robot
from ikplan.robots.narrowing import narrowed

__all__ = ["PlansTogether", "plan_together"]

_POINTS = 48
"""Points between two waypoints, at which the common joint path passes those of the arms."""
_UNLIMITED = 1e9
_ROUNDS = 4
_ABOVE = 1.0 + 1e-6
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class PlansTogether:
    """Arms that run together.

    Attributes:
        cell: The motion of all joints, certified under the limits of both and for contact.
        arms: The plan of each arm, by name, certified for its own path at the common times.
    """

    cell: Plan
    arms: dict[str, Plan]


@dataclass(frozen=True, eq=False)
class _Arm:
    """An arm, its request, and the plan that it has alone."""

    robot: Robot
    request: PlanRequest
    limits: MotionLimits
    plan: Plan
    columns: list[int]

    def times(self) -> Array:
        """When it begins, and when it passes its waypoints [s]."""
        return np.concatenate([[0.0], self.plan.waypoints.time])


def plan_together(
    cell: Robot,
    arms: Mapping[str, tuple[Robot, Mapping[str, Any]]],
    *,
    scene: Mapping[str, Any] | None = None,
    sampling: Mapping[str, Any] | None = None,
) -> PlansTogether:
    """Plan tool paths of two arms that pass their waypoints together.

    Each arm is planned alone, checked for contact only where its request has a scene. From
    waypoint to waypoint both then share one course: at each share of the way in time alone,
    both are where they would be alone. That course of all joints is timed under the limits of
    both, proven to keep the arms apart from each other, from themselves and from the scene, and
    each arm's part of it is certified for that arm's path.

    Args:
        cell: The robot whose chain has the joints of both arms: from the tool of one to that of the
            other, ``load_robot(urdf, base="left_tool", tip="right_tool")``.
        arms: A robot and a request for a plan for each arm, by name; both requests have the same
            number of waypoints.
        scene: What stands in the cell, as in a request; obstacles need a ``link``, since the base
            of the cell moves.
        sampling: Samples of the trajectories, as in a request.

    Returns:
        The motion of the cell and the plans of the arms, with the same samples.

    Raises:
        InvalidRequest: The joints of an arm are not on the chain of the cell, the numbers of
            waypoints differ, or a request asks for what has no meaning here.
        NoPlan: An arm has no plan, or both have no timing or touch.
        CertificateViolated: The finished motion broke a promise: a bug.
    """
    planned = {name: _alone(cell, name, robot, request) for name, (robot, request) in arms.items()}
    counts = {name: len(arm.plan.waypoints.time) for name, arm in planned.items()}
    if len(arms) < 2 or len(set(counts.values())) != 1:
        raise InvalidRequest(
            f"arms: two or more with the same number of waypoints, not {counts}", field="arms"
        )
    columns = [column for arm in planned.values() for column in arm.columns]
    if sorted(columns) != list(range(cell.dof)):
        raise InvalidRequest(
            f"arms: together they have the joints of {cell.name}, each once: "
            f"{', '.join(cell.joint_names)}",
            field="arms",
        )
    rows, rests, passed = _course(cell, list(planned.values()))
    document = {
        "robot": cell.name or "cell",
        "waypoints": rows,
        "rest_at": rests,
        "limits": _limits(cell, list(planned.values())),
        "scene": dict(scene or {}),
        "sampling": dict(sampling or {}),
        "budget_s": max(arm.request.budget_s for arm in planned.values()),
    }
    for _ in range(_ROUNDS):
        both = time_request(document, robot=cell)
        slower = max(_excess(arm, both) for arm in planned.values())
        if slower <= 1.0:
            break
        # Limits of the tools, which the timing of the joints does not know.
        duration = both.duration * slower * _ABOVE
        document["limits"] = {**document["limits"], "duration": duration}  # type: ignore[dict-item]
    times = both.waypoints.time[passed]
    return PlansTogether(both, {k: _part(arm, both, times) for k, arm in planned.items()})


def _alone(cell: Robot, name: str, robot: Robot, asked: Mapping[str, Any]) -> _Arm:
    # Alone, the other arm would stand somewhere in the way; the course of both is proven.
    unchecked = {"scene": {"self_collision": False}}
    request = parse(PlanRequest, {**unchecked, **asked, "sampling": {"form": "polynomial"}})
    own = [segment for segment in request.path.segments or [] if segment.limits is not None]
    dwells = [segment for segment in request.path.segments or [] if segment.dwell]
    unfit = {
        "limits of segments": bool(own),
        "dwell": bool(dwells),
        "start_velocity": request.start_velocity is not None,
        "end_velocity": request.end_velocity is not None,
        "limits.duration": request.limits.duration is not None,
        "events": bool(request.events),
        "path.order": request.path.order != "given",
    }
    for what, given in unfit.items():
        if given:
            raise InvalidRequest(
                f"arms.{name}: {what}: not for arms that run together", field="arms"
            )
    missing = [joint for joint in robot.joint_names if joint not in cell.joint_names]
    if missing:
        raise InvalidRequest(
            f"arms.{name}: {missing[0]!r} is no joint of the cell; there are "
            f"{', '.join(cell.joint_names)}",
            field="arms",
        )
    made = resolve_robot(request, robot)
    kept = narrowed(made, request.limits.joints)
    columns = [cell.joint_names.index(joint) for joint in robot.joint_names]
    limits = MotionLimits.of(kept, request.limits)
    return _Arm(kept, request, limits, make_plan(request, robot), columns)


def _course(cell: Robot, arms: Sequence[_Arm]) -> tuple[Array, list[int], list[int]]:
    """The common course: its points, those at which it rests, and those of the waypoints."""
    times = [arm.times() for arm in arms]
    count = len(times[0])
    rows: list[Array] = []
    rests, passed = [], []

    def put(shares: Sequence[float], k: int, rest: bool) -> None:
        row = np.empty(cell.dof)
        for arm, t, share in zip(arms, times, shares, strict=True):
            q = arm.plan.waypoints.q[k - 1] if share == 1.0 and k > 0 else None
            at = t[k] if k == 0 else t[k - 1] + share * (t[k] - t[k - 1])
            row[arm.columns] = arm.plan.at(at)[0] if q is None else q
        if rest:
            rests.append(len(rows))
        rows.append(row)

    put([0.0] * len(arms), 0, False)
    for k in range(1, count):
        if all(t[k] <= t[k - 1] for t in times):
            passed.append(len(rows) - 1)
            continue
        shares = set(np.linspace(0.0, 1.0, _POINTS + 1)[1:].tolist())
        stops = set()
        for arm, t in zip(arms, times, strict=True):
            for stop in arm.plan.certificate.stops:
                length = t[k] - t[k - 1]
                share = (stop - t[k - 1]) / length if length > 0.0 else 0.0
                if _SAME < share < 1.0 - _SAME:
                    stops.add(share)
                elif abs(share - 1.0) <= _SAME:
                    stops.add(1.0)
        for share in sorted(shares | stops):
            put([share] * len(arms), k, share in stops)
        passed.append(len(rows) - 1)
    return np.array(rows), rests, passed


def _limits(cell: Robot, arms: Sequence[_Arm]) -> dict[str, Any]:
    """The limits of all joints, those of the cell's own apart."""
    names = ("velocity", "acceleration", "jerk")
    values = {name: np.full(cell.dof, _UNLIMITED) for name in names}
    for arm in arms:
        limits = arm.limits
        lowest = {
            "velocity": np.minimum(limits.velocity, -limits.velocity_lower),
            "acceleration": np.minimum(limits.acceleration, -limits.acceleration_lower),
            "jerk": limits.jerk,
        }
        for name, value in lowest.items():
            if value is not None:
                values[name][arm.columns] = value
    jerk = any(arm.limits.jerk is not None for arm in arms)
    found: dict[str, Any] = {name: values[name].tolist() for name in names[:2]}
    return {**found, "jerk": values["jerk"].tolist() if jerk else False}


def _of(arm: _Arm, both: Plan) -> tuple[Array, Array, Array]:
    return both.q[:, arm.columns], both.dq[:, arm.columns], both.ddq[:, arm.columns]


def _excess(arm: _Arm, both: Plan) -> float:
    """By what factor of time an arm's part keeps all its limits."""
    found, _ = measured_limits(arm.robot, arm.limits, both.time, *_of(arm, both))
    squares = ("acceleration_limit_ratio", "torque_limit_ratio", "tool_acceleration_ratio")
    ratios = [found.get(name) or 0.0 for name in ("velocity_limit_ratio", "tool_speed_ratio")]
    ratios += [float(np.sqrt(found.get(name) or 0.0)) for name in squares]
    ratios.append(float(np.cbrt(found.get("jerk_limit_ratio") or 0.0)))
    worst = max(ratios)
    return worst if worst > 1.0 + 1e-9 else 1.0


def _part(arm: _Arm, both: Plan, times: Array) -> Plan:
    """The plan of an arm at the common times."""
    q, dq, ddq = _of(arm, both)
    shown = Trajectory(time=both.time, q=q, dq=dq, ddq=ddq)
    waypoints = arm.plan.waypoints.model_copy(update={"time": times})
    changes = {
        "certificate": _certified(arm, both, times),
        "trajectory": shown,
        "waypoints": waypoints,
        "timing": None,
        "motion": None,
        "id": f"{both.id[:16]}{arm.plan.id[:16]}",
    }
    return arm.plan.model_copy(update=changes)


def _certified(arm: _Arm, both: Plan, times: Array) -> Certificate:
    request = arm.request
    start = None
    if request.start != "free":
        start = check_start(arm.robot, arm.robot.home if request.start is None else request.start)
    q, dq, ddq = _of(arm, both)
    exact = without_blends(request.path)
    paths = [request.path] if exact is None else [request.path, exact]
    for k, path in enumerate(paths):
        try:
            certificate = certify(
                Claim(
                    robot=arm.robot,
                    path=path,
                    q_start=start,
                    waypoint_q=arm.plan.waypoints.q,
                    waypoint_time=times,
                    time=both.time,
                    q=q,
                    dq=dq,
                    ddq=ddq,
                    limits=arm.limits,
                    stop_time=np.array(both.certificate.stops),
                )
            )
        except CertificateViolated:
            if k == len(paths) - 1:
                raise
        else:
            return certificate.model_copy(update={"clearance": both.certificate.clearance})
    raise AssertionError("the loop returns or raises")
