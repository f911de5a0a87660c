"""What a folder of shards says of its batch: which batch it is, and what each shard answers."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ikplan.batch.chunks import Line
from ikplan.errors import InvalidRequest

__all__ = ["Journal", "ShardEntry", "digest_of"]

NAME = "_batch.ndjson"
"""Name of the file; readers of data sets pass over names that begin with an underscore."""


class ShardEntry(NamedTuple):
    """What is known of a shard.

    Attributes:
        lines: Number of lines that it answers.
        sha256: Digest of these lines.
        verdicts: How many have a problem, by slug.
    """

    lines: int
    sha256: str
    verdicts: dict[str, int]


def digest_of(lines: Sequence[Line]) -> str:
    """Return the SHA-256 of lines of the input."""
    digest = hashlib.sha256()
    for line in lines:
        digest.update(line.content + b"\n")
    return digest.hexdigest()


class Journal:
    """A file in the folder, first the batch, then an entry for each shard, in JSON lines.

    It is locked: two processes never write into one folder. An entry is written before its shard
    has its name, so that every shard has one.

    Args:
        folder: The folder of the shards, which exists.
        batch: What must not change when the batch is resumed.
        resume: Whether there may be a batch already.

    Attributes:
        entries: What is known of the shards by their number.

    Raises:
        InvalidRequest: The folder has a batch and it is not to be resumed, or it is another one;
            or another process writes there.
        OSError: The file cannot be read or written.
    """

    def __init__(self, folder: Path, batch: Mapping[str, Any], *, resume: bool) -> None:
        self._file = (folder / NAME).open("a+b")
        try:
            self._lock(folder)
            self._file.seek(0)
            text = self._file.read()
            whole = text[: text.rfind(b"\n") + 1]  # a line may be torn where a process was killed
            self.entries: dict[int, ShardEntry] = {}
            if not whole:
                self._file.truncate(0)
                self._append(batch)
                return
            header, *rows = (json.loads(line) for line in whole.splitlines())
            self._check(folder, header, batch, resume)
            for row in rows:
                number = row.pop("shard")
                self.entries[number] = ShardEntry(**row)
            self._file.truncate(len(whole))
        except BaseException:
            self._file.close()
            raise

    def _lock(self, folder: Path) -> None:
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InvalidRequest(
                f"--output: another process writes to {folder}", field="--output"
            ) from error

    def _check(
        self, folder: Path, header: Mapping[str, Any], batch: Mapping[str, Any], resume: bool
    ) -> None:
        if not resume:
            raise InvalidRequest(
                f"--output: {folder} has a batch; --resume continues it, another folder begins one",
                field="--output",
                allowed="--resume, or a folder without a batch",
            )
        for name, value in batch.items():
            if header.get(name) != value:
                raise InvalidRequest(
                    f"--resume: the batch of {folder} was begun with {name} {header.get(name)!r}, "
                    f"not {value!r}",
                    field="--resume",
                    allowed=header.get(name),
                )

    def add(self, number: int, entry: ShardEntry) -> None:
        """Add the entry of a shard; it is on the disk when this returns."""
        self.entries[number] = entry
        self._append({"shard": number, **entry._asdict()})

    def _append(self, row: Mapping[str, Any]) -> None:
        self._file.write(json.dumps(row).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Let other processes write to the folder."""
        self._file.close()
