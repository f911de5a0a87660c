"""How far a batch is: on a terminal always, in a log once a minute."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping

__all__ = ["BatchProgress", "progress_text"]

_TERMINAL_S = 0.2
_LOG_S = 60.0


def progress_text(
    rows: int, verdicts: Mapping[str, int], rate: float, share: float, elapsed_s: float
) -> str:
    """Return the progress of a batch as a line.

    Args:
        rows: How many rows there are.
        verdicts: How many of them have a problem, by slug.
        rate: Rows of this run per second.
        share: Share of the input of this run that is answered; 0: unknown.
        elapsed_s: Time of this run so far [s].
    """
    parts = [f"{rows:,} lines"]
    if share > 0.0:
        parts.append(f"{100.0 * share:.1f} %")
    parts.append(f"{rate:,.1f} lines/s")
    if share > 0.0:
        left = round(elapsed_s * (1.0 - share) / share)
        parts.append(f"{left // 3600}:{left // 60 % 60:02d}:{left % 60:02d} left")
    parts += [f"{count:,} {slug}" for slug, count in sorted(verdicts.items())]
    return ", ".join(parts)


class BatchProgress:
    """Tells on stderr how far a batch is.

    Args:
        size: Length of the input [bytes]; 0: unknown.
        quiet: Tell nothing.
        clock: Tells the time [s].
    """

    def __init__(
        self, size: int, *, quiet: bool, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._size, self._quiet, self._clock = size, quiet, clock
        self._terminal = sys.stderr.isatty()
        self._begun = clock()
        self._next = self._begun + (0.0 if self._terminal else _LOG_S)
        self._skipped = -1
        self._answered = 0

    def tell(self, rows: int, verdicts: Mapping[str, int], begin: int, end: int) -> None:
        """Tell that a line has its row.

        Args:
            rows: How many rows there are, with those of earlier runs.
            verdicts: How many of them have a problem, by slug.
            begin: Where the line begins in the input [bytes].
            end: Where it ends [bytes].
        """
        self._answered += 1
        if self._skipped < 0:
            self._skipped = begin
        now = self._clock()
        if self._quiet or now < self._next:
            return
        self._next = now + (_TERMINAL_S if self._terminal else _LOG_S)
        elapsed = max(now - self._begun, 1e-9)
        share = (end - self._skipped) / (self._size - self._skipped) if self._size else 0.0
        text = progress_text(rows, verdicts, self._answered / elapsed, share, elapsed)
        sys.stderr.write(f"\r\x1b[K{text}" if self._terminal else f"ikplan: {text}\n")
        sys.stderr.flush()

    def close(self) -> None:
        """Clear the line of a terminal."""
        if self._terminal and not self._quiet:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
