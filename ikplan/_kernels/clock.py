"""How much time has gone into compiling and loading what the process computes with."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator

from ikplan.processor_time import thread_clock

__all__ = ["KernelTime", "counting", "kernel_seconds", "thread_kernels", "working_seconds"]


class KernelTime:
    """Time that goes into kernels, by one clock; what is within another is counted once."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._depth = 0
        self._since = 0.0
        self._total = 0.0

    def begin(self, now: float) -> None:
        """A kernel is compiled or loaded from now on [s]."""
        with self._lock:
            if self._depth == 0:
                self._since = now
            self._depth += 1

    def end(self, now: float) -> None:
        """It is there [s]."""
        with self._lock:
            self._depth -= 1
            if self._depth == 0:
                self._total += now - self._since

    def seconds(self, clock: Callable[[], float]) -> float:
        """Return the time so far [s], with what is being compiled now by a clock [s]."""
        with self._lock:
            return self._total + (clock() - self._since if self._depth else 0.0)


_process = KernelTime()
_threads = threading.local()


def thread_kernels() -> KernelTime:
    """Return the processor time that the calling thread itself puts into kernels."""
    found = getattr(_threads, "kernels", None)
    if not isinstance(found, KernelTime):
        found = _threads.kernels = KernelTime()
    return found


@contextlib.contextmanager
def counting() -> Iterator[None]:
    """Count the time within: the wall time of the process, the processor time of the thread."""
    own, processor = thread_kernels(), thread_clock()
    _process.begin(time.perf_counter())
    own.begin(processor())
    try:
        yield
    finally:
        own.end(processor())
        _process.end(time.perf_counter())


def working_seconds() -> float:
    """Return the processor time of the calling thread without what it puts into kernels [s]."""
    clock = thread_clock()
    return clock() - thread_kernels().seconds(clock)


def kernel_seconds() -> float:
    """Return the wall time of the process so far [s], with what is being compiled now."""
    return _process.seconds(time.perf_counter)
