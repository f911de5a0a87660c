"""The tasks of the service as functions from bytes to bytes, which any worker can run."""

from __future__ import annotations

import contextlib
import functools
import itertools
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import pinocchio as pin

from ikplan.documents import parse_json, write_json
from ikplan.documents.plan_request import FkRequest, IkRequest, PlanRequest
from ikplan.documents.timing_request import TimingRequest
from ikplan.errors import Unreachable
from ikplan.ik.registry import find_solver, solvers
from ikplan.pipeline.forward_kinematics import fk_request
from ikplan.pipeline.identity import plan_id, with_tool
from ikplan.pipeline.plan import plan, solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.planning import Progress
from ikplan.robots import Robot, RobotUpload, catalogue_robot, robot_names
from ikplan_api.telemetry.plan_figures import PlanFigures, figures_of

__all__ = [
    "TASKS",
    "RequestIdentity",
    "TaskInput",
    "TaskResult",
    "identify",
    "robots_document",
    "run_task",
    "solvers_document",
    "warm_up",
]


class TaskResult(NamedTuple):
    """The result of a task.

    Attributes:
        document: The JSON document.
        plan_id: Its id, if it is a plan.
        figures: Its figures for metrics, if it is a plan.
    """

    document: bytes
    plan_id: str | None = None
    figures: PlanFigures | None = None


@dataclass(frozen=True)
class TaskInput:
    """The input of a task.

    Attributes:
        document: The request document as received.
        robot: The uploaded robot that the request names; None: a robot of the catalogue.
        progress: Receives the progress of the task, if given.
    """

    document: bytes
    robot: bytes | None = None
    progress: Progress | None = None

    def begin(self, stage: str) -> None:
        """Report the stage of a task that reports no progress itself."""
        if self.progress is not None:
            self.progress(stage, 0, 0)

    def robot_named(self, name: str) -> Robot:
        """Return the uploaded robot or the catalogue's robot of a name; never read a file path.

        Raises:
            RobotNotFound: The catalogue has no robot of that name.
            InvalidRobot: The description is invalid.
        """
        if self.robot is not None:
            robot = _uploaded(self.robot)
            if robot.name == name:
                return robot
        return _of_catalogue(name)


@functools.lru_cache(maxsize=64)
def _of_catalogue(name: str) -> Robot:
    """Load a robot once: later requests do not read its files again."""
    return catalogue_robot(name)


@functools.lru_cache(maxsize=64)
def _uploaded(document: bytes) -> Robot:
    return RobotUpload.stored(document).robot()


class RequestIdentity(NamedTuple):
    """Id and budget of a request, known before planning.

    Attributes:
        plan_id: The id of its plan.
        budget_s: Its time budget [s].
    """

    plan_id: str
    budget_s: float


_REQUESTS: dict[str, type[PlanRequest] | type[TimingRequest]] = {
    "plan": PlanRequest,
    "time": TimingRequest,
}


def identify(kind: str, task: TaskInput) -> RequestIdentity:
    """Return the id and the budget of a request without planning it.

    Args:
        kind: ``"plan"`` or ``"time"``.
        task: The request.

    Raises:
        InvalidRequest: A field is wrong.
        RobotNotFound: No robot has that name.
        InvalidRobot: The description of the uploaded robot is invalid.
    """
    request = parse_json(_REQUESTS[kind], task.document)
    robot = with_tool(task.robot_named(request.robot), request.tool)
    return RequestIdentity(plan_id(request, robot), request.budget_s)


def make_plan(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/plans``."""
    request = parse_json(PlanRequest, task.document)
    made = plan(request, robot=task.robot_named(request.robot), progress=task.progress)
    return TaskResult(write_json(made), made.id, figures_of(made))


def make_timing(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/timings``."""
    request = parse_json(TimingRequest, task.document)
    made = time_request(request, robot=task.robot_named(request.robot), progress=task.progress)
    return TaskResult(write_json(made), made.id, figures_of(made))


def answer_ik(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/ik``."""
    request = parse_json(IkRequest, task.document)
    robot = task.robot_named(request.robot)
    solved = solve_ik_request(request, robot=robot, progress=task.progress)
    return TaskResult(write_json(solved))


def answer_fk(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/fk``."""
    task.begin("fk")
    request = parse_json(FkRequest, task.document)
    placed = fk_request(request, robot=task.robot_named(request.robot))
    return TaskResult(write_json(placed))


def _identify(kind: str, task: TaskInput) -> TaskResult:
    """Identify a request in a worker, if that would block the event loop for too long."""
    task.begin("reading")
    return TaskResult(json.dumps(identify(kind, task)).encode())


TASKS: dict[str, Callable[[TaskInput], TaskResult]] = {
    "plan": make_plan,
    "time": make_timing,
    "ik": answer_ik,
    "fk": answer_fk,
    "identify-plan": functools.partial(_identify, "plan"),
    "identify-time": functools.partial(_identify, "time"),
}


def run_task(kind: str, task: TaskInput) -> TaskResult:
    """Run one task.

    Args:
        kind: Name of the task, a key of :data:`TASKS`.
        task: Its input.

    Raises:
        IkplanError: The verdict on the request.
    """
    return TASKS[kind](task)


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
    """Load or compile the kernels by running small requests of each kind.

    Args:
        methods: Names of the solvers to warm up.
    """
    for kind, request in _warming_requests(methods):
        # One request is unreachable: the explanation has kernels of its own.
        with contextlib.suppress(Unreachable):
            run_task(kind, TaskInput(json.dumps(request).encode()))
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
