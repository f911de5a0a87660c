"""How a command fails: its exit code, one line on stderr, the repairs there are, a document."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

from ikplan.cli.terminal.exit_codes import INTERNAL, NO_PLAN, WRONG_INPUT
from ikplan.cli.terminal.output import say_json
from ikplan.errors import IkplanError, InCollision, InvalidInput, NoPlan

__all__ = ["INTERNAL", "NO_PLAN", "WRONG_INPUT", "fail", "fail_of_fault", "fail_of_file"]


def fail(error: IkplanError, *, as_json: bool) -> int:
    """Tell an error.

    Args:
        error: The error.
        as_json: Print its problem document too.

    Returns:
        The exit code.
    """
    _line(error.slug, error.detail)
    if isinstance(error, InCollision):
        _write("".join(f"  {line}\n" for line in _contact(error)))
    repairs: list[dict[str, Any]] = getattr(error, "repairs", [])
    for number, repair in enumerate(repairs, start=1):
        _write(f"  repair {number}: {repair['detail']}\n")
    if repairs:
        _write("  (--repair N applies one and plans)\n")
    if as_json:
        from ikplan.documents.json_text import json_ready

        say_json(json_ready(error.to_problem()))
    if isinstance(error, InvalidInput):
        return WRONG_INPUT
    return NO_PLAN if isinstance(error, NoPlan) else INTERNAL


def _contact(error: InCollision) -> Iterator[str]:
    """Where a contact is, between what, and how deep."""
    if not error.pair:
        return
    yield f"bodies: {' and '.join(error.pair)}"
    if error.time is not None:
        yield f"place: at {error.time:.3f} s of the motion"
    elif error.waypoint is not None:
        yield f"place: {'the start' if error.waypoint < 0 else f'waypoint {error.waypoint}'}"
    if error.q:
        yield f"joint values there: {' '.join(f'{v:.4f}' for v in error.q)}"
    if error.depth > 0.0:
        yield f"depth: {error.depth * 1e3:.2f} mm less than is asked for"
    yield "contact is proven there" if error.proven else "no way around was found"


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
    import traceback

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
