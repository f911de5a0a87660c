"""Rows in one file of JSON lines, or on standard output, each at once."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

from ikplan.batch.chunks import Line
from ikplan.batch.outcome import OK, Outcome, row_of
from ikplan.errors import InvalidRequest

__all__ = ["RowFile", "RowStream", "begin_row_file"]

_ROW = re.compile(rb'\{"index": (\d+), "status": (\d+), ')


class RowStream:
    """A stream that rows are written to.

    Args:
        stream: The stream.

    Attributes:
        rows: How many rows there are.
        verdicts: How many of them have a problem, by slug.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self.rows = 0
        self.verdicts: Counter[str] = Counter()
        self._stream = stream

    def remaining(self, lines: Iterable[Line]) -> Iterator[Line]:
        """Yield the lines that have no row yet."""
        earlier = self.rows
        return (line for line in lines if line.index >= earlier)

    def write(self, line: Line, outcome: Outcome) -> None:
        """Write the row of a line."""
        self._stream.write(row_of(line.index, outcome))
        self._stream.flush()
        self.rows += 1
        if outcome.slug:
            self.verdicts[outcome.slug] += 1

    def finish(self) -> None:
        """Nothing is left to do."""

    def close(self) -> None:
        """Nothing is to be closed."""


class RowFile(RowStream):
    """A file that rows are written to.

    Args:
        file: The file.
        resume: Keep its rows, and write those that follow; else the file is emptied.

    Raises:
        InvalidRequest: Its rows are none of a batch.
        OSError: The file cannot be read or written.
    """

    def __init__(self, file: Path, *, resume: bool) -> None:
        if not resume or not file.exists():
            super().__init__(file.open("wb"))
            return
        super().__init__(file.open("r+b"))
        try:
            self._read(file)
        except BaseException:
            self.close()
            raise

    def _read(self, file: Path) -> None:
        end = 0
        for row in self._stream:
            if not row.endswith(b"\n"):
                break  # torn: the process was killed in it
            found = _ROW.match(row)
            if found is None or int(found[1]) != self.rows:
                raise InvalidRequest(
                    f"--resume: line {self.rows + 1} of {file} is not row {self.rows} of a batch",
                    field="--resume",
                )
            if int(found[2]) != OK:
                slug = json.loads(row)["problem"]["type"].rpartition(":")[2]
                self.verdicts[slug] += 1
            self.rows += 1
            end += len(row)
        self._stream.seek(end)
        self._stream.truncate()

    def close(self) -> None:
        """Close the file."""
        self._stream.close()


def begin_row_file(file: Path, expected: Callable[[], int]) -> RowFile:
    """Begin a file of rows, in the place of a finished one.

    Args:
        file: The file.
        expected: Tells how many lines the input has; 0: unknown.

    Raises:
        InvalidRequest: The file has rows of a batch that is not finished.
        OSError: The file cannot be read or written.
    """
    rows = _rows_in(file) if file.is_file() else 0
    if rows:
        wanted = expected()
        if wanted == 0 or rows < wanted:
            raise InvalidRequest(
                f"--output: {file} has {rows} rows of a batch that may not be finished; --resume "
                "continues it, or delete the file",
                field="--output",
                allowed="--resume, or a file without rows",
            )
    return RowFile(file, resume=False)


def _rows_in(file: Path) -> int:
    """How many whole rows of a batch a file has; 0 where it is another file."""
    rows = 0
    with file.open("rb") as stream:
        for row in stream:
            if row.endswith(b"\n"):
                if not _ROW.match(row):
                    return 0
                rows += 1
    return rows
