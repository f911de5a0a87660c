"""The work of a batch of requests: one result or problem a line, by kind of request."""

from __future__ import annotations

import inspect
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ikplan.batch.executor import Answers
from ikplan.batch.outcome import OK, Outcome, failed
from ikplan.documents import load_json, write_json
from ikplan.errors import IkplanError, InvalidRequest

if TYPE_CHECKING:
    from ikplan.plans.plan import Plan
    from ikplan.robots import Robot

__all__ = ["KINDS", "RequestWork"]

UNEXPECTED = "an unexpected fault of ikplan, told on stderr"


@dataclass(frozen=True)
class RequestWork:
    """Answers requests of one kind.

    Attributes:
        kind: One of :data:`KINDS`.
        robot: The robot of every line; None: the one that each names.
        seconds: Whether plans tell how long their stages took. Without it the same line always
            has the same answer, byte for byte.
    """

    kind: str
    robot: Robot | None = None
    seconds: bool = True

    @property
    def preload(self) -> str:
        """The module that loads the kernels of the kind."""
        return f"ikplan.batch.preload.{self.kind}"

    def answer(self, lines: Sequence[bytes]) -> Answers:
        """Answer some lines; no line spoils another."""
        begun = time.perf_counter()
        outcomes: list[Outcome] = []
        faults = []
        if self.kind == "ik":
            try:
                outcomes = self._poses(lines)
            except Exception:  # of which line is found out below
                outcomes = []
        for line in lines[len(outcomes) :]:
            try:
                outcomes += self._poses([line]) if self.kind == "ik" else [self._outcome(line)]
            except Exception:  # told on stderr, and the other lines go on
                faults.append(traceback.format_exc())
                outcomes.append(failed(IkplanError(UNEXPECTED)))
        return Answers(outcomes, time.perf_counter() - begun, tuple(faults))

    def _document(self, line: bytes) -> Any:
        document = load_json(line)
        if self.robot is not None and isinstance(document, dict):
            document["robot"] = self.robot.name
        return document

    def _outcome(self, line: bytes) -> Outcome:
        try:
            return Outcome(OK, _ANSWERS[self.kind](self, self._document(line)))
        except IkplanError as error:
            return failed(error)

    def _poses(self, lines: Sequence[bytes]) -> list[Outcome]:
        """Solve poses together."""
        from ikplan.pipeline.pose_batch.request import solve_ik_requests

        outcomes: dict[int, Outcome] = {}
        documents: dict[int, Any] = {}
        for k, line in enumerate(lines):
            try:
                documents[k] = self._document(line)
            except IkplanError as error:
                outcomes[k] = failed(error)
        answers = solve_ik_requests([*documents.values()], robot=self.robot)
        for k, answer in zip(documents, answers, strict=True):
            if isinstance(answer, IkplanError):
                outcomes[k] = failed(answer)
            else:
                outcomes[k] = Outcome(OK, write_json(answer))
        return [outcomes[k] for k in range(len(lines))]

    def plan(self, document: Any) -> bytes:
        """Plan a request, see :func:`ikplan.plan`."""
        from ikplan.pipeline.plan import plan

        return self._written(plan(document, robot=self.robot))

    def time(self, document: Any) -> bytes:
        """Time a joint path, see :func:`ikplan.time_request`."""
        from ikplan.pipeline.retime import time_request

        return self._written(time_request(document, robot=self.robot))

    def move(self, document: Any) -> bytes:
        """Make a move whose arguments are the fields of a document, see :func:`ikplan.move`."""
        from ikplan.pipeline.move import move

        return self._written(move(**self._arguments(move, document)))

    def _arguments(self, function: Callable[..., Any], document: Any) -> dict[str, Any]:
        """The fields of a document as arguments of a function.

        Raises:
            InvalidRequest: It is no object, or has an unknown field or lacks one.
        """
        allowed = [name for name in inspect.signature(function).parameters if name != "progress"]
        if not isinstance(document, dict):
            raise InvalidRequest("the request must be a JSON object", allowed=allowed)
        for name in document:
            if name not in allowed:
                raise InvalidRequest(f"{name}: no such field", field=name, allowed=allowed)
        for name in ("robot", "goal"):
            if name not in document:
                raise InvalidRequest(f"{name}: is missing", field=name, allowed=allowed)
        arguments = {"start": None, **document}
        if self.robot is not None:
            arguments["robot"] = self.robot
        elif not isinstance(arguments["robot"], str):
            raise InvalidRequest("robot: must be the name of a robot", field="robot")
        return arguments

    def _written(self, made: Plan) -> bytes:
        if not self.seconds:
            stats = made.stats.model_copy(update={"seconds": {}})
            made = made.model_copy(update={"stats": stats})
        return made.model_dump_json().encode()


_ANSWERS: dict[str, Callable[[RequestWork, Any], bytes]] = {
    "plan": RequestWork.plan,
    "time": RequestWork.time,
    "move": RequestWork.move,
}
"""What a line of each kind is answered by; poses are answered together."""
KINDS = ("plan", "ik", "time", "move")
"""The kinds of requests."""
