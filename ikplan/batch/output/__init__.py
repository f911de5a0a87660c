"""Where the rows of a batch go: to shards in a folder, to one file, or to standard output."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Protocol

from ikplan.batch.chunks import Line
from ikplan.batch.outcome import Outcome

__all__ = ["BatchOutput"]


class BatchOutput(Protocol):
    """What keeps the rows of a batch.

    Attributes:
        rows: How many rows there are, with those of earlier runs.
        verdicts: How many of them have a problem, by the slug of its type.
    """

    rows: int
    verdicts: Counter[str]

    def remaining(self, lines: Iterable[Line]) -> Iterator[Line]:
        """Yield the lines that have no row yet.

        Raises:
            InvalidRequest: A line is not the one that has a row already.
        """

    def write(self, line: Line, outcome: Outcome) -> None:
        """Write the row of a line; lines come in the order of :meth:`remaining`."""

    def finish(self) -> None:
        """Complete the output, after the last row."""
