"""The process that batches and the service share: it ends when told to, and is replaced."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator

import pytest
from pebble import ProcessExpired

from ikplan.workers.child import set_up
from ikplan.workers.process import TaskNotStarted, WorkerProcess, worker_lost


@pytest.fixture
def process() -> Iterator[WorkerProcess]:
    made = WorkerProcess("ikplan.workers.child", set_up)
    made.start()
    yield made
    made.stop()


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_one_process_does_one_task_after_the_other(process: WorkerProcess) -> None:
    pids = {process.begin(os.getpid).result(60.0) for _ in range(3)}
    assert len(pids) == 1
    assert pids != {os.getpid()}


def test_a_process_that_is_killed_in_a_task_is_lost_by_its_signal(process: WorkerProcess) -> None:
    pid = process.begin(os.getpid).result(60.0)
    doing = process.begin(time.sleep, 60.0)
    time.sleep(0.2)
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(ProcessExpired) as caught:
        doing.result(60.0)
    lost = worker_lost(caught.value)
    assert lost.exit_code == -signal.SIGKILL
    assert "SIGKILL" in lost.detail


def test_a_task_that_takes_too_long_is_ended(process: WorkerProcess) -> None:
    pid = process.begin(os.getpid).result(60.0)
    with pytest.raises(TimeoutError):
        process.begin(time.sleep, 60.0, timeout_s=0.2).result(60.0)
    assert not alive(pid)


def test_stopping_ends_the_task_and_the_process(process: WorkerProcess) -> None:
    pid = process.begin(os.getpid).result(60.0)
    doing = process.begin(time.sleep, 60.0)
    process.stop()
    assert not alive(pid)
    with pytest.raises(TaskNotStarted):
        doing.result(0.0)
    assert not process.active
    with pytest.raises(TaskNotStarted):
        process.begin(os.getpid)


def test_a_process_that_starts_again_is_another_one(process: WorkerProcess) -> None:
    first = process.begin(os.getpid).result(60.0)
    process.start()
    assert process.active
    assert process.begin(os.getpid).result(60.0) != first
    assert not alive(first)
