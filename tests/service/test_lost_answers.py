"""Whatever fails on the way from a worker: the task is answered, or run again, never forgotten."""

from __future__ import annotations

import asyncio
import contextlib
import json
import pickle
import socket
from typing import Any

import pytest
from pebble import ProcessExpired

from ikplan import RobotNotFound, WorkerLost
from ikplan.workers.process import TaskNotStarted
from ikplan_api.workers import shared_memory, worker
from ikplan_api.workers.shared_memory import DocumentReceiver, DocumentSender
from ikplan_api.workers.task_line import TaskLine, hear, say
from ikplan_api.workers.tasks import TaskInput, TaskResult
from ikplan_api.workers.worker_slot import WorkerSlot

LONG = bytes(range(256)) * 1024
TASK = TaskInput(b"{}")


class Worker:
    """What answers in the place of a worker, over the sockets of its slot.

    Args:
        answer: What it says to any task.
        document: What it sends in shared memory before; None: nothing.
        closes: Whether it closes that socket.
    """

    def __init__(self, answer: object, document: bytes | None = None, closes: bool = False) -> None:
        self.slot = WorkerSlot(0)
        self.slot._line = self._line = TaskLine()
        self.slot._documents = documents = DocumentReceiver()
        self.slot._reports = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.slot._reports[0].setblocking(False)
        self._answer, self._document, self._closes = answer, document, closes
        self._there = documents.there

    def _work(self) -> None:
        number, _ = hear(self._line.there, lambda _: None)
        if self._document is not None:
            with contextlib.closing(DocumentSender(self._there)) as sender:
                sender.send(self._document)
        if self._closes:
            self._there.close()
        if isinstance(self._answer, ProcessExpired):
            self.slot._reports[1].send(json.dumps([number, "", 0, 0]).encode())
            self._loop.call_soon_threadsafe(self.slot._end, self._line, self._answer)
        else:
            say(self._line.there, number, pickle.dumps(self._answer))

    def run(self, healthy: list[bool], task: TaskInput = TASK) -> TaskResult:
        async def ask() -> TaskResult:
            self._loop = asyncio.get_running_loop()
            working = asyncio.create_task(asyncio.to_thread(self._work))
            try:
                return await self.slot.run("fk", task, worker.TaskLimits(1.0, 1.0), lambda *_: None)
            finally:
                await working
                healthy.append(self.slot.healthy)
                await self.slot.empty()

        return asyncio.run(ask())


def test_a_long_answer_arrives_by_shared_memory() -> None:
    healthy: list[bool] = []
    ready = Worker(worker.WorkerReply(TaskResult(b""), len(LONG)), LONG)
    assert ready.run(healthy).document == LONG
    assert healthy == [True]


@pytest.mark.parametrize("closed", [False, True])
def test_a_long_answer_that_does_not_arrive_is_made_again(closed: bool) -> None:
    healthy: list[bool] = []
    with pytest.raises(TaskNotStarted):
        Worker(worker.WorkerReply(TaskResult(b""), len(LONG)), closes=closed).run(healthy)
    assert healthy == [False]  # it is replaced


def test_a_task_and_an_answer_longer_than_any_buffer_arrive() -> None:
    long, healthy = bytes(8 * 2**20), list[bool]()
    echo = Worker(worker.WorkerReply(TaskResult(long), 0))
    assert echo.run(healthy, TaskInput(long)).document == long
    assert healthy == [True]


def test_a_verdict_leaves_the_worker_as_it_is() -> None:
    healthy: list[bool] = []
    with pytest.raises(RobotNotFound):
        Worker(RobotNotFound("no such robot", name="x", valid=[])).run(healthy)
    assert healthy == [True]


def test_a_worker_that_ends_in_a_task_that_it_began_is_lost() -> None:
    healthy: list[bool] = []
    expired: Any = ProcessExpired
    with pytest.raises(WorkerLost):
        Worker(expired("ended", code=-11)).run(healthy)
    assert healthy == [False]


@pytest.mark.parametrize("nth", [1, 2])
def test_the_pipe_carries_what_shared_memory_does_not(
    nth: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = [nth]

    def failing(inner: Any) -> Any:
        def send(*arguments: Any) -> Any:
            left[0] -= 1
            if not left[0]:
                raise OSError("no memory")
            return inner(*arguments)

        return send

    receiver = DocumentReceiver()
    sender = DocumentSender(receiver.there)
    monkeypatch.setattr(worker, "_documents", [sender])
    monkeypatch.setattr(shared_memory, "_memory", failing(shared_memory._memory))
    monkeypatch.setattr(socket, "send_fds", failing(socket.send_fds))
    reply = worker._reply(TaskResult(LONG))
    assert (reply.result.document, reply.shared_bytes) == (LONG, 0)
    for end in (sender, receiver):
        end.close()
