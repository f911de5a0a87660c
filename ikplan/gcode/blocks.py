"""The words of a G-code file, line by line (RS-274/NGC, ISO 6983-1).

Parsers on PyPI were looked at: those that are kept up read the commands of 3D printers and know no
modal motions, on which a milling program rests.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ikplan.errors import InvalidRequest

__all__ = ["Block", "fault", "read_blocks"]

_COMMENT = re.compile(r"\([^()]*\)")
_WORD = re.compile(r"\s*([A-Za-z])\s*([+-]?(?:\d+\.?\d*|\.\d+))")
_LONGEST_LINE = 1000


@dataclass(frozen=True)
class Block:
    """One line.

    Attributes:
        line: Its number, from 1.
        words: Letters in capitals with their numbers, in order.
    """

    line: int
    words: list[tuple[str, float]]

    def codes(self, letter: str) -> list[float]:
        """Return the numbers of every word with a letter."""
        return [number for found, number in self.words if found == letter]

    def value(self, letter: str) -> float | None:
        """Return the number of a letter, None if the line does not have it.

        Raises:
            InvalidRequest: The line has it twice.
        """
        found = self.codes(letter)
        if len(found) > 1:
            raise fault(self.line, f"{letter} is given twice")
        return found[0] if found else None


def fault(line: int, what: str, allowed: object = None) -> InvalidRequest:
    """Return the error for a line."""
    return InvalidRequest(f"line {line}: {what}", field=f"line {line}", allowed=allowed)


def read_blocks(text: str) -> Iterator[Block]:
    """Yield the lines that have words; comments, line numbers and skipped lines are left out.

    Args:
        text: The file.

    Raises:
        InvalidRequest: A line is no G-code; names it.
    """
    for number, raw in enumerate(text.splitlines(), start=1):
        if len(raw) > _LONGEST_LINE:
            raise fault(number, f"longer than {_LONGEST_LINE} characters")
        line = _COMMENT.sub(" ", raw).partition(";")[0].strip()
        if not line or line.startswith(("/", "%")):
            continue
        if "(" in line or ")" in line:
            raise fault(number, "a comment that does not end")
        if "#" in line or "[" in line or line[:1] in "oO":
            raise fault(
                number, "parameters, expressions and subprograms are not read", "plain numbers"
            )
        words, at = [], 0
        while at < len(line):
            found = _WORD.match(line, at)
            if found is None:
                raise fault(number, f"no word of G-code: {line[at : at + 20]!r}")
            words.append((found[1].upper(), float(found[2])))
            at = found.end()
            while at < len(line) and line[at].isspace():
                at += 1
        words = [word for word in words if word[0] != "N"]
        if words:
            yield Block(number, words)
