"""The code that runs inside a worker process."""

from __future__ import annotations

import contextlib
import functools
import os
import pickle
import resource
import signal
import socket
import time
import traceback
from dataclasses import replace
from typing import NamedTuple

import orjson

from ikplan.errors import IkplanError
from ikplan.workers.child import Fault, set_up
from ikplan_api.workers import task_line, tasks
from ikplan_api.workers.shared_memory import DocumentSender
from ikplan_api.workers.tasks import TaskInput, TaskResult

__all__ = [
    "OUT_OF_MEMORY",
    "READY_S",
    "TaskLimits",
    "WorkerReply",
    "initialize",
    "prepare",
    "ready",
    "run",
    "serve",
]

OUT_OF_MEMORY = 76
"""Exit code of a worker that ran out of memory."""
READY_S = 300.0
"""Time to load or compile kernels before a task's clock starts [s]; not part of its budget."""
_EVERY_S = 0.05
_SHORT = 32 * 1024
"""Longest document that the line of the task carries [bytes]."""
_reports: list[socket.socket] = []
_documents: list[DocumentSender] = []


class TaskLimits(NamedTuple):
    """Time in which a task must end, from the start of its first stage.

    Attributes:
        processor_s: Processor time of the process [s].
        wall_s: Wall time [s].
    """

    processor_s: float
    wall_s: float


class WorkerReply(NamedTuple):
    """The reply of a worker to a task.

    Attributes:
        result: The result.
        shared_bytes: Length of the document if it is sent in shared memory [bytes], else 0.
    """

    result: TaskResult
    shared_bytes: int


@functools.cache
def prepare() -> None:
    """Load or compile the kernels and load the robots, once per process."""
    tasks.warm_up()


def initialize(memory_bytes: int, reports: socket.socket, documents: socket.socket) -> None:
    """Set up a new worker.

    Args:
        memory_bytes: Private memory that it may allocate [bytes]; 0: no limit.
        reports: Socket for progress reports.
        documents: Socket by which memory for long documents is handed over.
    """
    set_up()
    if memory_bytes:
        resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
    reports.setblocking(False)
    _reports[:] = [reports]
    _documents[:] = [DocumentSender(documents)]


def ready() -> int:
    """Return the process id once everything is loaded."""
    prepare()
    return os.getpid()


class _Reporter:
    """Sends progress to the service; starts the task's clock at its first stage."""

    def __init__(self, task: int, limits: TaskLimits) -> None:
        self._task = task
        self._limits = limits
        self._stage = ""
        self._next = 0.0

    def __call__(self, stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        if not self._stage:
            _set_alarms(*self._limits)
        elif stage == self._stage and now < self._next:
            return
        self._stage, self._next = stage, now + _EVERY_S
        _report(self._task, stage, done, total)


def _report(task: int, stage: str, done: int, total: int) -> None:
    # The reader may be slower: the next report replaces a lost one.
    with contextlib.suppress(BlockingIOError):
        for reports in _reports:
            reports.send(orjson.dumps([task, stage, done, total]))


def _begun(task: int) -> None:
    """Report that a task has arrived, by a stage without a name."""
    _report(task, "", 0, 0)


def serve(connection: socket.socket) -> None:
    """Run the tasks that arrive, one after the other, until the service ends.

    Args:
        connection: The worker's end of its line.
    """
    while True:
        try:
            number, message = task_line.hear(connection, _begun)
        except OSError:
            return
        except MemoryError:
            os._exit(OUT_OF_MEMORY)
        task_line.say(connection, number, _answer(number, message))


def _answer(number: int, message: bytes) -> bytes:
    """Run the task of a message; return its reply or its error, pickled."""
    try:
        answer: WorkerReply | Exception = run(number, *pickle.loads(message))
    except (IkplanError, Fault) as error:
        answer = error
    except MemoryError:
        os._exit(OUT_OF_MEMORY)
    return pickle.dumps(answer, pickle.HIGHEST_PROTOCOL)


def _set_alarms(processor_s: float, wall_s: float) -> None:
    """End this process after either time [s]; 0: never. No handler catches the signals."""
    signal.setitimer(signal.ITIMER_PROF, processor_s)
    signal.setitimer(signal.ITIMER_REAL, wall_s)


def run(number: int, kind: str, task: TaskInput, limits: TaskLimits) -> WorkerReply:
    """Run a task.

    Args:
        number: Number of the task in progress reports.
        kind: Name of the task.
        task: Its input.
        limits: Time in which it must end.

    Raises:
        IkplanError: The verdict on the request.
        Fault: An unexpected failure.
    """
    _set_alarms(0.0, READY_S + limits.wall_s)
    try:
        return _reply(tasks.run_task(kind, replace(task, progress=_Reporter(number, limits))))
    except IkplanError:
        raise
    except MemoryError:
        os._exit(OUT_OF_MEMORY)  # the state of this process is unreliable now
    except Exception:
        raise Fault(traceback.format_exc()) from None
    finally:
        # Before the reply is sent: nothing is lost on the way.
        _set_alarms(0.0, 0.0)


def _reply(result: TaskResult) -> WorkerReply:
    length = len(result.document)
    if length > _SHORT:
        with contextlib.suppress(OSError):  # then the line carries it
            _documents[0].send(result.document)
            return WorkerReply(result._replace(document=b""), length)
    return WorkerReply(result, 0)
