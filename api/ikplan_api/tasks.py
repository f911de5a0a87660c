"""The work of the service, as functions from bytes to bytes, so that any worker can do it."""

from __future__ import annotations

import contextlib
import functools
import itertools
import json
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import pinocchio as pin

from ikplan.documents import parse_json
from ikplan.errors import Unreachable
from ikplan.ik.registry import find_solver, solvers
from ikplan.pipeline import fk_request, plan, solve_ik_request
from ikplan.request import FkRequest, IkRequest, PlanRequest
from ikplan.retiming import time_request
from ikplan.robots import Robot, RobotUpload, catalogue_robot, robot_names
from ikplan.timing_request import TimingRequest

__all__ = ["TASKS", "Answer", "robots_document", "run_task", "solvers_document", "warm_up"]


class Answer(NamedTuple):
    """What a task answers.

    Attributes:
        document: The JSON document.
        plan_id: Its id, if it is a plan.
    """

    document: bytes
    plan_id: str | None = None


def make_plan(body: bytes, upload: bytes | None = None) -> Answer:
    """Answer ``POST /v1/plans``."""
    request = parse_json(PlanRequest, body)
    made = plan(request, robot=_robot(request.robot, upload))
    return Answer(made.model_dump_json().encode(), made.id)


def make_timing(body: bytes, upload: bytes | None = None) -> Answer:
    """Answer ``POST /v1/timings``."""
    request = parse_json(TimingRequest, body)
    made = time_request(request, robot=_robot(request.robot, upload))
    return Answer(made.model_dump_json().encode(), made.id)


def answer_ik(body: bytes, upload: bytes | None = None) -> Answer:
    """Answer ``POST /v1/ik``."""
    request = parse_json(IkRequest, body)
    made = solve_ik_request(request, robot=_robot(request.robot, upload))
    return Answer(made.model_dump_json().encode())


def answer_fk(body: bytes, upload: bytes | None = None) -> Answer:
    """Answer ``POST /v1/fk``."""
    request = parse_json(FkRequest, body)
    made = fk_request(request, robot=_robot(request.robot, upload))
    return Answer(made.model_dump_json().encode())


def _robot(name: str, upload: bytes | None) -> Robot:
    """The robot of a request: of the catalogue or uploaded, so that a name is never a path."""
    if upload is not None:
        robot = _uploaded(upload)
        if robot.name == name:
            return robot
    return catalogue_robot(name)


@functools.lru_cache(maxsize=64)
def _uploaded(document: bytes) -> Robot:
    return parse_json(RobotUpload, document).robot()


TASKS: dict[str, Callable[[bytes, bytes | None], Answer]] = {
    "plan": make_plan,
    "time": make_timing,
    "ik": answer_ik,
    "fk": answer_fk,
}


def run_task(kind: str, body: bytes, upload: bytes | None = None) -> Answer:
    """Do one task.

    Args:
        kind: Name of the task, a key of :data:`TASKS`.
        body: The request document as it came in.
        upload: The robot that it names, as uploaded; None: it names one of the catalogue.

    Raises:
        IkplanError: The verdict on the request.
    """
    return TASKS[kind](body, upload)


@functools.cache
def robots_document() -> bytes:
    """Return the document of ``GET /v1/robots``."""
    robots = [catalogue_robot(name).info().model_dump(mode="json") for name in robot_names()]
    return json.dumps({"robots": robots}, allow_nan=False).encode()


@functools.cache
def solvers_document() -> bytes:
    """Return the document of ``GET /v1/solvers``."""
    known = [solver.model_dump(mode="json") for solver in solvers()]
    return json.dumps({"solvers": known}, allow_nan=False).encode()


def warm_up(methods: Sequence[str] = ("ik-ba", "lm")) -> None:
    """Load or compile the kernels by answering small requests of each kind.

    Args:
        methods: Names of the solvers to get ready.
    """
    for kind, request in _warming_requests(methods):
        # One of them asks for a point out of reach: the verdict has kernels of its own.
        with contextlib.suppress(Unreachable):
            run_task(kind, json.dumps(request).encode())
    robots_document()
    solvers_document()


def _warming_requests(methods: Sequence[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    robot = catalogue_robot("iiwa14")
    q = [float(v) for v in robot.home]
    pose = robot.fk([v + 0.05 for v in q])
    point = {"position": [float(v) for v in pose.translation]}
    full = {**point, "quaternion_xyzw": [float(v) for v in pin.Quaternion(pose.rotation).coeffs()]}
    far = {**full, "position": [9.0, 0.0, 0.0]}
    starts: tuple[Any, ...] = (None, q)
    yield "fk", {"robot": robot.name, "q": q}
    moved = {"robot": robot.name, "waypoints": [q, [v + 0.05 for v in q]], "budget_s": 3600}
    for limits in ({}, {"jerk": 100.0}):
        yield "time", {**moved, "limits": limits}
    for method in methods:
        options = {"method": method}
        for target, start in itertools.product((point, full), starts):
            yield "ik", {"robot": robot.name, **target, "start": start, "ik": options}
        if any(p.name == "decouple" for p in find_solver(method).parameters):
            decoupled = {"method": method, "params": {"decouple": True}}
            yield "ik", {"robot": robot.name, **full, "ik": decoupled}
    for target, start in itertools.product((point, full, far), (*starts, "free")):
        path = {"waypoints": [target]}
        yield "plan", {"robot": robot.name, "path": path, "start": start, "budget_s": 3600}
