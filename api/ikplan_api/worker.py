"""What happens inside a worker process."""

from __future__ import annotations

import contextlib
import functools
import json
import multiprocessing
import os
import resource
import signal
import socket
import threading
import time
import traceback
from typing import NamedTuple

from ikplan.errors import IkplanError
from ikplan_api import handover, tasks
from ikplan_api.tasks import Answer, Work

__all__ = [
    "OUT_OF_MEMORY",
    "READY_S",
    "Done",
    "TaskFault",
    "do",
    "initialize",
    "prepare",
    "ready",
]

OUT_OF_MEMORY = 76
"""Exit code of a worker that ran out of memory."""
READY_S = 300.0
"""Time to load or compile what a task needs before its clock starts [s]: no part of its budget."""
_EVERY_S = 0.05
_SHORT = 32 * 1024
"""Length of a document that a pipe takes in one piece [bytes]."""
_reports: list[socket.socket] = []
_documents: list[socket.socket] = []


class Done(NamedTuple):
    """A task that is done.

    Attributes:
        answer: Its answer.
        handed_over: Length of the answer's document if that comes separately [bytes], else 0.
    """

    answer: Answer
    handed_over: int


class TaskFault(Exception):
    """A task failed as nobody foresaw; holds the traceback, as text that can always travel."""


@functools.cache
def prepare() -> None:
    """Load or compile the kernels and load the robots, once a process."""
    tasks.warm_up()


def initialize(memory_bytes: int, reports: socket.socket, documents: socket.socket) -> None:
    """Set a new worker up.

    Args:
        memory_bytes: Most memory of its own that it may take [bytes]; 0: no limit.
        reports: Where progress is told.
        documents: Where long documents are handed over.
    """
    # To be stopped is to be stopped at once, also in the middle of a kernel.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if memory_bytes:
        resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
    reports.setblocking(False)
    _reports[:] = [reports]
    _documents[:] = [documents]
    threading.Thread(target=_end_with_service, daemon=True).start()


def _end_with_service() -> None:
    """A worker must not outlive a service that was killed, whatever it is doing."""
    service = multiprocessing.parent_process()
    if service is not None:
        service.join()
        os._exit(1)


def ready() -> int:
    """Answer the process id once everything is loaded."""
    prepare()
    return os.getpid()


class _Reporter:
    """Sends progress to the service; starts the task's clock when its first stage begins."""

    def __init__(self, task: int, limit_s: float) -> None:
        self._task = task
        self._limit_s = limit_s
        self._stage = ""
        self._next = 0.0

    def __call__(self, stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        if not self._stage:
            _set_alarm(self._limit_s)
        elif stage == self._stage and now < self._next:
            return
        self._stage, self._next = stage, now + _EVERY_S
        # Whoever reads may be slower: what is lost is overtaken by the next report.
        with contextlib.suppress(BlockingIOError):
            for reports in _reports:
                reports.send(json.dumps([self._task, stage, done, total]).encode())


def _set_alarm(seconds: float) -> None:
    """End this process after a time, whatever it is doing then: nothing handles the signal."""
    signal.setitimer(signal.ITIMER_REAL, seconds)


def do(task: int, kind: str, document: bytes, robot: bytes | None, limit_s: float) -> Done:
    """Do a task.

    Args:
        task: Number under which progress is told.
        kind: Name of the task.
        document: The request document.
        robot: Description of an uploaded robot, or None.
        limit_s: Longest time from the begin of the first stage [s].

    Raises:
        IkplanError: The verdict on the request.
        TaskFault: A fault of ours.
    """
    _set_alarm(READY_S + limit_s)
    try:
        return _done(tasks.run_task(kind, Work(document, robot, _Reporter(task, limit_s))))
    except IkplanError:
        raise
    except MemoryError:
        os._exit(OUT_OF_MEMORY)  # a worker that has seen this is not to be trusted again
    except Exception:
        raise TaskFault(traceback.format_exc()) from None
    finally:
        # Before the answer is sent: a worker that is ended while it sends takes the pipe with it.
        _set_alarm(0.0)


def _done(answer: Answer) -> Done:
    length = len(answer.document)
    if length > _SHORT:
        with contextlib.suppress(OSError):  # then it goes the long way
            handover.send(_documents[0], answer.document)
            return Done(answer._replace(document=b""), length)
    return Done(answer, 0)
