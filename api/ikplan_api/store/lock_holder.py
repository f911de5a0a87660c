"""Find the process that holds a lock on a file."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["lock_holder"]

_LOCKS = Path("/proc/locks")


def lock_holder(path: str, locks: Path = _LOCKS) -> int | None:
    """Return the id of a process that holds a lock on a file, or None if unknown.

    The file is not opened: closing it again would end locks that this process itself may hold.

    Args:
        path: The file.
        locks: The kernel's list of held locks.
    """
    try:
        file = os.stat(path)
        lines = locks.read_text().splitlines()
    except OSError:
        return None
    inode = f"{os.major(file.st_dev):02x}:{os.minor(file.st_dev):02x}:{file.st_ino}"
    for line in lines:
        # 1: POSIX  ADVISORY  WRITE 4711 fe:00:2146700 1073741826 1073742335
        words = line.split()
        # A process outside of this namespace has an id of 0 or less.
        if len(words) > 5 and words[5] == inode and words[4].isdecimal() and int(words[4]):
            return int(words[4])
    return None
