"""Inspection of the store's file before it is used, and what to do with a damaged one."""

from __future__ import annotations

import logging
import os
import sqlite3
import time
from contextlib import closing
from pathlib import Path

__all__ = ["DamagedStore", "NewerStore", "inspect", "set_aside"]

_log = logging.getLogger("ikplan.service")

_SQLITE_CORRUPT = 11
_READ_WHOLE = 64 * 2**20
"""Length up to which every page is checked, within a second [bytes]."""
_QUERIES = (
    "SELECT id, bytes, made, used, owner, kind, robot FROM plans",
    "SELECT id, kind, budget_s, accepted, problem, robot, document, owner, robot_name FROM jobs",
    "SELECT name, bytes, used, info, owner FROM robots",
    "SELECT id, made, document FROM kept LIMIT 0",
)
"""What a start reads: names, and the jobs that are to be resumed."""


class DamagedStore(Exception):
    """The file is a database, and what the service stored in it cannot be read."""


class NewerStore(Exception):
    """The file was written by a newer version of the service."""


def inspect(path: str, version: int) -> None:
    """Check that a file can be written, and read what a start reads.

    Args:
        path: The file; created if missing.
        version: The newest version of its content that is known.

    Raises:
        DamagedStore: Pages are malformed or missing, or tables are.
        NewerStore: It was written by a newer version.
        OSError: It cannot be created.
        sqlite3.Error: It cannot be written or locked, or is no database.
    """
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with closing(sqlite3.connect(path, isolation_level=None, timeout=1.0)) as file:
        try:
            file.execute("BEGIN IMMEDIATE")
            file.execute("ROLLBACK")
            (found,) = file.execute("PRAGMA user_version").fetchone()
            if found > version:
                raise NewerStore
            if found == version:
                _read(file, path)
        except sqlite3.DatabaseError as error:
            # An extended code has the primary one in its lowest byte.
            code = getattr(error, "sqlite_errorcode", 0) & 0xFF
            if code == _SQLITE_CORRUPT or "no such" in str(error):
                raise DamagedStore(str(error)) from error
            raise


def _read(file: sqlite3.Connection, path: str) -> None:
    for query in _QUERIES:
        for _ in file.execute(query):
            pass
    if os.path.getsize(path) <= _READ_WHOLE:
        (verdict,) = file.execute("PRAGMA quick_check(1)").fetchone()
        if verdict != "ok":
            raise DamagedStore(str(verdict).splitlines()[-1])


def set_aside(path: str) -> str:
    """Rename a damaged file and its journal, so that a new one can be started.

    Returns:
        The new name of the file.
    """
    name = f"{path}.damaged-{time.strftime('%Y%m%dT%H%M%S', time.gmtime())}"
    for suffix in ("", "-wal", "-shm"):
        if os.path.exists(path + suffix):
            os.rename(path + suffix, name + suffix)
    _log.warning("the damaged store is set aside as %s; its plans and jobs are not read", name)
    return name
