"""How answers look in a terminal."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from typing import Any, TextIO

__all__ = ["number", "say", "say_json", "table"]


def say(*lines: str, stream: TextIO | None = None) -> None:
    """Write lines on a stream (None: standard output), whatever its encoding can hold."""
    out = sys.stdout if stream is None else stream
    encoding = out.encoding or "utf-8"
    for line in lines:
        out.write(line.encode(encoding, "backslashreplace").decode(encoding) + "\n")


def say_json(document: Any) -> None:
    """Write a JSON document."""
    say(json.dumps(document, indent=2, allow_nan=False))


def number(value: float | None, digits: int = 4) -> str:
    """Write a number so that columns line up; None as a dash."""
    # Adding zero turns -0.0 into 0.0.
    return "-" if value is None else f"{round(value, digits) + 0.0:.{digits}f}"


def table(titles: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> list[str]:
    """Return the lines of a table.

    Args:
        titles: Titles of the columns; empty: none are shown.
        rows: The cells.
        left: How many columns, from the first, are aligned to the left.
    """
    lines = [list(titles), *map(list, rows)] if titles else [list(r) for r in rows]
    if not lines:
        return []
    widths = [max(len(line[c]) for line in lines) for c in range(len(lines[0]))]
    return [
        "  ".join(
            cell.ljust(width) if c < left else cell.rjust(width)
            for c, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
