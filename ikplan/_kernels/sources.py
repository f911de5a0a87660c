"""What a kernel is built of: the digest of its file and of every file that it imports."""

from __future__ import annotations

import functools
import hashlib
import os
import re
import uuid
from pathlib import Path
from typing import NamedTuple

import numba

__all__ = ["PACKAGE", "digest_of", "last_change", "sources_of"]

PACKAGE = Path(__file__).parents[1]
_ROOT = str(PACKAGE)
_KEEPING = os.path.dirname(__file__)
"""How kernels are kept changes none of them, but for the form."""
_FORM = 2
"""1: all that a kernel calls is part of it; 2: large ones are called where they are."""
_IMPORT = re.compile(
    rb"^\s*(?:from|import) (ikplan[\w.]*)(?: import (?:\(([^)]*)\)|([\w, ]+)))?", re.MULTILINE
)


class _Source(NamedTuple):
    """A file of the package, read once: hundreds of kernels share it."""

    content: bytes
    imports: tuple[str, ...]


@functools.cache
def _is_file(path: str) -> bool:
    return os.path.isfile(path)


@functools.cache
def last_change(path: str) -> int:
    """Return when a file was changed last [ns], as of the first time that this is asked.

    Asked when a module is imported, so that its file can be read later: a file that was changed
    in between is not what was imported, and has a digest that no other process finds.
    """
    return os.stat(path).st_mtime_ns


@functools.cache
def _source(path: str) -> _Source:
    imported = last_change(path)
    with open(path, "rb") as file:
        content = file.read()
        if os.fstat(file.fileno()).st_mtime_ns != imported:
            content += uuid.uuid4().bytes
    imports: list[str] = []
    for module, several, few in _IMPORT.findall(content):
        base = os.path.join(_ROOT, *module.decode().split(".")[1:])
        names = (several or few).decode().replace(",", " ").split()
        named = [base, *(os.path.join(base, name) for name in names)]
        candidates = [f"{each}.py" for each in named if each != _ROOT]
        imports += [p for p in candidates if os.path.dirname(p) != _KEEPING and _is_file(p)]
    return _Source(content, tuple(dict.fromkeys(imports)))


@functools.cache
def _paths_of(path: str) -> tuple[str, ...]:
    found: set[str] = set()
    pending = [path]
    while pending:
        current = pending.pop()
        if current not in found:
            found.add(current)
            pending += _source(current).imports
    return tuple(sorted(found, key=lambda each: each.split(os.sep)))


def sources_of(path: Path) -> frozenset[Path]:
    """Return a file and every file of the package that it imports, directly or not."""
    return frozenset(map(Path, _paths_of(str(path))))


@functools.cache
def digest_of(path: Path) -> str:
    """Return the digest of a kernel file, of all it builds on, and of the compiler's version."""
    digest = hashlib.sha256(f"{numba.__version__} {_FORM}".encode())
    for source in _paths_of(str(path)):
        digest.update(source.removeprefix(_ROOT + os.sep).replace(os.sep, "/").encode() + b"\0")
        digest.update(_source(source).content)
    return digest.hexdigest()[:16]
