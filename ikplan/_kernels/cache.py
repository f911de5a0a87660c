"""numba's cache of compiled functions, by content, shared, and with what is shipped before it."""

from __future__ import annotations

import functools
import gc
import hashlib
import os
import pickle
import sys
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core import caching, types

from ikplan._kernels.clock import counting
from ikplan._kernels.linking import call_out_of_line, reduced, restored
from ikplan._kernels.loading import ready_to_load, unpickled
from ikplan._kernels.pack import pack_key, shipped_pack
from ikplan._kernels.python_calls import Wrapper, wrap_when_called
from ikplan._kernels.sources import PACKAGE, digest_of, last_change
from ikplan._kernels.turns import Turn, take_turn

__all__ = ["cache_folder", "keep", "when_compiling"]


@functools.cache
def cache_folder() -> Path:
    """Folder of the compiled kernels."""
    root = os.environ.get("IKPLAN_CACHE_DIR")
    if root is None:
        base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
        root = os.path.join(base, "ikplan")
    return Path(root) / "kernels"


_listeners: list[Callable[[], None]] = []


def when_compiling(call: Callable[[], None]) -> None:
    """Have a function called before the first kernel of the process is compiled."""
    _listeners.append(call)


@functools.cache
def _announce() -> None:
    """Tell the user why nothing seems to happen; cached, so said once a process."""
    pack = shipped_pack()
    why = f" (those of {pack.path} are {pack.refusal})" if pack is not None and pack.refusal else ""
    print(f"compiling kernels, once ...{why}", file=sys.stderr, flush=True)  # noqa: T201
    for call in _listeners:
        call()


class _Locator(caching._CacheLocator):  # type: ignore[misc]
    """Puts each kernel in the project's cache folder, whether it can be written or not."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        path = Path(py_file)
        self._stamp = digest_of(path)
        self._folder = "-".join([*path.relative_to(PACKAGE).with_suffix("").parts, self._stamp])
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

    def reduce(self, cres: Any) -> tuple[Any, ...]:
        return reduced(cres)

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
        return restored(functools.partial(super().rebuild, target_context), payload)


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

    def _load_data(self, name: str) -> Any:
        with open(self._data_path(name), "rb") as file:
            return unpickled(file.read())

    def _load_index(self) -> dict[Any, str]:
        try:
            overloads: dict[Any, str] = super()._load_index()
        except _CUT_SHORT:
            return {}
        return overloads


_WRAPPER = "called from Python"


class _KernelCache(caching.FunctionCache):  # type: ignore[misc]
    """Finds a kernel in what is shipped, then on the disk; else it is this process's to compile."""

    _impl_class = _KernelCacheImpl

    _enabled = True  # what the base class sets, whose constructor looks for the files

    def __init__(self, dispatcher: Any, py_func: Callable[..., Any]) -> None:
        self._dispatcher = dispatcher
        self._py_func = py_func
        self._name = py_func.__qualname__
        self._turns: dict[Any, Turn] = {}
        last_change(py_func.__code__.co_filename)

    # Where a kernel is kept is found when it is looked for: most are part of others.

    @functools.cached_property
    def _impl(self) -> _KernelCacheImpl:
        return _KernelCacheImpl(self._py_func)

    @functools.cached_property
    def _cache_path(self) -> str:
        path: str = self._impl.locator.get_cache_path()
        return path

    @functools.cached_property
    def _cache_file(self) -> _CacheFile:
        stamp = self._impl.locator.get_source_stamp()
        return _CacheFile(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        ready_to_load(target_context)
        found = self._shipped(sig, target_context)
        if found is None:
            found = self._kept(sig, target_context)
        if found is not None:
            return found
        _announce()
        if sig in self._turns:
            return None
        taken = take_turn(self._lock_of(sig), lambda: self._kept(sig, target_context))
        if isinstance(taken, Turn):
            self._turns[sig] = taken
            return None
        return taken

    def _kept(self, sig: Any, target_context: Any) -> Any:
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def _shipped(self, sig: Any, target_context: Any) -> Any:
        data = self._in_pack(sig, target_context.codegen())
        return None if data is None else self._impl.rebuild(target_context, data)

    def _in_pack(self, sig: Any, codegen: Any) -> Any:
        pack = shipped_pack()
        if pack is None:
            return None
        code = self._index_key(sig, codegen)[2]
        stamp = self._impl.locator.get_source_stamp()
        return pack.find(pack_key(self._impl.filename_base, stamp, sig, code))

    def load_wrapper(self, sig: Any, codegen: Any) -> Wrapper | None:
        """Return what Python calls a kernel by, if it is kept."""
        sig = (_WRAPPER, sig)
        found = self._in_pack(sig, codegen)
        if found is None:
            found = self._cache_file.load(self._index_key(sig, codegen))
        return found if isinstance(found, Wrapper) else None

    def save_wrapper(self, sig: Any, codegen: Any, wrapper: Wrapper) -> None:
        """Keep what Python calls a kernel by; it was just compiled."""
        _announce()
        try:
            self._impl.locator.ensure_cache_path()
            self._cache_file.save(self._index_key((_WRAPPER, sig), codegen), wrapper)
        except OSError as error:
            _warn_unsaved(str(error))

    def _lock_of(self, sig: Any) -> Path:
        name = hashlib.sha256(str(sig).encode()).hexdigest()[:16]
        return Path(self._cache_path) / f"{self._impl.filename_base}.{name}.lock"

    def save_overload(self, sig: Any, data: Any) -> None:
        call_out_of_line(self._dispatcher, data)
        try:
            super().save_overload(sig, data)
        except OSError as error:
            # A kernel that cannot be kept still runs; the user pays the compilation again.
            _warn_unsaved(str(error))
        finally:
            self.give_up(sig)

    def give_up(self, sig: Any) -> None:
        """Let others compile a kernel, or have it if it is compiled."""
        turn = self._turns.pop(sig, None)
        if turn is not None:
            turn.give_back()


def keep(dispatcher: Any, function: Callable[..., Any], *, wrappers_apart: bool) -> None:
    """Have numba find and keep what it compiles of a function here.

    Args:
        dispatcher: What numba made of the function.
        function: The function.
        wrappers_apart: Whether it is compiled without what Python calls it by.
    """
    dispatcher._cache = cache = _KernelCache(dispatcher, function)
    if wrappers_apart:
        wrap_when_called(dispatcher, cache)
    compiled, typed = dispatcher.compile, dispatcher.get_call_template

    def widened(arguments: Any, named: Any) -> Any:
        # One kernel for all numbers, not one for each that is written where it is called.
        return typed([_widened(each) for each in arguments], named)

    def compile_in_turn(sig: Any) -> Any:
        # The collector finds nothing to free in a compiler at work, and looks for a tenth of it.
        collects = gc.isenabled()
        gc.disable()
        try:
            with counting():
                return compiled(sig)
        except BaseException:
            cache.give_up(sig)
            raise
        finally:
            if collects:
                gc.enable()

    dispatcher.compile = compile_in_turn
    dispatcher.get_call_template = widened


def _widened(argument: Any) -> Any:
    literal = isinstance(argument, (types.IntegerLiteral, types.BooleanLiteral))
    return argument.literal_type if literal else argument


@functools.cache
def _warn_unsaved(reason: str) -> None:
    print(  # noqa: T201
        f"compiled kernels cannot be kept in {cache_folder()} ({reason}); "
        "set IKPLAN_CACHE_DIR to a folder that can be written",
        file=sys.stderr,
    )
