"""One mutant: a small fault in one module."""

from __future__ import annotations

import difflib
from dataclasses import dataclass

__all__ = ["Mutant", "StaleMutantError"]


class StaleMutantError(Exception):
    """A mutant does not fit its module any more.

    Attributes:
        mutant: The mutant.
    """

    def __init__(self, mutant: Mutant, reason: str) -> None:
        super().__init__(f"{mutant.name} ({mutant.file}): {reason}")
        self.mutant = mutant


@dataclass(frozen=True)
class Mutant:
    """A replacement of text in one module.

    Attributes:
        name: Names it in reports.
        file: The module, relative to the package, with forward slashes.
        old: The text replaced.
        new: What replaces it.
        why: What goes wrong for a user if no test finds it.
        tests: Test files or node ids that run before those of the module.
        begin: Offset of the old text in the module [characters]; None: the text occurs once.
        line: Line of the module, counted from 1, where that is known.
    """

    name: str
    file: str
    old: str
    new: str
    why: str = ""
    tests: tuple[str, ...] = ()
    begin: int | None = None
    line: int | None = None

    def apply(self, source: str) -> str:
        """Return the module with the fault in it.

        Args:
            source: The module as it is.

        Raises:
            StaleMutantError: The old text is not where it is said to be, or not there exactly once;
                or what comes of it is the same program or none.
        """
        begin = self.begin
        if begin is None:
            count = source.count(self.old)
            if count != 1:
                raise StaleMutantError(self, f"its old text occurs {count} times, not once")
            begin = source.index(self.old)
        end = begin + len(self.old)
        if source[begin:end] != self.old:
            raise StaleMutantError(self, f"its old text is not at character {begin}")
        mutated = source[:begin] + self.new + source[end:]
        if mutated == source:
            raise StaleMutantError(self, "its new text is its old text")
        try:
            compile(mutated, self.file, "exec", dont_inherit=True)
        except SyntaxError as error:
            raise StaleMutantError(self, f"it is no Python: {error}") from error
        return mutated

    def diff(self, source: str) -> str:
        """Return the lines changed, as a unified diff."""
        before, after = source.splitlines(), self.apply(source).splitlines()
        path = f"ikplan/{self.file}"
        lines = difflib.unified_diff(before, after, path, path, n=2, lineterm="")
        return "\n".join(lines)

    def changed_lines(self, source: str) -> tuple[str, str]:
        """Return the lines replaced and those that replace them, stripped, joined by spaces."""
        before, after = source.splitlines(), self.apply(source).splitlines()
        first = 0
        while before[first : first + 1] == after[first : first + 1] != []:
            first += 1
        last = 0
        most = min(len(before), len(after)) - first
        while last < most and before[-1 - last] == after[-1 - last]:
            last += 1
        removed, added = (
            " ".join(line.strip() for line in lines[first : len(lines) - last])
            for lines in (before, after)
        )
        return removed, added
