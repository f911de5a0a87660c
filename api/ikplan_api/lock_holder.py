"""Which process has a file to itself."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["lock_holder"]

_LOCKS = Path("/proc/locks")


def lock_holder(path: str, locks: Path = _LOCKS) -> int | None:
    """Return the id of a process that holds a lock on a file; None: not known.

    The file is not opened: closing it again would end locks that this process itself may hold.

    Args:
        path: The file.
        locks: Where the kernel tells the locks that are held.
    """
    try:
        file = os.stat(path)
        lines = locks.read_text().splitlines()
    except OSError:
        return None
    wanted = f"{os.major(file.st_dev):02x}:{os.minor(file.st_dev):02x}:{file.st_ino}"
    for line in lines:
        # 1: POSIX  ADVISORY  WRITE 4711 fe:00:2146700 1073741826 1073742335
        words = line.split()
        # A process that cannot be seen from here is 0 or less.
        if len(words) > 5 and words[5] == wanted and words[4].isdecimal() and int(words[4]):
            return int(words[4])
    return None
