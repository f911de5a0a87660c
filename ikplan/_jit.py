"""The one place where kernels are compiled and cached.

numba's own cache looks only at the file of the function, so that a kernel that calls another
file's kernel can be stale after an edit; it also refuses to work where the cache folder is
read-only, as in a container. The cache here is stamped with the content of the file and of every
file it imports (so kernels are imported by ``from ikplan.... import ...``), reads from a read-only
folder, and says on stderr, once, when it has to compile.

Environment: ``IKPLAN_CACHE_DIR`` moves the cache (default: ``ikplan`` in the user's cache
folder); ``NUMBA_CPU_NAME=generic`` compiles for any processor of the family.
"""

from __future__ import annotations

import functools
import hashlib
import os
import pickle
import re
import sys
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba.core import caching

__all__ = ["cache_folder", "kernel", "leaf_kernel"]

P = ParamSpec("P")
R = TypeVar("R")

_PACKAGE = Path(__file__).parent


_IMPORT = re.compile(
    rb"^\s*(?:from|import) (ikplan[\w.]*)(?: import (?:\(([^)]*)\)|([\w, ]+)))?", re.MULTILINE
)


@functools.cache
def _sources(path: Path) -> frozenset[Path]:
    """The file and every file of the package that it imports, directly or not."""
    found: set[Path] = set()
    pending = [path]
    while pending:
        current = pending.pop()
        if current in found:
            continue
        found.add(current)
        for module, several, few in _IMPORT.findall(current.read_bytes()):
            parts = module.decode().split(".")[1:]
            base = _PACKAGE.joinpath(*parts)
            names = (several or few).decode().replace(",", " ").split()
            submodules = [base / name for name in names]
            candidates = [p.with_suffix(".py") for p in (base, *submodules) if p != _PACKAGE]
            pending += [p for p in candidates if p.is_file()]
    return frozenset(found)


@functools.cache
def _digest(path: Path) -> str:
    """Digest of a kernel file, of all it builds on, and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(_sources(path)):
        digest.update(source.relative_to(_PACKAGE).as_posix().encode() + b"\0")
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


@functools.cache
def cache_folder() -> Path:
    """Folder of the compiled kernels."""
    root = os.environ.get("IKPLAN_CACHE_DIR")
    if root is None:
        base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
        root = os.path.join(base, "ikplan")
    return Path(root) / "kernels"


@functools.cache
def _announce() -> None:
    """Tell the user why nothing seems to happen; cached, so said once a process."""
    print("compiling kernels, once ...", file=sys.stderr, flush=True)  # noqa: T201


class _Locator(caching._CacheLocator):  # type: ignore[misc]
    """Puts each kernel in the project's cache folder, whether it can be written or not."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        path = Path(py_file)
        self._stamp = _digest(path)
        self._folder = "-".join([*path.relative_to(_PACKAGE).with_suffix("").parts, self._stamp])
        self._line = py_func.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(cache_folder() / self._folder)

    def get_source_stamp(self) -> str:
        return self._stamp

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> _Locator:
        return cls(py_func, py_file)


class _KernelCacheImpl(caching.CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Locator,)


_CUT_SHORT = (EOFError, pickle.UnpicklingError)
_UNREADABLE = (OSError, *_CUT_SHORT)


class _CacheFile(caching.IndexDataCacheFile):  # type: ignore[misc]
    """The files of one kernel: an index, and one file a signature.

    numba numbers the files of signatures, so that two processes that compile different ones at
    the same time can give them the same file, and load the wrong one ever after. Here no two
    have the same name, and the index never names a file that is not there yet.
    """

    def save(self, key: Any, data: Any) -> None:
        name = self._data_name_pattern.replace("{number:d}", uuid.uuid4().hex)
        self._save_data(name, data)
        overloads = self._load_index()
        overloads[key] = name
        self._save_index(overloads)

    def load(self, key: Any) -> Any:
        try:
            return super().load(key)
        except _UNREADABLE:
            return None  # compiled anew, as if it were not there

    def _load_index(self) -> dict[Any, str]:
        try:
            overloads: dict[Any, str] = super()._load_index()
        except _CUT_SHORT:
            return {}
        return overloads


class _KernelCache(caching.FunctionCache):  # type: ignore[misc]
    _impl_class = _KernelCacheImpl

    def __init__(self, py_func: Callable[..., Any]) -> None:
        super().__init__(py_func)
        self._cache_file = _CacheFile(
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=self._impl.locator.get_source_stamp(),
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        found = super().load_overload(sig, target_context)
        if found is None:
            _announce()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except OSError as error:
            # A kernel that cannot be kept still runs; the user pays the compilation again.
            _warn_unsaved(str(error))


@functools.cache
def _warn_unsaved(reason: str) -> None:
    print(  # noqa: T201
        f"compiled kernels cannot be kept in {cache_folder()} ({reason}); "
        "set IKPLAN_CACHE_DIR to a folder that can be written",
        file=sys.stderr,
    )


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` with numba: no GIL, cached on disk, no fast-math.

    Args:
        function: A function on plain arrays, scalars and named tuples of them.

    Returns:
        The compiled function.
    """
    return _compiled(function, counting=True)


def leaf_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` like :func:`kernel`, without counting references to arrays.

    In a kernel of a microsecond that takes arrays out of named tuples, the counting costs as much
    as the work. numba refuses to compile such a function if it makes an array, also for the
    copy of an array into another (``a[:] = b``).

    Args:
        function: A function that makes no array and returns scalars.

    Returns:
        The compiled function.
    """
    return _compiled(function, counting=False)


def _compiled(function: Callable[P, R], *, counting: bool) -> Callable[P, R]:
    # Said explicitly, since a kernel compiled on behalf of a leaf would inherit its option.
    dispatcher = numba.njit(nogil=True, error_model="numpy", _nrt=counting)(function)
    if os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0"):
        dispatcher._cache = _KernelCache(function)
    return cast("Callable[P, R]", dispatcher)
