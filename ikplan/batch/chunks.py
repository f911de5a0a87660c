"""Lines of a batch that are answered together, and how many that are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ikplan.batch.outcome import Outcome

__all__ = ["Chunk", "Done", "Line", "Pace", "chunks_of"]

_SECONDS = 1.0
"""Work in a chunk [s]: handing it over takes a thousandth of that."""
_GROWTH = 4.0
"""Largest growth from one chunk to the next: the first lines may be the quick ones."""
_MOST_LINES = 20_000
_MOST_BYTES = 8 * 2**20


@dataclass(frozen=True, slots=True)
class Line:
    """A line of the input.

    Attributes:
        index: Its number, from 0; blank lines do not count.
        content: The request, JSON.
        end: Where it ends in the input [bytes].
    """

    index: int
    content: bytes
    end: int


class Chunk(NamedTuple):
    """Consecutive lines that one worker answers in one go."""

    lines: tuple[Line, ...]


class Done(NamedTuple):
    """The answers to a chunk.

    Attributes:
        chunk: The chunk.
        outcomes: One for each line, in their order.
        seconds: Time that the worker took [s].
    """

    chunk: Chunk
    outcomes: list[Outcome]
    seconds: float


class Pace:
    """How many lines take about a second, from those done so far.

    It decides only how lines are grouped, never what the answer to one is.

    Args:
        lines: As many lines always; None: as many as take about a second.
    """

    def __init__(self, lines: int | None = None) -> None:
        self._fixed = lines
        self._size = 1.0

    @property
    def lines(self) -> int:
        """Lines of the next chunk."""
        return self._fixed or max(1, min(int(self._size), _MOST_LINES))

    def note(self, lines: int, seconds: float) -> None:
        """Take account of lines that took some seconds together."""
        wanted = _SECONDS * lines / max(seconds, 1e-9)
        self._size = min(wanted, _GROWTH * max(self._size, 1.0), float(_MOST_LINES))


def chunks_of(lines: Iterable[Line], pace: Pace) -> Iterator[Chunk]:
    """Yield the lines in chunks, each as large as the pace says when it begins."""
    pending: list[Line] = []
    size, most = 0, pace.lines
    for line in lines:
        pending.append(line)
        size += len(line.content)
        if len(pending) >= most or size >= _MOST_BYTES:
            yield Chunk(tuple(pending))
            pending, size, most = [], 0, pace.lines
    if pending:
        yield Chunk(tuple(pending))
