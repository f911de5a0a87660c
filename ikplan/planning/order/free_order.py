"""Orders in which a path may be planned whose order is free."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ikplan.arrays import Array
from ikplan.documents.scene import AttachedBody
from ikplan.documents.segment import JointSegment, MoveSegment
from ikplan.kinematics.target import Target
from ikplan.path import JointLeg, Leg, MoveLeg, Pose, ToolLeg, legs_of
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.order.choose import Cluster, choose_order
from ikplan.planning.order.costs import Costs, Ways
from ikplan.planning.order.measure import JointMotion, LeastTime
from ikplan.planning.order.stages import stages_of
from ikplan.planning.order.tasks import tasks_of
from ikplan.planning.plan_joint_path import plan_joint_path
from ikplan.planning.segment_number import segment_to
from ikplan.planning.tool_pose import tool_pose

__all__ = ["orders_of"]


def orders_of(
    problem: JointPathProblem, attached: Sequence[AttachedBody]
) -> Iterator[JointPathProblem]:
    """Yield a path in orders that take little time, then in ones that move the joints little.

    Args:
        problem: The path, in the given order.
        attached: What the tool carries: it keeps tasks together.

    Raises:
        InvalidRequest: The path makes no sense, or OR-tools is not installed.
        Unreachable: A waypoint, or a place on a tool path, has no solution.
        Disconnected: No continuous motion follows a tool path.
        InCollision: All that was found for a part is in contact.
        TrackingFailed: The same, where ``problem.explain`` is false.
        BudgetExceeded: The time budget ran out.
    """
    tasks = tasks_of(problem.path, attached)
    fk, found = partial(tool_pose, problem), problem.found
    legs = legs_of(problem.path, _start(problem), fk, problem.rounding, found=found)
    q_start: Array | None = None if problem.start_free else problem.q_start
    after = _after_begin(legs)
    if after and after[0] is not legs[0]:
        q_start = _end_of_begin(problem)
    stages = stages_of(problem, after, problem.q_start if q_start is None else q_start)
    clusters, clustered = [], []
    for task in tasks:
        own = tuple(k for k, stage in enumerate(stages) if stage.part in task.parts)
        if own:
            clusters.append(Cluster(own, task.place))
            clustered.append(task)
    begin = [k for task in tasks if task not in clustered for k in task.parts]
    if not clusters:
        return
    ways = Ways(problem, stages, q_start)
    for measure in (LeastTime(problem.limits), JointMotion()):
        choice = choose_order(clusters, stages, Costs(ways, measure))
        order = [*begin, *(k for c in choice.clusters for k in clustered[c].parts)]
        ends: dict[str, tuple[Array, Target]] = {}
        for k, branch in zip(choice.stages, choice.branches, strict=True):
            stage = stages[k]
            if stage.moves or stage.followed:
                ends[stage.name] = stage.entries[branch].copy(), stage.targets[branch]
        yield replace(problem, order=tuple(order), ends=ends)


def _start(problem: JointPathProblem) -> Pose | None:
    if problem.start_free:
        return None
    R, p = tool_pose(problem, problem.q_start)
    return Pose(R, p)


def _after_begin(legs: Sequence[Leg]) -> list[Leg]:
    """The legs from the first motion that a part of the path asks for."""
    found: list[Leg] = []
    for leg in legs:
        if not found and isinstance(leg, ToolLeg):
            continue
        if not found and isinstance(leg, MoveLeg) and segment_to(leg.targets[0]) is None:
            continue
        if not found and isinstance(leg, JointLeg) and segment_to(leg.waypoints[0]) is None:
            if len(leg.waypoints) == 1:
                continue
            leg = JointLeg(leg.waypoints[1:])
        found.append(leg)
    return found


def _end_of_begin(problem: JointPathProblem) -> Array:
    """Where what comes before the first of them ends, shape (dof,) [rad or m]."""
    segments = problem.path.segments or []
    count = next(
        (k for k, s in enumerate(segments) if isinstance(s, MoveSegment | JointSegment)),
        len(segments),
    )
    path = problem.path.model_copy(update={"segments": segments[:count]})
    return np.array(plan_joint_path(replace(problem, path=path)).q[-1])
