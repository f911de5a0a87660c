"""Compiled kernels in one file, to be shipped: found by function, content and signature.

The head of the file says what its kernels are compiled by and for; a pack of another compiler,
another Python or another kind of machine is not used, and neither is one that needs what this
processor has not. Nothing in it is a path or a time, so that it works wherever it is installed.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
import mmap
import os
import pickle
import platform
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import llvmlite
import numba
from llvmlite import binding

from ikplan._kernels.loading import unpickled
from ikplan._kernels.sources import PACKAGE

__all__ = ["PACK_NAME", "Pack", "pack_key", "read_pack", "shipped_pack", "stamp", "write_pack"]

PACK_NAME = "kernels.pack"
_VARIABLE = "IKPLAN_KERNELS"
_DISTRIBUTION = "ikplan_kernels"
_MAGIC = b"ikplan kernels 1\n"


def stamp() -> dict[str, str]:
    """Return what compiled kernels depend on beside their sources and the processor."""
    return {
        "numba": numba.__version__,
        "llvmlite": llvmlite.__version__,
        "python": str(sys.implementation.cache_tag),
        "system": sys.platform,
        "machine": platform.machine(),
    }


def pack_key(function: str, digest: str, signature: Any, code: Any) -> str:
    """Return the key of a compiled kernel.

    Args:
        function: Module, name and line of the function.
        digest: Digest of its file and of what that imports.
        signature: Types of its arguments.
        code: numba's hashes of its byte code and of what it encloses.
    """
    text = "\0".join((function, digest, str(signature), *code))
    return hashlib.sha256(text.encode()).hexdigest()[:32]


class Pack:
    """A pack that is open.

    Attributes:
        path: Its file.
        refusal: Why it cannot be used here; empty: it can.
    """

    def __init__(self, path: Path) -> None:
        """Open a pack.

        Raises:
            OSError: It cannot be read.
            ValueError: It is no pack, or cut short.
        """
        self.path = path
        with path.open("rb") as file:
            self._bytes = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        if self._bytes[: len(_MAGIC)] != _MAGIC:
            raise ValueError(f"{path} holds no kernels")
        begin = len(_MAGIC) + 8
        size = int.from_bytes(self._bytes[len(_MAGIC) : begin], "little")
        head = json.loads(self._bytes[begin : begin + size])
        self._first = begin + size
        self._places: dict[str, list[int]] = head["kernels"]
        if self._first + sum(size for _, size in self._places.values()) != len(self._bytes):
            raise ValueError(f"{path} is cut short")
        self.refusal = _refusal(head["stamp"], head["features"])

    def __len__(self) -> int:
        return len(self._places)

    def find(self, key: str) -> Any:
        """Return what numba keeps of a compiled kernel; None: it is not here."""
        place = self._places.get(key)
        if place is None or self.refusal:
            return None
        begin = self._first + place[0]
        return unpickled(self._bytes[begin : begin + place[1]])


def _refusal(made: Mapping[str, str], features: list[str]) -> str:
    here = stamp()
    for name, value in made.items():
        if here.get(name) != value:
            return f"for {name} {value}, here is {here.get(name)}"
    if features:
        has = binding.get_host_cpu_features()
        lacking = [feature for feature in features if not has.get(feature)]
        if lacking:
            return f"for processors with {', '.join(lacking)}"
    return ""


def read_pack(path: Path) -> Pack | None:
    """Open a pack; None: there is none that can be read."""
    try:
        return Pack(path)
    except (OSError, ValueError, KeyError):
        return None


@functools.cache
def shipped_pack() -> Pack | None:
    """Return the pack of this installation; None: there is none.

    That of ``IKPLAN_KERNELS`` (empty: none), else the one within the package, else that of the
    distribution ``ikplan-kernels``.
    """
    named = os.environ.get(_VARIABLE)
    if named is not None:
        return read_pack(Path(named)) if named else None
    places = [PACKAGE / PACK_NAME]
    spec = importlib.util.find_spec(_DISTRIBUTION)
    if spec is not None and spec.origin is not None:
        places.append(Path(spec.origin).with_name(PACK_NAME))
    return next((pack for place in places if (pack := read_pack(place)) is not None), None)


def write_pack(cache: Path, path: Path) -> int:
    """Put every kernel of a cache folder into a pack.

    Args:
        cache: The folder of compiled kernels.
        path: File of the pack.

    Returns:
        How many kernels it holds.

    Raises:
        ValueError: Kernels of the cache are for different processors.
    """
    found: dict[str, bytes] = {}
    features: set[str] = set()
    for index in sorted(cache.rglob("*.nbi")):
        with index.open("rb") as file:
            if pickle.load(file) != numba.__version__:
                continue
            digest, overloads = pickle.loads(file.read())
        for (signature, target, code), name in overloads.items():
            key = pack_key(index.stem, digest, signature, code)
            found[key] = (index.parent / name).read_bytes()
            features.add(target[2])
    if len(features) > 1:
        raise ValueError(f"kernels in {cache} are for different processors")
    needed = [f[1:] for text in features for f in text.split(",") if f.startswith("+")]
    places, end = {}, 0
    for key in sorted(found):
        places[key] = (end, len(found[key]))
        end += len(found[key])
    head = json.dumps({"stamp": stamp(), "features": sorted(needed), "kernels": places}).encode()
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".part")
    with unfinished.open("wb") as out:
        out.write(_MAGIC + len(head).to_bytes(8, "little") + head)
        for key in sorted(found):
            out.write(found[key])
    unfinished.replace(path)
    return len(found)
