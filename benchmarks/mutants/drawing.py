"""Mutants drawn by a seed.

Each possible fault gets a number from the digest of the seed, the module, its line, what replaces
what there, and which of several of that kind it is; those with the lowest numbers are drawn. So a
change of the code leaves most of a draw as it was.
"""

from __future__ import annotations

import collections
import hashlib
from collections.abc import Iterable
from pathlib import Path

from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.operators import faults_of

__all__ = ["draw", "possible"]


def possible(package: Path, file: str) -> list[Mutant]:
    """Return every mutant of a module, in the order of its text.

    Args:
        package: Folder of the package.
        file: The module, relative to it.
    """
    source = (package / file).read_text()
    lines = source.splitlines()
    seen: collections.Counter[tuple[str, str, str]] = collections.Counter()
    mutants = []
    for fault in faults_of(source):
        old = source[fault.begin : fault.end]
        line = lines[fault.line - 1].strip()
        key = (line, old, fault.new)
        name = hashlib.sha256("\0".join([file, *key, str(seen[key])]).encode()).hexdigest()[:10]
        seen[key] += 1
        mutants.append(Mutant(name, file, old, fault.new, fault.kind, (), fault.begin, fault.line))
    return mutants


def draw(package: Path, files: Iterable[str], count: int, seed: int) -> list[Mutant]:
    """Draw mutants.

    Args:
        package: Folder of the package.
        files: Modules to draw from, relative to it.
        count: How many; as many as there are, if that is less.
        seed: Seed.
    """
    everything = [mutant for file in files for mutant in possible(package, file)]

    def number(mutant: Mutant) -> bytes:
        return hashlib.sha256(f"{seed}:{mutant.name}".encode()).digest()

    drawn = sorted(everything, key=number)[:count]
    return sorted(drawn, key=lambda mutant: (mutant.file, mutant.begin or 0, mutant.new))
