"""How much time of the process has gone into compiling and loading kernels."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator

__all__ = ["counting", "kernel_seconds"]

_lock = threading.Lock()
_depth = 0
_since = 0.0
_total = 0.0


@contextlib.contextmanager
def counting() -> Iterator[None]:
    """Count the time within; what is within already is counted once."""
    global _depth, _since, _total
    with _lock:
        if _depth == 0:
            _since = time.perf_counter()
        _depth += 1
    try:
        yield
    finally:
        with _lock:
            _depth -= 1
            if _depth == 0:
                _total += time.perf_counter() - _since


def kernel_seconds() -> float:
    """Return the time so far [s], with what is being compiled now."""
    with _lock:
        return _total + (time.perf_counter() - _since if _depth else 0.0)
