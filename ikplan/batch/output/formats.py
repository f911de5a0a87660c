"""The formats of shards."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Protocol

from ikplan.batch.outcome import Outcome, row_of
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

__all__ = ["FORMATS", "JsonLinesZstd", "Parquet", "ShardFormat", "find_format"]

_LEVEL = 3
"""Level of zstd: of a plan's JSON 46 % are left, for 6.7 ms a MB."""
_GROUP = 64
"""Rows of a row group of Parquet that are held in memory."""


class ShardFormat(Protocol):
    """A file that rows are added to; the same rows give the same bytes.

    Args:
        file: Where it is written.
    """

    suffix: str
    """End of the file's name."""

    def __init__(self, file: Path) -> None: ...

    def add(self, index: int, outcome: Outcome) -> None:
        """Add a row."""

    def close(self) -> None:
        """Complete the file, and see it on the disk."""

    def discard(self) -> None:
        """Delete the file."""


class JsonLinesZstd:
    """JSON lines, compressed by zstd in one frame that says how long they are."""

    suffix = ".jsonl.zst"

    def __init__(self, file: Path) -> None:
        self._file = file
        # The frame begins with the length: rows wait uncompressed on the disk until it is known.
        self._plain = file.with_name(file.name + ".rows")
        self._rows: BinaryIO = self._plain.open("wb")

    def add(self, index: int, outcome: Outcome) -> None:
        """Add a row."""
        self._rows.write(row_of(index, outcome))

    def close(self) -> None:
        """Complete the file, and see it on the disk."""
        import zstandard

        self._rows.close()
        compressor = zstandard.ZstdCompressor(level=_LEVEL)
        with self._plain.open("rb") as rows, self._file.open("wb") as shard:
            compressor.copy_stream(rows, shard, size=self._plain.stat().st_size)
            shard.flush()
            os.fsync(shard.fileno())
        self._plain.unlink()

    def discard(self) -> None:
        """Delete the file."""
        self._rows.close()
        self._plain.unlink(missing_ok=True)
        self._file.unlink(missing_ok=True)


class Parquet:
    """Parquet with the columns index, status, plan and problem; the last two are JSON or null."""

    suffix = ".parquet"

    def __init__(self, file: Path) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        self._file = file
        self._schema: pa.Schema = pa.schema(
            [
                pa.field("index", pa.int64(), nullable=False),
                pa.field("status", pa.int16(), nullable=False),
                pa.field("plan", pa.string()),
                pa.field("problem", pa.string()),
            ]
        )
        self._writer: pq.ParquetWriter = pq.ParquetWriter(file, self._schema, compression="zstd")
        self._pending: list[dict[str, Any]] = []

    def add(self, index: int, outcome: Outcome) -> None:
        """Add a row."""
        name = "problem" if outcome.slug else "plan"
        row = {"index": index, "status": outcome.status, name: outcome.document.decode()}
        self._pending.append(row)
        if len(self._pending) == _GROUP:
            self._flush()

    def _flush(self) -> None:
        import pyarrow as pa

        self._writer.write_table(pa.Table.from_pylist(self._pending, schema=self._schema))
        self._pending = []

    def close(self) -> None:
        """Complete the file, and see it on the disk."""
        if self._pending:
            self._flush()
        self._writer.close()
        with self._file.open("rb") as shard:
            os.fsync(shard.fileno())

    def discard(self) -> None:
        """Delete the file."""
        self._writer.close()
        self._file.unlink(missing_ok=True)


FORMATS: dict[str, type[ShardFormat]] = {"jsonl.zst": JsonLinesZstd, "parquet": Parquet}
"""The formats of shards by name."""


def find_format(name: str) -> type[ShardFormat]:
    """Return the format of a name.

    Raises:
        InvalidRequest: There is none of that name, or its package is not installed.
    """
    if name not in FORMATS:
        allowed = sorted(FORMATS)
        raise InvalidRequest(
            f"--format: one of {', '.join(allowed)}, not {name!r}",
            field="--format",
            allowed=allowed,
        )
    if name == "parquet":
        try:
            import pyarrow.parquet  # noqa: F401 - only whether it is there
        except ImportError as error:
            raise InvalidRequest(
                "--format parquet needs pyarrow: pip install 'ikplan[parquet]'", field="--format"
            ) from error
    return FORMATS[name]
