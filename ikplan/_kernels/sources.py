"""What a kernel is built of: the digest of its file and of every file that it imports."""

from __future__ import annotations

import functools
import hashlib
import re
from pathlib import Path

import numba

__all__ = ["PACKAGE", "digest_of", "sources_of"]

PACKAGE = Path(__file__).parents[1]
_KEEPING = Path(__file__).parent
"""How kernels are kept changes none of them, but for the form."""
_FORM = 2
"""1: all that a kernel calls is part of it; 2: large ones are called where they are."""
_IMPORT = re.compile(
    rb"^\s*(?:from|import) (ikplan[\w.]*)(?: import (?:\(([^)]*)\)|([\w, ]+)))?", re.MULTILINE
)


@functools.cache
def sources_of(path: Path) -> frozenset[Path]:
    """Return a file and every file of the package that it imports, directly or not."""
    found: set[Path] = set()
    pending = [path]
    while pending:
        current = pending.pop()
        if current in found:
            continue
        found.add(current)
        for module, several, few in _IMPORT.findall(current.read_bytes()):
            parts = module.decode().split(".")[1:]
            base = PACKAGE.joinpath(*parts)
            names = (several or few).decode().replace(",", " ").split()
            submodules = [base / name for name in names]
            candidates = [p.with_suffix(".py") for p in (base, *submodules) if p != PACKAGE]
            pending += [p for p in candidates if p.parent != _KEEPING and p.is_file()]
    return frozenset(found)


@functools.cache
def digest_of(path: Path) -> str:
    """Return the digest of a kernel file, of all it builds on, and of the compiler's version."""
    digest = hashlib.sha256(f"{numba.__version__} {_FORM}".encode())
    for source in sorted(sources_of(path)):
        digest.update(source.relative_to(PACKAGE).as_posix().encode() + b"\0")
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
