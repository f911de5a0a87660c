"""How a command fails: its exit code, one line on stderr, the repairs there are, a document."""

from __future__ import annotations

import sys
import traceback
from typing import Any

from ikplan.cli.terminal.output import say_json
from ikplan.documents.json_text import json_ready
from ikplan.errors import IkplanError, InvalidInput, NoPlan

__all__ = ["INTERNAL", "NO_PLAN", "WRONG_INPUT", "fail", "fail_of_fault", "fail_of_file"]

NO_PLAN = 1
"""The request makes sense, and there is no plan; or not one for all of a batch."""
WRONG_INPUT = 2
"""Wrong usage or input."""
INTERNAL = 3
"""The service cannot be reached or refuses, or a fault of ours."""


def fail(error: IkplanError, *, as_json: bool) -> int:
    """Tell an error.

    Args:
        error: The error.
        as_json: Print its problem document too.

    Returns:
        The exit code.
    """
    _line(error.slug, error.detail)
    repairs: list[dict[str, Any]] = getattr(error, "repairs", [])
    for number, repair in enumerate(repairs, start=1):
        _write(f"  repair {number}: {repair['detail']}\n")
    if repairs:
        _write("  (--repair N applies one and plans)\n")
    if as_json:
        say_json(json_ready(error.to_problem()))
    if isinstance(error, InvalidInput):
        return WRONG_INPUT
    return NO_PLAN if isinstance(error, NoPlan) else INTERNAL


def fail_of_file(error: OSError, *, as_json: bool) -> int:
    """Tell that a file, or an address to listen on, cannot be used."""
    reason = error.strerror or str(error)
    where = f"{error.filename}: " if error.filename is not None else ""
    _line("file-error", where + reason)
    if as_json:
        say_json({"type": "about:blank", "title": "File error", "detail": where + reason})
    return WRONG_INPUT


def fail_of_fault(error: Exception, *, as_json: bool) -> int:
    """Tell a fault of ours, with what is needed to find it."""
    traceback.print_exception(error)
    _line(
        "internal-fault", f"{type(error).__name__}: {error}; please report it with the lines above"
    )
    if as_json:
        say_json({"type": "about:blank", "title": "Internal fault", "detail": str(error)})
    return INTERNAL


def _line(slug: str, detail: str) -> None:
    _write(f"ikplan: {slug}: {' '.join(detail.split())}\n")


def _write(line: str) -> None:
    plain_line = "".join(c if c.isprintable() or c == "\n" else "?" for c in line)
    encoding = sys.stderr.encoding or "utf-8"
    sys.stderr.write(plain_line.encode(encoding, "backslashreplace").decode(encoding))
