"""The processor time of a thread, which other threads can read."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

__all__ = ["WALL_FACTOR", "has_thread_clocks", "thread_clock"]

WALL_FACTOR = 4.0
"""Most wall time in which a budget of processor time is spent, in budgets."""


def has_thread_clocks() -> bool:
    """Return whether the platform has clocks of threads that other threads can read."""
    return hasattr(time, "pthread_getcpuclockid")  # not on macOS and Windows


def thread_clock() -> Callable[[], float]:
    """Return a clock of the calling thread's processor time [s].

    Any thread can read it until that thread ends; then it raises OSError. It is not to be kept
    over a fork. Where the platform has no such clock, it shows wall time.
    """
    if not has_thread_clocks():
        return lambda: time.perf_counter()
    clock = time.pthread_getcpuclockid(threading.get_ident())
    return lambda: time.clock_gettime(clock)
