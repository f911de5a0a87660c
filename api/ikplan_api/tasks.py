"""The work of the service, as functions from bytes to bytes, so that any worker can do it."""

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
from ikplan.documents.timing import TimingRequest
from ikplan.errors import Unreachable
from ikplan.identity import plan_id, with_tool
from ikplan.ik.registry import find_solver, solvers
from ikplan.pipeline import fk_request, plan, solve_ik_request
from ikplan.planning import Progress
from ikplan.request import FkRequest, IkRequest, PlanRequest
from ikplan.retiming import time_request
from ikplan.robots import Robot, RobotUpload, catalogue_robot, robot_names
from ikplan_api.facts import PlanFacts, facts_of

__all__ = [
    "TASKS",
    "Answer",
    "Identity",
    "Work",
    "identify",
    "robots_document",
    "run_task",
    "solvers_document",
    "warm_up",
]


class Answer(NamedTuple):
    """What a task answers.

    Attributes:
        document: The JSON document.
        plan_id: Its id, if it is a plan.
        facts: What is measured of it, if it is a plan.
    """

    document: bytes
    plan_id: str | None = None
    facts: PlanFacts | None = None


@dataclass(frozen=True)
class Work:
    """What there is to do.

    Attributes:
        document: The request document as it came in.
        robot: The upload of the robot that the request names; None: one of the catalogue.
        progress: Is told how far it is; None: nobody is.
    """

    document: bytes
    robot: bytes | None = None
    progress: Progress | None = None

    def begin(self, stage: str) -> None:
        """Tell the stage of work that tells no progress by itself."""
        if self.progress is not None:
            self.progress(stage, 0, 0)

    def robot_named(self, name: str) -> Robot:
        """Return the robot of that name: uploaded or the catalogue's, never that of a path.

        Raises:
            RobotNotFound: The catalogue has none of that name.
            InvalidRobot: The description makes no sense.
        """
        if self.robot is not None:
            robot = _uploaded(self.robot)
            if robot.name == name:
                return robot
        return _of_catalogue(name)


@functools.lru_cache(maxsize=64)
def _of_catalogue(name: str) -> Robot:
    """As it was when it was first asked for: its files are not looked at for each request."""
    return catalogue_robot(name)


@functools.lru_cache(maxsize=64)
def _uploaded(document: bytes) -> Robot:
    return parse_json(RobotUpload, document).robot()


class Identity(NamedTuple):
    """What a request is known by before it is planned.

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


def identify(kind: str, work: Work) -> Identity:
    """Tell the id of a plan before it is made.

    Args:
        kind: ``"plan"`` or ``"time"``.
        work: The request.

    Raises:
        InvalidRequest: A field is wrong.
        RobotNotFound: No robot of that name.
        InvalidRobot: The description of the uploaded robot makes no sense.
    """
    request = parse_json(_REQUESTS[kind], work.document)
    robot = with_tool(work.robot_named(request.robot), request.tool)
    return Identity(plan_id(request, robot), request.budget_s)


def make_plan(work: Work) -> Answer:
    """Answer ``POST /v1/plans``."""
    request = parse_json(PlanRequest, work.document)
    made = plan(request, robot=work.robot_named(request.robot), progress=work.progress)
    return Answer(write_json(made), made.id, facts_of(made))


def make_timing(work: Work) -> Answer:
    """Answer ``POST /v1/timings``."""
    request = parse_json(TimingRequest, work.document)
    made = time_request(request, robot=work.robot_named(request.robot), progress=work.progress)
    return Answer(write_json(made), made.id, facts_of(made))


def answer_ik(work: Work) -> Answer:
    """Answer ``POST /v1/ik``."""
    request = parse_json(IkRequest, work.document)
    robot = work.robot_named(request.robot)
    solved = solve_ik_request(request, robot=robot, progress=work.progress)
    return Answer(write_json(solved))


def answer_fk(work: Work) -> Answer:
    """Answer ``POST /v1/fk``."""
    work.begin("fk")
    request = parse_json(FkRequest, work.document)
    placed = fk_request(request, robot=work.robot_named(request.robot))
    return Answer(write_json(placed))


def _identify(kind: str, work: Work) -> Answer:
    """Do by a worker what would keep the event loop too long."""
    work.begin("reading")
    return Answer(json.dumps(identify(kind, work)).encode())


TASKS: dict[str, Callable[[Work], Answer]] = {
    "plan": make_plan,
    "time": make_timing,
    "ik": answer_ik,
    "fk": answer_fk,
    "identify-plan": functools.partial(_identify, "plan"),
    "identify-time": functools.partial(_identify, "time"),
}


def run_task(kind: str, work: Work) -> Answer:
    """Do one task.

    Args:
        kind: Name of the task, a key of :data:`TASKS`.
        work: What there is to do.

    Raises:
        IkplanError: The verdict on the request.
    """
    return TASKS[kind](work)


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
            run_task(kind, Work(json.dumps(request).encode()))
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
