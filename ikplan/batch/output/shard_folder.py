"""Rows in shards: files of as many rows each, which are there when they are complete."""

from __future__ import annotations

import itertools
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ikplan.batch.chunks import Line
from ikplan.batch.outcome import Outcome
from ikplan.batch.output.formats import ShardFormat
from ikplan.batch.output.journal import Journal, ShardEntry, digest_of
from ikplan.errors import InvalidRequest

__all__ = ["ShardFolder"]


class ShardFolder:
    """A folder of shards.

    A shard is written under a temporary name, and renamed when it is complete: one that is there
    is done, whatever ended the process. Row k is in shard k // lines, so that the same input gives
    the same files whether or not the batch was interrupted.

    Args:
        folder: The folder; it is made.
        form: The format of the shards.
        lines: Rows of a shard.
        batch: What must not change when the batch is resumed.
        resume: Whether shards that are there are kept and passed over.

    Attributes:
        rows: How many rows there are, with those of earlier runs.
        verdicts: How many of them have a problem, by slug.

    Raises:
        InvalidRequest: There is a batch already, and it is not to be resumed, or it is another.
        OSError: The folder cannot be written.
    """

    def __init__(
        self,
        folder: Path,
        form: type[ShardFormat],
        lines: int,
        batch: Mapping[str, Any],
        *,
        resume: bool,
    ) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.rows = 0
        self.verdicts: Counter[str] = Counter()
        self._folder, self._form, self._lines = folder, form, lines
        self._journal = Journal(folder, {**batch, "shard_lines": lines}, resume=resume)
        for leftover in folder.glob(".shard-*"):
            leftover.unlink()
        self._shard: ShardFormat | None = None
        self._number = -1
        self._written: list[Line] = []
        self._failed: Counter[str] = Counter()

    def remaining(self, lines: Iterable[Line]) -> Iterator[Line]:
        """Yield the lines of the shards that are not there.

        Raises:
            InvalidRequest: A line is not the one that a shard answers.
        """
        for number, group in itertools.groupby(lines, lambda line: line.index // self._lines):
            entry = self._journal.entries.get(number)
            if entry is None or not self._name(number).exists():
                yield from group
                continue
            asked = list(group)
            if digest_of(asked[: entry.lines]) != entry.sha256:
                raise InvalidRequest(
                    f"--resume: {self._name(number)} answers other lines than those of the input",
                    field="--resume",
                    allowed="the input that the batch was begun with, or one that continues it",
                )
            if len(asked) > entry.lines:  # the input has grown since
                yield from asked
                continue
            self.rows += entry.lines
            self.verdicts.update(entry.verdicts)

    def write(self, line: Line, outcome: Outcome) -> None:
        """Write the row of a line; lines come in the order of :meth:`remaining`."""
        number = line.index // self._lines
        if number != self._number:
            self._complete()
            self._number = number
            self._shard = self._form(self._temporary(number))
        assert self._shard is not None
        self._shard.add(line.index, outcome)
        self._written.append(line)
        self.rows += 1
        if outcome.slug:
            self._failed[outcome.slug] += 1
            self.verdicts[outcome.slug] += 1
        if len(self._written) == self._lines:
            self._complete()

    def _complete(self) -> None:
        """Give the shard its name."""
        if self._shard is None:
            return
        self._shard.close()
        entry = ShardEntry(
            len(self._written), digest_of(self._written), dict(sorted(self._failed.items()))
        )
        self._journal.add(self._number, entry)
        os.replace(self._temporary(self._number), self._name(self._number))
        folder = os.open(self._folder, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
        self._shard, self._number, self._written = None, -1, []
        self._failed.clear()

    def finish(self) -> None:
        """Complete the last shard."""
        self._complete()

    def close(self) -> None:
        """Discard a shard that is not complete, and let other processes write to the folder."""
        if self._shard is not None:
            self._shard.discard()
            self._shard = None
        self._journal.close()

    def _name(self, number: int) -> Path:
        return self._folder / f"shard-{number:07d}{self._form.suffix}"

    def _temporary(self, number: int) -> Path:
        return self._folder / f".shard-{number:07d}{self._form.suffix}"
