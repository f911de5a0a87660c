"""Whatever fails on the way from a worker: the task is answered, or run again, never forgotten."""

from __future__ import annotations

import asyncio
import socket
from concurrent.futures import Future
from typing import Any

import pytest

from ikplan.workers.process import TaskNotStarted
from ikplan_api.workers import shared_memory, worker
from ikplan_api.workers.tasks import TaskInput, TaskResult
from ikplan_api.workers.worker_slot import WorkerSlot

LONG = bytes(range(256)) * 1024


def slot_with(reply: worker.WorkerReply) -> tuple[WorkerSlot, socket.socket]:
    """A slot whose worker has this reply, and the worker's end of its pair of sockets."""

    class Process:
        def begin(self, *_: object, **__: object) -> Future[worker.WorkerReply]:
            done: Future[worker.WorkerReply] = Future()
            done.set_result(reply)
            return done

        def stop(self) -> None:
            return None

    slot = WorkerSlot(0, socket.socket())
    here, there = socket.socketpair()
    here.setblocking(False)
    slot._process = Process()  # type: ignore[assignment]
    slot._documents = here, there
    return slot, there


def run(slot: WorkerSlot, healthy: list[bool]) -> TaskResult:
    async def ask() -> TaskResult:
        try:
            return await slot.run(1, "fk", TaskInput(b"{}"), worker.TaskLimits(1.0, 1.0))
        finally:
            healthy.append(slot.healthy)
            slot._initial[1].close()
            await slot.empty()

    return asyncio.run(ask())


def test_a_long_answer_arrives_by_shared_memory() -> None:
    slot, there = slot_with(worker.WorkerReply(TaskResult(b""), len(LONG)))
    shared_memory.send(there, LONG)
    healthy: list[bool] = []
    assert run(slot, healthy).document == LONG
    assert healthy == [True]


@pytest.mark.parametrize("closed", [False, True])
def test_a_long_answer_that_does_not_arrive_is_made_again(closed: bool) -> None:
    slot, there = slot_with(worker.WorkerReply(TaskResult(b""), len(LONG)))
    if closed:
        there.close()
    healthy: list[bool] = []
    with pytest.raises(TaskNotStarted):
        run(slot, healthy)
    assert healthy == [False]  # it is replaced


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

    here, there = socket.socketpair()
    monkeypatch.setattr(worker, "_documents", [there])
    monkeypatch.setattr(shared_memory, "_memory", failing(shared_memory._memory))
    monkeypatch.setattr(socket, "send_fds", failing(socket.send_fds))
    reply = worker._reply(TaskResult(LONG))
    assert (reply.result.document, reply.shared_bytes) == (LONG, 0)
    for end in (here, there):
        end.close()
