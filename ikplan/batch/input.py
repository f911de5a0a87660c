"""The lines of a batch, read as they are needed."""

from __future__ import annotations

import contextlib
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from ikplan.batch.chunks import Line
from ikplan.errors import InvalidRequest

__all__ = ["Input", "count_lines", "open_input"]


class Input:
    """The lines of a file or pipe that are not blank.

    Args:
        stream: Where they are read from.

    Attributes:
        size: Length of the file [bytes]; 0: unknown.

    Raises:
        InvalidRequest: There is no line.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        status = os.fstat(stream.fileno())
        self.size = status.st_size if stat.S_ISREG(status.st_mode) else 0
        self._first = self._next_line(0)
        if self._first is None:
            raise InvalidRequest(
                "a batch has at least one line, a request in JSON", allowed="JSON lines"
            )

    def _next_line(self, end: int) -> tuple[bytes, int] | None:
        while content := self._stream.readline():
            end += len(content)
            if content.strip():
                return content.rstrip(b"\r\n"), end
        return None

    def __iter__(self) -> Iterator[Line]:
        index, following = 0, self._first
        while following is not None:
            content, end = following
            yield Line(index, content, end)
            index += 1
            following = self._next_line(end)


@contextlib.contextmanager
def open_input(name: str) -> Iterator[Input]:
    """Open the input of a batch.

    Args:
        name: A file; ``-``: standard input.

    Raises:
        InvalidRequest: There is no line.
        OSError: The file cannot be read.
    """
    if name == "-":
        yield Input(sys.stdin.buffer)
        return
    with Path(name).open("rb") as stream:
        yield Input(stream)


def count_lines(name: str) -> int:
    """Return how many lines of an input are not blank; 0: it can be read only once."""
    if not Path(name).is_file():
        return 0
    with Path(name).open("rb") as stream:
        return sum(1 for line in stream if line.strip())
