"""Processes that compile at the same time share the work: one compiles, the others wait for it.

A kernel that is being compiled has a lock on a file beside its index. Kernels call each other
without circles, so that whoever waits never has what the other waits for; should a process hang,
the others stop waiting.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

__all__ = ["Turn", "take_turn"]

T = TypeVar("T")

_PATIENCE_S = 120.0
_PAUSE_S = 0.02


class Turn:
    """The right to compile a kernel, until it is given back or the process ends."""

    def __init__(self, path: Path) -> None:
        """Take the turn.

        Raises:
            BlockingIOError: Another process has it.
            OSError: The folder cannot be written.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._file)
            raise

    def give_back(self) -> None:
        """Let others have the kernel, compiled."""
        with contextlib.suppress(OSError):
            self._path.unlink()
        os.close(self._file)


def take_turn(path: Path, look: Callable[[], T | None]) -> T | Turn | None:
    """Wait until a kernel is there, or it is this process's turn to compile it.

    Args:
        path: The file of the lock.
        look: Looks for the kernel.

    Returns:
        The kernel; or the turn to compile it; or None where there are no turns: the folder cannot
        be written, or the other process takes too long.
    """
    end = time.monotonic() + _PATIENCE_S
    while time.monotonic() < end:
        try:
            turn = Turn(path)
        except BlockingIOError:
            time.sleep(_PAUSE_S)
            continue
        except OSError:
            return None
        found = look()  # whoever had the turn before may have compiled it
        if found is None:
            return turn
        turn.give_back()
        return found
    return None
