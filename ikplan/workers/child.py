"""What every worker process does, whatever its tasks are."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading

__all__ = ["Fault", "set_up"]


class Fault(Exception):
    """An unexpected failure of a task; holds the traceback as text, which can always be pickled."""


def set_up() -> None:
    """End this process on SIGTERM, or with its parent, whatever it does."""
    # SIGTERM must end the process at once, even inside a kernel.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process when its parent ends, even if that was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
