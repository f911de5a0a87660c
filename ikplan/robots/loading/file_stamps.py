"""Which state a file is in, told without reading it."""

from __future__ import annotations

import os

__all__ = ["Stamp", "stamp"]

Stamp = tuple[int, int, int, int, int] | None
"""Device, inode, size, and times of the last changes [ns] of a file; None: there is none."""


def stamp(path: str) -> Stamp:
    """Return the state of a file: another one once it is written, replaced or removed.

    Args:
        path: The file.
    """
    try:
        found = os.stat(path)
    except (OSError, ValueError):  # ValueError: a null byte in the path
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns
