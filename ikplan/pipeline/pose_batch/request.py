"""A request of many poses, and requests of one pose that are answered together."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ikplan.documents import parse
from ikplan.documents.pose_results import IkBatchSolution, IkSolution
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan.documents.scene import ToolFrame
from ikplan.errors import IkplanError
from ikplan.ik.closest_approach import ClosestApproach
from ikplan.ik.poses.arrays import PoseArrays, pose_arrays
from ikplan.ik.poses.batch import thread_count
from ikplan.ik.solve import BARE_NO, refusal
from ikplan.pipeline.collisions import requested_model, with_meshes
from ikplan.pipeline.helpers import helped_by
from ikplan.pipeline.pose_batch.solve import BatchOptions, find_solutions, solve_poses
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.request_budget import RequestBudget
from ikplan.pipeline.resolve import resolve_robot
from ikplan.robots import Robot
from ikplan.time_budget import Progress, TimeBudget

__all__ = ["solve_ik_batch_request", "solve_ik_requests"]

_LONG_S = 1e6
"""Budget of poses that are answered together [s]: each takes a fraction of a millisecond."""


def solve_ik_batch_request(
    request: Mapping[str, Any] | IkBatchRequest,
    *,
    robot: Robot | None = None,
    progress: Progress | None = None,
) -> IkBatchSolution:
    """Solve the poses of a request, see :func:`ikplan.solve_ik_batch`; robot as in plan.

    Raises:
        InvalidRequest: A field of the request is wrong.
        RobotNotFound: No robot of that name.
        BudgetExceeded: ``budget_s`` ran out.
    """
    request = with_meshes(parse(IkBatchRequest, request))
    helped_by("ik", request.ik.method)
    clock = RequestBudget(request.budget_s, progress)
    robot = resolve_robot(request, robot)
    model = requested_model(robot, request.scene, request.fixed_joints, request.tool, always=False)
    options = BatchOptions(
        request.ik,
        request.tolerance.position,
        request.tolerance.orientation,
        request.verdict,
        thread_count(),
    )
    poses = _arrays([(pose.position, pose.quaternion_xyzw) for pose in request.poses])
    return solve_poses(robot, poses, request.start, model, options, clock)


def _arrays(poses: Sequence[tuple[list[float], list[float] | None]]) -> PoseArrays:
    """Poses that have an orientation, all or none."""
    return pose_arrays(np.array([position + (turn or []) for position, turn in poses]))


def solve_ik_requests(
    documents: Sequence[Any], *, robot: Robot | None = None
) -> list[IkSolution | IkplanError]:
    """Answer requests of one pose each; those of the method lm that are alike by one kernel call.

    The answer to one does not depend on those that it is answered with.

    Args:
        documents: The requests.
        robot: The robot of all of them; None: the one that each names.

    Returns:
        For each, what :func:`ikplan.solve_ik` returns for it, or the error that it raises.
    """
    answers: dict[int, IkSolution | IkplanError] = {}
    alike: dict[tuple[object, ...], dict[int, IkRequest]] = {}
    for index, document in enumerate(documents):
        try:
            request = parse(IkRequest, document)
        except IkplanError as error:
            answers[index] = error
            continue
        plain = request.scene is None and request.ik.posture is None
        if plain and request.ik.method == "lm":
            alike.setdefault(_key(request), {})[index] = request
        else:
            answers[index] = _alone(request, robot)
    for group in alike.values():
        answers.update(zip(group, _together([*group.values()], robot), strict=True))
    return [answers[index] for index in range(len(documents))]


def _key(request: IkRequest) -> tuple[object, ...]:
    """What requests that are answered together have in common."""
    plain = request.ik.model_fields_set == {"method"}
    return (
        request.robot,
        None if request.tool == ToolFrame() else request.tool.model_dump_json(),
        request.quaternion_xyzw is None,
        request.start is None,
        "lm" if plain else request.ik.model_dump_json(),
        request.tolerance.position,
        request.tolerance.orientation,
    )


def _alone(request: IkRequest, robot: Robot | None) -> IkSolution | IkplanError:
    try:
        return solve_ik_request(request, robot=robot)
    except IkplanError as error:
        return error


def _together(requests: Sequence[IkRequest], robot: Robot | None) -> list[IkSolution | IkplanError]:
    """Answer requests that differ in pose, start and verdict only."""
    first = requests[0]
    try:
        resolved = resolve_robot(first, robot)
        poses = _arrays([(r.position, r.quaternion_xyzw) for r in requests])
        start: Any = first.start
        if start is not None and len(requests) > 1:
            start = [r.start for r in requests]
        options = BatchOptions(
            first.ik, first.tolerance.position, first.tolerance.orientation, verdict=False
        )
        found = find_solutions(resolved, poses, start, None, options, TimeBudget(_LONG_S))
    except IkplanError as error:
        if len(requests) == 1:
            return [error]
        return [answer for request in requests for answer in _together([request], robot)]
    answers: list[IkSolution | IkplanError] = []
    for k, request in enumerate(requests):
        if not found.solved[k] and request.verdict:
            answers.append(_alone(request, robot))
            continue
        q, (distance, angle, evaluations) = found.q[k], found.errors[k].tolist()
        turned = angle if poses.oriented else None
        if found.solved[k]:
            q_start = resolved.home if request.start is None else request.start
            fields: dict[str, Any] = {"q": q, "position_error": distance}
            fields["orientation_error"] = turned
            fields["elongation"] = math.dist(q, q_start)
            fields["evaluations"] = int(evaluations)
            answers.append(IkSolution.quick(fields))
        else:
            closest = ClosestApproach(q, distance, turned, [], BARE_NO)
            answers.append(refusal(resolved, closest, poses.target(k)))
    return answers
