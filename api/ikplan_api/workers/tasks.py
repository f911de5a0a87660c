"""The tasks of the service as functions from bytes to bytes, which any worker can run."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

from ikplan.documents import parse_json, write_json
from ikplan.documents.base import Document
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
from ikplan.documents.timing_request import TimingRequest
from ikplan.ik.registry import solvers
from ikplan.pipeline import warm_up as kernels
from ikplan.pipeline.forward_kinematics import fk_request
from ikplan.pipeline.identity import UNKNOWN, KnownRequest, plan_id
from ikplan.pipeline.measures.series import plan_series
from ikplan.pipeline.plan import make_plan as planned
from ikplan.pipeline.pose_batch.request import solve_ik_batch_request
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.resolve import resolve_robot
from ikplan.pipeline.retime import make_timing as timed
from ikplan.planning import Progress
from ikplan.plans.export import FORMATS
from ikplan.plans.export.formats import Format
from ikplan.plans.plan import Plan
from ikplan.robots import Robot, RobotUpload, catalogue_robot, robot_names, robot_visual
from ikplan.scene.describe import info_with_bodies
from ikplan_api.telemetry.plan_figures import PlanFigures, figures_of
from ikplan_api.workers.headed import headed, split_head
from ikplan_api.workers.point_file import read_point_file
from ikplan_api.workers.scene_file import read_scene_file

__all__ = [
    "SHORT",
    "TASKS",
    "RequestIdentity",
    "TaskInput",
    "TaskResult",
    "identify",
    "parse_request",
    "robots_document",
    "run_task",
    "solvers_document",
    "warm_up",
]


SHORT = 8 * 1024
"""Longest document that the event loop parses itself, within a few milliseconds [bytes]."""

R = TypeVar("R", bound=Document)


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
        known: What is known of the request already.
        progress: Receives the progress of the task, if given.
    """

    document: bytes
    robot: bytes | None = None
    known: KnownRequest = UNKNOWN
    progress: Progress | None = None

    def request(self, model: type[R]) -> R:
        """Return the request; parse it unless that was done before.

        Raises:
            InvalidRequest: A field is wrong.
        """
        if isinstance(self.known.request, model):
            return self.known.request
        return parse_json(model, self.document)

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
        robot: Name of its robot.
    """

    plan_id: str
    budget_s: float
    robot: str = ""


_REQUESTS: dict[str, type[PlanRequest] | type[TimingRequest]] = {
    "plan": PlanRequest,
    "time": TimingRequest,
}


def parse_request(kind: str, document: bytes) -> PlanRequest | TimingRequest:
    """Parse a request for a plan.

    Args:
        kind: ``"plan"`` or ``"time"``.
        document: The request document.

    Raises:
        InvalidRequest: A field is wrong.
    """
    return parse_json(_REQUESTS[kind], document)


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
    request = task.request(_REQUESTS[kind])
    robot = resolve_robot(request, task.robot_named(request.robot))
    return RequestIdentity(plan_id(request, robot), request.budget_s, request.robot)


def make_plan(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/plans``."""
    request = task.request(PlanRequest)
    robot = task.robot_named(request.robot)
    made = planned(request, robot, task.progress, known_id=task.known.plan_id)
    return TaskResult(write_json(made), made.id, figures_of(made))


def make_timing(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/timings``."""
    request = task.request(TimingRequest)
    robot = task.robot_named(request.robot)
    made = timed(request, robot, task.progress, known_id=task.known.plan_id)
    return TaskResult(write_json(made), made.id, figures_of(made))


def answer_ik(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/ik``."""
    request = parse_json(IkRequest, task.document)
    robot = task.robot_named(request.robot)
    solved = solve_ik_request(request, robot=robot, progress=task.progress)
    return TaskResult(write_json(solved))


def answer_ik_batch(task: TaskInput) -> TaskResult:
    """Run the task of ``POST /v1/ik/batch``."""
    request = parse_json(IkBatchRequest, task.document)
    robot = task.robot_named(request.robot)
    solved = solve_ik_batch_request(request, robot=robot, progress=task.progress)
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


def _export(form: Format, task: TaskInput) -> TaskResult:
    """Write a plan in a format."""
    task.begin("export")
    return TaskResult(form.encode(Plan.load(task.document)))


def _measure(task: TaskInput) -> TaskResult:
    """Measure a plan over time; the head of the document is its request."""
    task.begin("series")
    head, plan = split_head(task.document)
    request = parse_json(PlanRequest, head.encode())
    measured = plan_series(request, Plan.load(plan), robot=task.robot_named(request.robot))
    return TaskResult(write_json(measured))


def _read_points(task: TaskInput) -> TaskResult:
    """Read a file of points, with the options of its request as its head."""
    task.begin("reading")
    query, body = split_head(task.document)
    return TaskResult(read_point_file(body, query, task.robot_named(query["robot"])))


def _read_scene(task: TaskInput) -> TaskResult:
    """Read a scene to be stored."""
    task.begin("reading")
    return TaskResult(read_scene_file(task.document))


def _check_upload(task: TaskInput) -> TaskResult:
    """Check an uploaded robot without Pinocchio."""
    task.begin("reading")
    RobotUpload.stored(task.document).describe()
    return TaskResult(b"")


def _describe_robot(task: TaskInput) -> TaskResult:
    """Describe a robot of the catalogue with the shapes of its links."""
    task.begin("reading")
    described = info_with_bodies(task.robot_named(task.document.decode()))
    return TaskResult(described.model_dump_json().encode())


def _draw_robot(task: TaskInput) -> TaskResult:
    """Draw an uploaded robot; the document is the address below which its meshes are."""
    task.begin("reading")
    assert task.robot is not None
    source = RobotUpload.stored(task.robot).urdf.encode()
    drawn = robot_visual(_uploaded(task.robot), source, task.document.decode().__add__)
    return TaskResult(headed({k: str(v) for k, v in drawn.meshes.items()}, drawn.urdf.encode()))


TASKS: dict[str, Callable[[TaskInput], TaskResult]] = {
    "plan": make_plan,
    "time": make_timing,
    "ik": answer_ik,
    "ik-batch": answer_ik_batch,
    "fk": answer_fk,
    "identify-plan": functools.partial(_identify, "plan"),
    "identify-time": functools.partial(_identify, "time"),
    "series": _measure,
    "read-points": _read_points,
    "read-scene": _read_scene,
    "check-upload": _check_upload,
    "describe-robot": _describe_robot,
    "draw-robot": _draw_robot,
    **{f"export-{form.name}": functools.partial(_export, form) for form in FORMATS},
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
    kernels.warm_up(_running("fk"), "fk")
    for jerk in (False, True):
        kernels.warm_up(_running("time"), "time", jerk=jerk)
    kernels.warm_up(_running("ik-batch"), "ik-batch", "lm")
    for method in methods:
        kernels.warm_up(_running("ik"), "ik", method)
        kernels.warm_up(_running("plan"), "plan", method, jerk=True, moves=True)
    robots_document()
    solvers_document()


def _running(kind: str) -> Callable[[Mapping[str, Any]], TaskResult]:
    """Return what runs a request document as a task."""
    return lambda request: run_task(kind, TaskInput(json.dumps(request).encode()))
